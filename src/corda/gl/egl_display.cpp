#include "corda/gl/egl_display.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/gl/driver.hpp"
#include "corda/gl/object.hpp"

namespace corda::gl {
namespace {

constexpr int kMajor = 4;
constexpr int kMinor = 5;

struct EglError {
    EGLint code;
    const char* text;
};

constexpr std::array<EglError, 11> kEglErrors{{{EGL_SUCCESS, "no reason given"},
                                               {EGL_NOT_INITIALIZED, "EGL_NOT_INITIALIZED"},
                                               {EGL_BAD_ACCESS, "EGL_BAD_ACCESS"},
                                               {EGL_BAD_ALLOC, "EGL_BAD_ALLOC"},
                                               {EGL_BAD_ATTRIBUTE, "EGL_BAD_ATTRIBUTE"},
                                               {EGL_BAD_CONFIG, "EGL_BAD_CONFIG"},
                                               {EGL_BAD_CONTEXT, "EGL_BAD_CONTEXT"},
                                               {EGL_BAD_DISPLAY, "EGL_BAD_DISPLAY"},
                                               {EGL_BAD_MATCH, "EGL_BAD_MATCH"},
                                               {EGL_BAD_PARAMETER, "EGL_BAD_PARAMETER"},
                                               {EGL_CONTEXT_LOST, "EGL_CONTEXT_LOST"}}};

std::string egl_error_text() {
    const EGLint code = eglGetError();
    for (const EglError& error : kEglErrors)
        if (error.code == code) return error.text;
    return fmt::format("EGL error {:#x}", code);
}

[[noreturn]] void fail(const std::string& step) {
    throw_error(ExitCode::kNoGl, "{} failed: {}", step, egl_error_text());
}

/// True if a display, or the client library for EGL_NO_DISPLAY, has an extension. epoxy_has_egl_extension()
/// crashes if EGL returns null.
bool has_extension(EGLDisplay display, std::string_view name) {
    const char* const given = eglQueryString(display, EGL_EXTENSIONS);
    const std::string_view all(given != nullptr ? given : "");
    for (std::size_t at = all.find(name); at != std::string_view::npos; at = all.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        if ((at == 0 || all[at - 1] == ' ') && (end == all.size() || all[end] == ' ')) return true;
    }
    return false;
}

bool has_client_extension(std::string_view name) {
    return has_extension(EGL_NO_DISPLAY, name);
}

/// True if EGL provides a function of an extension; libepoxy would call a null pointer otherwise.
bool has_function(const char* name) {
    return eglGetProcAddress(name) != nullptr;
}

bool is_software_device(EGLDeviceEXT device) {
    const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    return extensions != nullptr &&
           std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
}

std::string device_name(EGLDeviceEXT device, int index) {
    if (is_software_device(device)) return fmt::format("EGL device {} (software)", index);
    const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    const bool has_file = extensions != nullptr &&
                          std::string_view(extensions).find("EGL_EXT_device_drm") != std::string_view::npos;
    const char* file = has_file ? eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT) : nullptr;
    return file != nullptr ? fmt::format("EGL device {} ({})", index, file)
                           : fmt::format("EGL device {}", index);
}

std::vector<Platform> list_devices() {
    // libepoxy aborts the process on a call of a function that no library has.
    const bool can_list =
        has_client_extension("EGL_EXT_device_base") ||
        (has_client_extension("EGL_EXT_device_enumeration") && has_client_extension("EGL_EXT_device_query"));
    if (!can_list || !has_client_extension("EGL_EXT_platform_device") ||
        !has_function("eglQueryDevicesEXT") || !has_function("eglQueryDeviceStringEXT") ||
        !has_function("eglGetPlatformDisplayEXT"))
        return {};
    std::array<EGLDeviceEXT, 64> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE)
        return {};
    std::vector<Platform> platforms;
    for (int i = 0; i < count; ++i) {
        platforms.push_back(
            {{.backend = ContextDef::Backend::kDevice, .device = i}, device_name(devices[i], i), devices[i]});
    }
    std::stable_partition(platforms.begin(), platforms.end(),
                          [](const Platform& platform) { return !is_software_device(platform.device); });
    return platforms;
}

const char* egl_string(EGLDisplay display, EGLint name) {
    const char* text = eglQueryString(display, name);
    return text != nullptr ? text : "";
}

std::string gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    std::string result;
    for (; text != nullptr && *text != 0; ++text) result += static_cast<char>(*text);
    return result;
}

bool is_software_renderer(std::string renderer) {
    std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    const std::array<std::string_view, 4> names{"llvmpipe", "softpipe", "swrast", "software rasterizer"};
    return std::ranges::any_of(
        names, [&](std::string_view name) { return renderer.find(name) != std::string::npos; });
}

