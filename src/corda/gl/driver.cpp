#include "corda/gl/driver.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "corda/core/basics.hpp"

namespace corda::gl {
namespace {

std::recursive_mutex& driver_mutex() {
    static std::recursive_mutex mutex;
    return mutex;
}

/// Makes fork() wait for the mutex. The child constructs a new one: it cannot unlock the old one, because its
/// thread has another id than the thread that locked it.
void guard_fork() {
    static const int registered =
        pthread_atfork([] { driver_mutex().lock(); }, [] { driver_mutex().unlock(); },
                       [] { std::construct_at(&driver_mutex()); });
    static_cast<void>(registered);
}

/// The first process that used a driver, and whether its children may use it. Survives fork().
struct DriverUse {
    pid_t process = 0;
    bool is_safe_after_fork = true;
};

std::atomic<bool> is_faulty{false};

DriverUse driver_use;

/// Opens a library like libepoxy does, until the process ends; null if it cannot be loaded.
void* library(const char* name) {
    return dlopen(name, RTLD_LAZY | RTLD_LOCAL);
}

/// The reason why EGL or OpenGL cannot be called, with the Debian packages; empty if they can.
std::string missing_library() {
    const auto failure = [](const char* name, const char* packages) {
        const char* const reason = dlerror();
        return fmt::format("{} cannot be loaded ({}); on Debian: apt-get install {}", name,
                           reason != nullptr ? reason : "no reason given", packages);
    };
    if (library("libEGL.so.1") == nullptr) return failure("libEGL.so.1", "libegl1 libegl-mesa0");
    const bool has_gl = library("libOpenGL.so.0") != nullptr || library("libGL.so.1") != nullptr;
    return has_gl ? "" : failure("libGL.so.1", "libopengl0");
}

/// Calls libGLX once in each process before a context is current. On the first call in a forked child,
/// libglvnd resets the current context; libepoxy would make that call later, when it looks up a function.
void settle_glx() {
    static pid_t settled_in = 0;
    if (settled_in == getpid()) return;
    settled_in = getpid();
    void* const glx = dlopen("libGLX.so.0", RTLD_LAZY | RTLD_NOLOAD);
    if (glx == nullptr) return;
    using GetCurrentContext = void* (*)();
    const auto get = reinterpret_cast<GetCurrentContext>(dlsym(glx, "glXGetCurrentContext"));
    if (get != nullptr) static_cast<void>(get());
    dlclose(glx);
}

}  // namespace

std::unique_lock<std::recursive_mutex> lock_driver() {
    guard_fork();
    return std::unique_lock(driver_mutex());
}

bool has_libraries() {
    static const bool has = missing_library().empty();
    return has;
}

void prepare_driver() {
    // Only once, because other threads may read the environment.
    static const bool is_set = [] {
        setenv("LP_NUM_THREADS", "0", 0);
        setenv(kNoShaderCache, "true", 0);
        return true;
    }();
    static_cast<void>(is_set);
    if (!has_libraries()) throw Error(ExitCode::kNoGl, "no usable OpenGL: " + missing_library());
    settle_glx();
}

void note_driver_use(bool is_safe_after_fork) {
    if (driver_use.process == 0 || !is_safe_after_fork) driver_use.process = getpid();
    driver_use.is_safe_after_fork &= is_safe_after_fork;
}

void note_faulty_driver() {
    is_faulty = true;
}

bool is_driver_faulty() {
    return is_faulty;
}

void require_driver_after_fork() {
    if (driver_use.process == 0 || driver_use.process == getpid() || driver_use.is_safe_after_fork) return;
    throw Error(
        ExitCode::kNoGl,
        "the parent process has drawn with threads (LP_NUM_THREADS, MESA_SHADER_CACHE_DISABLE) or hardware "
        "that a forked process does not have; start processes by spawn (Python: "
        "multiprocessing.get_context(\"spawn\")), or fork before the first picture");
}

}  // namespace corda::gl
