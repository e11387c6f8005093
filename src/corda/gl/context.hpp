#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"

namespace corda::gl {

struct Platform;

/// Which EGL platforms may be used to get an OpenGL context.
struct ContextDef {
    enum class Backend { kAuto, kDevice, kSurfaceless, kDefault };
    Backend backend = Backend::kAuto;
    /// For kDevice: index into EGL's device list; nullopt: the first that works.
    std::optional<int> device = {};
    bool require_gpu = false;  ///< refuse renderers on the CPU

    /// Reads "auto", "device", "device:N", "surfaceless" or "default". Throws corda::Error (kUsage).
    static ContextDef parse(std::string_view text);

    bool operator==(const ContextDef&) const = default;
};

/// Properties of a context that EGL and OpenGL report.
struct ContextInfo {
    std::string egl_vendor;
    std::string egl_version;
    std::string gl_vendor;
    std::string gl_renderer;
    std::string gl_version;
    int max_texture_px = 0;
    bool software = false;  ///< renders on the CPU: llvmpipe, softpipe or swrast
};

/// The outcome of trying one platform.
struct Attempt {
    std::string platform;  ///< "EGL device 0 (/dev/dri/card0)"; "every platform" if none can be tried
    std::optional<ContextInfo> info;  ///< empty if there is no context
    std::string failure;              ///< the step that failed and the reason; empty if usable
    ExitCode code = ExitCode::kOk;    ///< of the failure

    [[nodiscard]] bool is_usable() const { return failure.empty(); }
};

/// An OpenGL 4.5 core context without a window. It is current on the thread that created it.
class Context : NonCopyable {
  public:
    /// Tries EGL devices (GPUs first), Mesa's surfaceless platform and the default display, in this order, or
    /// only the platforms that `def` names. Throws corda::Error (kNoGl) with the reason of every failure if
    /// no platform works.
    explicit Context(const ContextDef& def = {});
    ~Context();

    /// Makes this context current on the calling thread. Throws corda::Error (kNoGl), e.g. if it is current
    /// on another thread, or in a forked child of the process that made it.
    void make_current() const;

    /// True in a forked child of the process that made this context. The child can neither use it nor destroy
    /// its objects, but can make a new context.
    [[nodiscard]] bool is_inherited() const;

    /// Excludes other threads from OpenGL on the CPU while the lock lives; empty for a context of a GPU. All
    /// drawing code takes it: llvmpipe (Mesa 22.3) searches the scenes of all contexts of the process for a
    /// texture without a lock, and about one in some hundred videos drawn by several threads crashed.
    [[nodiscard]] std::unique_lock<std::recursive_mutex> exclusive() const;

    [[nodiscard]] const ContextInfo& info() const;
    /// The platform that provides the context, e.g. "EGL device 0".
    [[nodiscard]] const std::string& platform() const;

  private:
    friend std::vector<Attempt> probe_contexts(const std::function<void(const Context&)>& check);
    explicit Context(const Platform& platform);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Restores the current context of the calling thread, which may be the host application's or none, at the
/// end of its life. Does nothing without EGL, and does not restore in a forked child.
class SavedContext : NonCopyable {
  public:
    SavedContext();
    ~SavedContext();

  private:
    // EGL handles, which are untyped pointers.
    void* display_ = nullptr;
    void* context_ = nullptr;
    void* draw_surface_ = nullptr;
    void* read_surface_ = nullptr;
    unsigned api_ = 0x3038;  ///< EGL_NONE: there is no EGL
    pid_t process_;
};

/// Tries every platform. Calls `check` with the context while it is current; an exception from it is the
/// platform's failure. The thread's current context stays current.
[[nodiscard]] std::vector<Attempt> probe_contexts(const std::function<void(const Context&)>& check = {});

}  // namespace corda::gl
