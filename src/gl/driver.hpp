#pragma once

#include <mutex>
#include <string>

namespace corda::gl {

/// Locks all use of EGL, and of OpenGL on the CPU, in this process. fork() waits for the lock, so that a
/// child finds it free and the driver's data complete.
[[nodiscard]] std::unique_lock<std::recursive_mutex> lock_driver();

/// True if the libraries of EGL and OpenGL can be loaded and have the functions that Corda calls. libepoxy
/// ends the process if they cannot, so no function of EGL or OpenGL may be called before this has been true.
[[nodiscard]] bool has_libraries();

/// Prepares the process for EGL; call it before any other use of EGL, under lock_driver(). Sets
/// LP_NUM_THREADS to 0 unless it is set: llvmpipe waits for ever for threads that could not start or that
/// fork() left in the parent, and the threads cost more than they save. Unsets LP_NATIVE_VECTOR_WIDTH unless
/// it is 128 or 256: llvmpipe crashes with other values, including 512 (Mesa 22.3), and pictures do not
/// depend on it. Throws corda::Error: kNoGl with the Debian package if a library is missing, kTemporary if
/// the limit on the address space leaves too little.
void prepare_driver();

/// The variable that prepare_driver() has unset, as "NAME=value"; empty if there is none.
[[nodiscard]] std::string dropped_variable();

/// Records how this process uses its driver. `is_safe` is true if a child of fork() may make a context, as
/// no thread of the driver is lost in it.
void note_driver_use(bool is_safe_after_fork);

/// Throws corda::Error (kNoGl) in a process whose parent has used a driver that does not survive fork().
void require_driver_after_fork();

/// Records that a driver draws wrongly. Its contexts are not destroyed from now on: Mesa 25's driver that
/// draws nothing (GALLIUM_NOOP) crashes there.
void note_faulty_driver();

/// True after note_faulty_driver().
[[nodiscard]] bool is_driver_faulty();

/// The environment variables that are set and choose, replace or change a driver, as "NAME=value" in
/// alphabetical order, separated by commas; empty if none is set. Those that only log or cache are left out.
[[nodiscard]] std::string driver_variables();

/// True if a variable of driver_variables() is set other than the usual ones of a machine without a screen,
/// with which no driver is known to crash.
[[nodiscard]] bool has_unusual_variables();

/// Remedy if no driver gives a context, as a sentence: variables to unset, packages that are missing, or how
/// to learn more.
[[nodiscard]] std::string driver_remedy();

}  // namespace corda::gl
