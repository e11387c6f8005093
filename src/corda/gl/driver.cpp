#include "corda/gl/driver.hpp"

#include <dlfcn.h>
#include <link.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"

namespace corda::gl {
namespace {

namespace fs = std::filesystem;

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

/// Address space of the first context, mostly the driver's code: measured 200 MB on Mesa 22.3 with LLVM 15.
/// Later versions of LLVM are larger.
constexpr std::uint64_t kFirstContextBytes = 320U << 20U;
/// Memory that the first context writes to.
constexpr std::uint64_t kFirstContextData = 96U << 20U;
/// Each further context, including its programs and their compilation: measured below 10 MB.
constexpr std::uint64_t kContextBytes = 48U << 20U;

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

constexpr std::array kEglFunctions{"eglBindAPI",           "eglChooseConfig",      "eglCreateContext",
                                   "eglDestroyContext",    "eglGetCurrentContext", "eglGetCurrentDisplay",
                                   "eglGetCurrentSurface", "eglGetDisplay",        "eglGetError",
                                   "eglGetProcAddress",    "eglInitialize",        "eglMakeCurrent",
                                   "eglQueryAPI",          "eglQueryString"};

/// Folder of a loaded or loadable library; empty if it cannot be loaded.
fs::path folder_of(const char* name) {
    link_map* map = nullptr;
    void* const handle = library(name);
    if (handle == nullptr || dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0 || map == nullptr) return {};
    return fs::path(map->l_name).parent_path();
}

/// True if a folder has a file whose name starts with one of `beginnings`.
bool holds_any(const fs::path& folder, std::initializer_list<std::string_view> beginnings) {
    std::error_code failed;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
        const std::string name = entry.path().filename();
        for (const std::string_view beginning : beginnings)
            if (name.starts_with(beginning)) return true;
    }
    return false;
}

/// True if one of the folders in a variable contains libraries that belong to a driver.
bool replaces_driver(std::string_view value) {
    for (std::size_t at = 0; at <= value.size();) {
        const std::size_t end = std::min(value.find_first_of(": ", at), value.size());
        const fs::path path = value.substr(at, end - at);
        at = end + 1;
        if (!path.empty() &&
            holds_any(path, {"libEGL", "libGL", "libOpenGL", "libgallium", "libglapi", "libgbm", "libLLVM",
                             "libstdc++", "libdrm", "libexpat", "libz."}))
            return true;
    }
    return false;
}

/// Prefixes of variables that libglvnd, Mesa and NVIDIA read. Lower-case names are Mesa's options for single
/// applications (force_glsl_version, allow_higher_compat_version).
constexpr auto kVariablesOfDrivers = std::to_array<std::string_view>({"EGL_",
                                                                      "__EGL_",
                                                                      "LIBGL_",
                                                                      "MESA_",
                                                                      "GALLIUM_",
                                                                      "GALLIVM_",
                                                                      "LP_",
                                                                      "DRAW_USE_LLVM",
                                                                      "SOFTPIPE_",
                                                                      "TGSI_",
                                                                      "NIR_",
                                                                      "ST_DEBUG",
                                                                      "GBM_BACKEND",
                                                                      "__GL_",
                                                                      "__NV_",
                                                                      "force_gl",
                                                                      "force_compat",
                                                                      "allow_glsl_",
                                                                      "allow_higher_compat",
                                                                      "disable_glsl",
                                                                      "disable_arb_",
                                                                      "disable_blend_"});
/// Prefixes of variables that only affect logs and caches, or that prepare_driver() sets.
constexpr auto kHarmlessVariables = std::to_array<std::string_view>(
    {"EGL_LOG_", "LIBGL_DEBUG", "MESA_DEBUG", "MESA_LOG", "MESA_SHADER_CACHE", "MESA_GLSL_CACHE",
     "MESA_DISK_CACHE", "__GL_SHADER_DISK_CACHE", "LP_NUM_THREADS", "LP_NATIVE_VECTOR_WIDTH"});
constexpr auto kUsualVariables =
    std::to_array<std::string_view>({"EGL_PLATFORM=surfaceless", "GALLIUM_DRIVER=llvmpipe",
                                     "LIBGL_ALWAYS_SOFTWARE=1", "LIBGL_ALWAYS_SOFTWARE=true"});

/// See prepare_driver(). Returns the old value of LP_NATIVE_VECTOR_WIDTH if it unsets it.
std::string set_llvmpipe_variables() {
    setenv("LP_NUM_THREADS", "0", 0);
    const char* const given = std::getenv("LP_NATIVE_VECTOR_WIDTH");
    std::string bits = given != nullptr ? given : "";
    if (bits.empty() || bits == "128" || bits == "256") return "";
    unsetenv("LP_NATIVE_VECTOR_WIDTH");
    return bits;
}

/// The value of LP_NATIVE_VECTOR_WIDTH that prepare_driver() has removed.
std::string dropped_width;

/// The variables that are set and may change a driver's behaviour, as "NAME=value", sorted.
std::vector<std::string> variables_of_driver() {
    std::vector<std::string> set;
    for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
        const std::string_view text(*variable);
        const auto begins = [&](std::string_view beginning) { return text.starts_with(beginning); };
        const bool has_value = text.find('=') + 1 < text.size();
        const bool is_of_driver = begins("LD_LIBRARY_PATH=")
                                      ? replaces_driver(text.substr(text.find('=') + 1))
                                      : std::ranges::any_of(kVariablesOfDrivers, begins) &&
                                            std::ranges::none_of(kHarmlessVariables, begins);
        if (has_value && is_of_driver) set.emplace_back(text);
    }
    std::ranges::sort(set);
    return set;
}

