#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace corda::gl {

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

/// One platform that was tried. If it failed, `info` is empty and `failure` names the step and the reason.
struct Attempt {
    std::string platform;  ///< e.g. "EGL device 0 (/dev/dri/card0)"
    std::optional<ContextInfo> info;
    std::string failure;
};

/// An OpenGL 4.5 core context without a window. It is current on the thread that created it.
class Context {
  public:
    /// Tries EGL devices (GPUs first), Mesa's surfaceless platform and the default display, in this order, or
    /// only what `def` names. Renderers that run on the CPU are skipped if `def` requires a GPU. Throws
    /// corda::Error (kNoGl) with the reason of every failure if no platform is left.
    explicit Context(const ContextDef& def = {});
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context();

    /// Makes this context current on the calling thread. Throws corda::Error (kNoGl), for instance if it is
    /// current on another thread.
    void make_current() const;

    /// Keeps other threads from OpenGL on the CPU while the lock lives; of a GPU's context it is no lock.
    /// Whoever draws takes it. llvmpipe (Mesa 22.3) looks for a texture in what all contexts of the process
    /// are drawing, without a lock of its own: one in some hundred videos that were drawn by several threads
    /// crashed.
    [[nodiscard]] std::unique_lock<std::recursive_mutex> exclusive() const;

    [[nodiscard]] const ContextInfo& info() const;
    /// The platform that provides the context, e.g. "EGL device 0".
    [[nodiscard]] const std::string& platform() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Makes what is current on the calling thread at construction, be it a context of anyone or none, current
/// again at the end: nested uses, and the host application's own, keep their context.
class SavedContext {
  public:
    SavedContext();
    SavedContext(const SavedContext&) = delete;
    SavedContext& operator=(const SavedContext&) = delete;
    ~SavedContext();

  private:
    // EGL's handles; all are pointers without a type.
    void* display_;
    void* context_;
    void* draw_surface_;
    void* read_surface_;
    unsigned api_;
};

/// Tries every platform and reports what each gives. What is current on the calling thread stays so.
[[nodiscard]] std::vector<Attempt> probe_contexts();

}  // namespace corda::gl
