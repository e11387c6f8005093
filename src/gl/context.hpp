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
    std::optional<int> device;  ///< for kDevice: index into EGL's device list; nullopt: the first that works
    bool require_gpu = false;   ///< refuse renderers that run on the CPU

    /// Reads "auto", "device", "device:N", "surfaceless" or "default". Throws corda::Error (kUsage).
    static ContextDef parse(std::string_view text);
};

/// What EGL and OpenGL report about a context.
struct ContextInfo {
    std::string egl_vendor;
    std::string egl_version;
    std::string gl_vendor;
    std::string gl_renderer;
    std::string gl_version;
    int max_texture_px = 0;
    bool software = false;  ///< the renderer runs on the CPU: llvmpipe, softpipe or swrast
};

/// Stands for a platform in an Attempt if none can be tried.
inline constexpr const char* kEveryPlatform = "every platform";

/// One platform that was tried. If it failed, `failure` names the step and the reason.
struct Attempt {
    std::string platform;             ///< e.g. "EGL device 0 (/dev/dri/card0)"
    std::optional<ContextInfo> info;  ///< empty if there is no context
    std::string failure;              ///< empty if the platform is usable
    ExitCode code = ExitCode::kOk;    ///< of the failure

    [[nodiscard]] bool is_usable() const { return failure.empty(); }
};

/// An OpenGL 4.5 core context without a window. It is current on the thread that created it.
class Context {
  public:
    /// Tries EGL devices (GPUs first), Mesa's surfaceless platform and the default display, in this order, or
    /// only what `def` names. Renderers that run on the CPU are skipped if `def` requires a GPU. Throws
    /// corda::Error: kNoGl with the reason of every failure if no platform is left, kTemporary if memory is
    /// too little.
    explicit Context(const ContextDef& def = {});
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context();

    /// Makes this context current on the calling thread. Throws corda::Error (kNoGl), for instance if it is
    /// current on another thread, or in a forked child of the process that made it.
    void make_current() const;

    /// True in a forked child of the process that made this context. It cannot be used there, nor can the
    /// objects made in it be destroyed; a new context can be made.
    [[nodiscard]] bool is_inherited() const;

    /// Keeps other threads from OpenGL on the CPU while the lock lives; of a GPU's context it is no lock.
    /// Whoever draws takes it. llvmpipe (Mesa 22.3) looks for a texture in what all contexts of the process
    /// are drawing, without a lock of its own: one in some hundred videos that were drawn by several threads
    /// crashed.
    [[nodiscard]] std::unique_lock<std::recursive_mutex> exclusive() const;

    [[nodiscard]] const ContextInfo& info() const;
    /// The platform that provides the context, e.g. "EGL device 0".
    [[nodiscard]] const std::string& platform() const;

  private:
    friend std::vector<Attempt> probe_contexts(const std::function<void(const Context&)>& check,
                                               const std::function<void(const ContextDef&)>& before);
    explicit Context(const Platform& platform);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Makes what is current on the calling thread at construction, be it a context of anyone or none, current
/// again at the end: nested uses, and the host application's own, keep their context. Does nothing without
/// EGL, and at the end in a forked child.
class SavedContext {
  public:
    SavedContext();
    SavedContext(const SavedContext&) = delete;
    SavedContext& operator=(const SavedContext&) = delete;
    ~SavedContext();

  private:
    // EGL's handles; all are pointers without a type.
    void* display_ = nullptr;
    void* context_ = nullptr;
    void* draw_surface_ = nullptr;
    void* read_surface_ = nullptr;
    unsigned api_ = 0x3038;  ///< EGL_NONE: there is no EGL
    pid_t process_;
};

/// Tries every platform and reports what each gives. `before` is called with what chooses a platform before
/// its context is made, and `check` with the context while it is current; what they throw is the failure of
/// the platform. The thread's current context stays current.
[[nodiscard]] std::vector<Attempt> probe_contexts(const std::function<void(const Context&)>& check = {},
                                                  const std::function<void(const ContextDef&)>& before = {});

}  // namespace corda::gl
