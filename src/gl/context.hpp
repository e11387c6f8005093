#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace corda::gl {

/// Which way to OpenGL may be taken.
struct ContextDef {
    enum class Backend { kAuto, kDevice, kSurfaceless, kDefault };
    Backend backend = Backend::kAuto;
    std::optional<int> device;  ///< index of EGL's device list, for kDevice; nothing: the first that works
    bool require_gpu = false;   ///< refuse a renderer that runs on the CPU

    /// Reads "auto", "device", "device:N", "surfaceless" or "default". Throws corda::Error (kUsage).
    static ContextDef parse(std::string_view text);
};

/// What a context turned out to be.
struct ContextInfo {
    std::string egl_vendor;
    std::string egl_version;
    std::string gl_vendor;
    std::string gl_renderer;
    std::string gl_version;
    int max_texture_px = 0;
    bool software = false;  ///< llvmpipe, softpipe or swrast
};

/// One way to OpenGL that was tried: it worked, or `failure` says which step failed and why.
struct Attempt {
    std::string platform;  ///< e.g. "EGL device 0 (/dev/dri/card0)"
    std::optional<ContextInfo> info;
    std::string failure;
};

/// An OpenGL 4.3 core context without a window, current on the thread that made it.
class Context {
  public:
    /// Tries EGL devices (GPUs first), Mesa's surfaceless platform and the default display, in this order, or
    /// only what `def` names. Throws corda::Error (kNoGl) with every reason where none works, or where the
    /// first that works runs on the CPU and `def` requires a GPU.
    explicit Context(const ContextDef& def = {});
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context();

    [[nodiscard]] const ContextInfo& info() const;
    /// How the context was reached, e.g. "EGL device 0".
    [[nodiscard]] const std::string& platform() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Tries every way to OpenGL and reports each.
[[nodiscard]] std::vector<Attempt> probe_contexts();

}  // namespace corda::gl
