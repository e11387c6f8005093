#include "corda/gl/context.hpp"

#include <charconv>

#include <fmt/format.h>

#include "corda/core/error.hpp"
#include "corda/gl/egl_display.hpp"

namespace corda::gl {

struct Context::Impl {
    std::string platform;
    std::unique_ptr<EglSession> session;
};

ContextDef ContextDef::parse(std::string_view text) {
    ContextDef def;
    constexpr std::string_view kDevicePrefix = "device:";
    if (text == "auto") {
        def.backend = Backend::kAuto;
    } else if (text == "surfaceless") {
        def.backend = Backend::kSurfaceless;
    } else if (text == "default") {
        def.backend = Backend::kDefault;
    } else if (text == "device") {
        def.backend = Backend::kDevice;
    } else if (text.substr(0, kDevicePrefix.size()) == kDevicePrefix) {
        def.backend = Backend::kDevice;
        int index = -1;
        const char* end = text.data() + text.size();
        const auto [stop, status] = std::from_chars(text.data() + kDevicePrefix.size(), end, index);
        if (status == std::errc{} && stop == end && index >= 0) def.device = index;
    }
    const bool known = def.backend != Backend::kAuto || text == "auto";
    const bool has_index = def.device || def.backend != Backend::kDevice || text == "device";
    if (!known || !has_index) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("backend \"{}\" is unknown; use auto, device, device:N, surfaceless or default",
                        text));
    }
    return def;
}

Context::Context(const ContextDef& def) : impl_(std::make_unique<Impl>()) {
    std::string reasons;
    for (const Platform& platform : list_platforms(def)) {
        try {
            impl_->session = std::make_unique<EglSession>(platform);
        } catch (const Error& error) {
            reasons += fmt::format("\n  {}: {}", platform.name, error.what());
            continue;
        }
        if (!def.require_gpu || !impl_->session->info().software) {
            impl_->platform = platform.name;
            return;
        }
        reasons += fmt::format("\n  {}: {} runs on the CPU and --require-gpu was given", platform.name,
                               impl_->session->info().gl_renderer);
        impl_->session.reset();
    }
    if (reasons.empty()) reasons = "\n  no such EGL device";
    throw Error(ExitCode::kNoGl, "no usable OpenGL. Tried:" + reasons +
                                     "\nOn Debian: apt-get install libegl-mesa0 libgl1-mesa-dri");
}

Context::~Context() = default;

const ContextInfo& Context::info() const {
    return impl_->session->info();
}

const std::string& Context::platform() const {
    return impl_->platform;
}

std::vector<Attempt> probe_contexts() {
    std::vector<Attempt> attempts;
    for (const Platform& platform : list_platforms({})) {
        Attempt& attempt = attempts.emplace_back(Attempt{platform.name, std::nullopt, ""});
        try {
            attempt.info = EglSession(platform).info();
        } catch (const Error& error) {
            attempt.failure = error.what();
        }
    }
    return attempts;
}

}  // namespace corda::gl