/// Missing Debian packages that every driver needs.
std::vector<std::string> missing_packages() {
    const fs::path mesa = folder_of("libEGL_mesa.so.0");
    std::vector<std::string> packages;
    if (mesa.empty()) packages.emplace_back("libegl-mesa0");
    const bool has_swrast =
        !mesa.empty() && (fs::exists(mesa / "dri/swrast_dri.so") || holds_any(mesa, {"libgallium"}));
    if (!has_swrast) packages.emplace_back("libgl1-mesa-dri");
    return packages;
}

/// The reason why a library cannot be loaded, from dlerror(), with a remedy.
std::string load_failure(const char* name, const char* packages) {
    const char* const given = dlerror();
    const std::string reason = given != nullptr ? given : "no reason given";
    std::string remedy = "remove that file, or reinstall the package that it belongs to";
    if (const std::string variables = driver_variables();
        variables.find("LD_LIBRARY_PATH=") != variables.npos)
        remedy = "unset " + variables;
    else if (reason.find("No such file") != reason.npos)
        remedy = fmt::format("on Debian: apt-get install {}", packages);
    return fmt::format("{} cannot be loaded ({}); {}", name, reason, remedy);
}

/// The reason why EGL or OpenGL cannot be called, with a remedy; empty if they can.
std::string missing_library() {
    void* const egl = library("libEGL.so.1");
    if (egl == nullptr) return load_failure("libEGL.so.1", "libegl1 libegl-mesa0");
    for (const char* const name : kEglFunctions) {
        if (dlsym(egl, name) != nullptr) continue;
        link_map* map = nullptr;
        const bool has_path = dlinfo(egl, RTLD_DI_LINKMAP, &map) == 0 && map != nullptr;
        return fmt::format(
            "{} has no function {}; remove this file, or have another libEGL.so.1 found before it",
            has_path ? map->l_name : "libEGL.so.1", name);
    }
    if (library("libOpenGL.so.0") != nullptr || library("libGL.so.1") != nullptr) return {};
    return load_failure("libGL.so.1", "libopengl0");
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
    const bool is_first = driver_use.process == 0;
    require_address_space(is_first ? kFirstContextBytes : kContextBytes, "OpenGL",
                          is_first ? kFirstContextData : kContextBytes);
    // Only once, because other threads may read the environment.
    static const bool is_set = (dropped_width = set_llvmpipe_variables(), true);
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
        "the parent process has drawn with threads or hardware that a forked process does not have; start "
        "processes by spawn (Python: multiprocessing.get_context(\"spawn\")), or fork before the first "
        "picture");
}

std::string dropped_variable() {
    const auto lock = lock_driver();
    return dropped_width.empty() ? "" : "LP_NATIVE_VECTOR_WIDTH=" + dropped_width;
}

std::string driver_variables() {
    return fmt::format("{}", fmt::join(variables_of_driver(), ", "));
}

bool has_unusual_variables() {
    const std::vector<std::string> set = variables_of_driver();
    return std::ranges::any_of(set, [](const std::string& variable) {
        return std::ranges::find(kUsualVariables, variable) == kUsualVariables.end();
    });
}

std::string driver_remedy() {
    const std::string variables = driver_variables();
    const std::vector<std::string> packages = missing_packages();
    if (!packages.empty() && variables.empty())
        return fmt::format("On Debian: apt-get install {}", fmt::join(packages, " "));
    if (!variables.empty()) {
        return fmt::format("Unset what chooses or changes the driver: {}{}", variables,
                           packages.empty() ? ""
                                            : fmt::format("; if that does not help, apt-get install {}",
                                                          fmt::join(packages, " ")));
    }
    return "The files of Mesa's driver are installed; EGL_LOG_LEVEL=debug shows what it reports";
}

}  // namespace corda::gl
