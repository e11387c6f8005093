#pragma once

#include <mutex>
#include <string>

namespace corda::gl {

/// Locks EGL, and OpenGL on the CPU, for this process. fork() waits for the lock, so that the child finds it
/// free and the driver's data consistent. Recursive, because code that holds it for several steps (a probe, a
/// check, a trial in a child process) calls code that takes it for one.
[[nodiscard]] std::unique_lock<std::recursive_mutex> lock_driver();

/// True if the libraries of EGL and OpenGL can be loaded and have the functions that Corda calls. Call it
/// before any function of EGL or OpenGL: libepoxy ends the process if a library or function is missing.
[[nodiscard]] bool has_libraries();

/// Prepares the process for EGL; call it before any other use of EGL, under lock_driver(). Sets
/// LP_NUM_THREADS to 0 unless it is set: llvmpipe waits forever for threads that could not start or that
/// fork() left in the parent, and the threads cost more than they save. Unsets LP_NATIVE_VECTOR_WIDTH unless
/// it is 128 or 256: llvmpipe crashes with other values, including 512 (Mesa 22.3), and no picture depends on
/// it. Throws corda::Error: kNoGl with the Debian package if a library is missing, kTemporary if the address
/// space is limited too tightly.
void prepare_driver();

/// The variable that prepare_driver() has unset, as "NAME=value"; empty for none.
[[nodiscard]] std::string dropped_variable();

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

/// The environment variables that select, replace or change a driver, as "NAME=value" in alphabetical order,
/// separated by commas; empty if none is set. Omits variables that only affect logs and caches.
[[nodiscard]] std::string driver_variables();

/// True if driver_variables() has more than the usual settings of a machine without a screen, with which no
/// driver is known to crash.
[[nodiscard]] bool has_unusual_variables();

/// A sentence with the remedy if no driver gives a context: variables to unset, packages to install, or how
/// to find the cause.
[[nodiscard]] std::string driver_remedy();

}  // namespace corda::gl
