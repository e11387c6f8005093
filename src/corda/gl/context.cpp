#include "corda/gl/context.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>

#include <epoxy/egl.h>
#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/gl/driver.hpp"
#include "corda/gl/egl_display.hpp"

namespace corda::gl {

struct Context::Impl : EglSession {
    explicit Impl(const Platform& from) : EglSession(from), platform(from.name) {}
    std::string platform;
};

ContextDef ContextDef::parse(std::string_view text) {
    constexpr std::array<std::string_view, 4> kNames{"auto", "device", "surfaceless", "default"};
    if (const auto name = std::ranges::find(kNames, text); name != kNames.end())
        return {.backend = static_cast<Backend>(name - kNames.begin())};
    constexpr std::string_view kDevicePrefix = "device:";
    if (text.starts_with(kDevicePrefix)) {
        const auto index = whole_number<int>(text.substr(kDevicePrefix.size()));
        if (index && *index >= 0) return {.backend = Backend::kDevice, .device = *index};
    }
    throw_usage("backend \"{}\" is unknown; use auto, device, device:N, surfaceless or default", text);
}

Context::Context(const ContextDef& def) {
    const auto lock = lock_driver();
    require_driver_after_fork();
    prepare_driver();
    std::string reasons;
    bool found_software = false;
    for (const Platform& platform : list_platforms(def)) {
        try {
            impl_ = std::make_unique<Impl>(platform);
        } catch (const Error& error) {
            reasons += fmt::format("\n  {}: {}", platform.name, error.what());
            continue;
        }
        if (!def.require_gpu || !impl_->info().software) return;
        found_software = true;
        reasons += fmt::format("\n  {}: {} runs on the CPU and a GPU is required", platform.name,
                               impl_->info().gl_renderer);
        impl_.reset();
    }
    if (reasons.empty()) reasons = "\n  no such EGL device";
    const std::string remedy =
        found_software
            ? "Install the GPU's driver, or draw on the CPU, which gives the same bytes: do not require a GPU"
        : def.backend != ContextDef::Backend::kAuto
            ? "Take backend auto, or one that `corda doctor` shows as usable"
            : std::string(kDriverRemedy);
    throw_error(ExitCode::kNoGl, "no usable OpenGL. Tried:{}\n{}", reasons, remedy);
}

Context::Context(const Platform& platform) : impl_(std::make_unique<Impl>(platform)) {}

Context::~Context() {
    const auto lock = lock_driver();
    impl_.reset();
}

std::unique_lock<std::recursive_mutex> Context::exclusive() const {
    return info().software ? lock_driver() : std::unique_lock<std::recursive_mutex>();
}

bool Context::is_inherited() const {
    return impl_->is_inherited();
}

void Context::make_current() const {
    const auto lock = exclusive();
    impl_->make_current();
}

const ContextInfo& Context::info() const {
    return impl_->info();
}

const std::string& Context::platform() const {
    return impl_->platform;
}

SavedContext::SavedContext() : process_(getpid()) {
    const auto lock = lock_driver();
    if (!has_libraries()) return;
    display_ = eglGetCurrentDisplay();
    context_ = eglGetCurrentContext();
    draw_surface_ = eglGetCurrentSurface(EGL_DRAW);
    read_surface_ = eglGetCurrentSurface(EGL_READ);
    api_ = eglQueryAPI();
}

SavedContext::~SavedContext() {
    const auto lock = lock_driver();
    if (api_ == EGL_NONE || process_ != getpid()) return;
    // Errors are ignored: a context that has been lost since cannot be restored.
    if (eglGetCurrentContext() != context_) {
        EGLDisplay display = context_ == EGL_NO_CONTEXT ? eglGetCurrentDisplay() : display_;
        eglMakeCurrent(display, draw_surface_, read_surface_, context_);
    }
    eglBindAPI(api_);
}

std::vector<Attempt> probe_contexts(const std::function<void(const Context&)>& check) {
    const auto lock = lock_driver();
    const SavedContext saved;
    std::vector<Attempt> attempts;
    std::vector<Platform> platforms;
    try {
        require_driver_after_fork();
        prepare_driver();
        platforms = list_platforms({});
    } catch (const Error& error) {
        return {{"every platform", std::nullopt, error.what(), error.code()}};
    }
    for (const Platform& platform : platforms) {
        Attempt& attempt = attempts.emplace_back(Attempt{platform.name, std::nullopt, "", ExitCode::kOk});
        try {
            const Context context(platform);
            attempt.info = context.info();
            if (check) check(context);
        } catch (const Error& error) {
            attempt.failure = error.what();
            attempt.code = error.code();
        }
    }
    return attempts;
}

}  // namespace corda::gl