/// Displays that this library has initialised. EGL returns the same display to every caller for a platform,
/// and terminating it would end the host application's contexts too. So the few displays stay initialised
/// until the process ends; in Mesa, each initialisation after a termination also leaks 8 kB.
std::vector<EGLDisplay> own_displays;

/// True if the host application has initialised a display, which only then reports its version.
bool is_of_host(EGLDisplay display) {
    return std::ranges::find(own_displays, display) == own_displays.end() &&
           eglQueryString(display, EGL_VERSION) != nullptr;
}

/// True if Mesa starts no thread that a forked child would lack: none that draws, none that stores shaders.
bool has_no_driver_threads() {
    const auto has = [](const char* name, std::string_view value) {
        const char* const given = std::getenv(name);
        return given != nullptr && given == value;
    };
    return has("LP_NUM_THREADS", "0") && (has(kNoShaderCache, "true") || has(kNoShaderCache, "1"));
}

}  // namespace

std::vector<Platform> list_platforms(const ContextDef& def) {
    using Backend = ContextDef::Backend;
    std::vector<Platform> platforms;
    if (def.backend == Backend::kAuto || def.backend == Backend::kDevice) platforms = list_devices();
    if (def.device) {
        std::erase_if(platforms, [&](const Platform& platform) { return platform.def.device != def.device; });
    }
    const bool automatic = def.backend == Backend::kAuto;
    if (automatic || def.backend == Backend::kSurfaceless) {
        platforms.push_back({{.backend = Backend::kSurfaceless}, "EGL surfaceless (Mesa)"});
    }
    if (automatic || def.backend == Backend::kDefault) {
        platforms.push_back({{.backend = Backend::kDefault}, "EGL default display"});
    }
    return platforms;
}

EglSession::EglSession(const Platform& platform) {
    try {
        open_display(platform);
        create_context();
        read_info();
        note_driver_use(info_.software && has_no_driver_threads() && !is_shared_);
    } catch (...) {
        close();
        throw;
    }
}

EglSession::~EglSession() {
    close();
}

void EglSession::open_display(const Platform& platform) {
    using Backend = ContextDef::Backend;
    if (platform.def.backend == Backend::kDevice) {
        display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, platform.device, nullptr);
    } else if (platform.def.backend == Backend::kSurfaceless) {
        if (!has_client_extension("EGL_EXT_platform_base") ||
            !has_client_extension("EGL_MESA_platform_surfaceless") ||
            !has_function("eglGetPlatformDisplayEXT"))
            throw Error(ExitCode::kNoGl, "this EGL library has no EGL_MESA_platform_surfaceless");
        display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    } else {
        display_ = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    }
    if (display_ == EGL_NO_DISPLAY) fail("getting the display");
    is_shared_ = is_of_host(display_);
    if (eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) fail("eglInitialize");
    if (!is_shared_) own_displays.push_back(display_);
}

void EglSession::create_context() {
    if (!has_extension(display_, "EGL_KHR_surfaceless_context")) {
        throw Error(ExitCode::kNoGl, "the display has no EGL_KHR_surfaceless_context");
    }
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) fail("binding desktop OpenGL");
    const std::array<EGLint, 5> config_attributes{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                                  EGL_NONE};
    EGLConfig config = nullptr;
    EGLint config_count = 0;
    if (!has_extension(display_, "EGL_KHR_no_config_context")) {
        if (eglChooseConfig(display_, config_attributes.data(), &config, 1, &config_count) != EGL_TRUE ||
            config_count == 0) {
            fail("choosing a configuration");
        }
    }
    const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                           kMajor,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           kMinor,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT)
        fail(fmt::format("creating an OpenGL {}.{} core context", kMajor, kMinor));
    make_current();
}

void EglSession::make_current() const {
    if (is_inherited()) {
        throw Error(
            ExitCode::kNoGl,
            "a picture that the parent process had begun cannot be finished in a forked process; begin "
            "it there, or start processes by spawn");
    }
    // The bound API is a state of the thread.
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) fail("binding desktop OpenGL");
    if (eglGetCurrentContext() == context_) return;
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
        fail("making the context current");
}

void EglSession::read_info() {
    info_.egl_vendor = egl_string(display_, EGL_VENDOR);
    info_.egl_version = egl_string(display_, EGL_VERSION);
    info_.gl_vendor = gl_string(GL_VENDOR);
    info_.gl_renderer = gl_string(GL_RENDERER);
    info_.gl_version = gl_string(GL_VERSION);
    info_.software = is_software_renderer(info_.gl_renderer);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &info_.max_texture_px);
    if (info_.gl_version.empty())
        throw Error(ExitCode::kNoGl, "the context is current but glGetString returns no version");
}

void EglSession::close() {
    if (is_inherited() || is_driver_faulty() || context_ == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context_)
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    context_ = EGL_NO_CONTEXT;
}

}  // namespace corda::gl
