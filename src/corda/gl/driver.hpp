#pragma once

#include <mutex>

namespace corda::gl {

/// Locks EGL, and OpenGL on the CPU, for this process. fork() waits for the lock, so that the child finds it
/// free and the driver's data consistent. Recursive, because code that holds it for several steps (a probe, a
/// check) calls code that takes it for one.
[[nodiscard]] std::unique_lock<std::recursive_mutex> lock_driver();

/// True if the libraries of EGL and OpenGL can be loaded. Call it before any function of EGL or OpenGL:
/// libepoxy ends the process if a library is missing.
[[nodiscard]] bool has_libraries();

/// Mesa's variable that keeps it from storing compiled shaders in files for later processes.
inline constexpr const char* kNoShaderCache = "MESA_SHADER_CACHE_DISABLE";

/// Prepares the process for EGL; call it before any other use of EGL, under lock_driver(). Sets two variables
/// unless they are set, because Mesa waits forever for threads that could not start or that fork() left in
/// the parent: LP_NUM_THREADS to 0, as llvmpipe's threads cost more than they save, and kNoShaderCache to
/// true, as a thread writes the shaders. Throws corda::Error (kNoGl) with the Debian package if a library is
/// missing.
void prepare_driver();

/// Records that this process has used a driver. `is_safe_after_fork`: a child of fork() may make a context,
/// because the driver has no threads that the child would lack.
void note_driver_use(bool is_safe_after_fork);

/// Throws corda::Error (kNoGl) in a process whose parent has used a driver that does not survive fork().
void require_driver_after_fork();

/// Records that a driver draws wrongly. From then on no context is destroyed: Mesa 25 with GALLIUM_NOOP
/// crashes when a context is.
void note_faulty_driver();

/// True after note_faulty_driver().
[[nodiscard]] bool is_driver_faulty();

/// The remedy if no driver gives a context, or draws wrongly.
inline constexpr const char* kDriverRemedy =
    "On Debian: apt-get install libegl-mesa0 libgl1-mesa-dri; unset variables that choose or change a driver "
    "(EGL_..., LIBGL_..., MESA_..., GALLIUM_..., LD_LIBRARY_PATH); EGL_LOG_LEVEL=debug shows what it reports";

}  // namespace corda::gl
