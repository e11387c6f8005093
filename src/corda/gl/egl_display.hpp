#pragma once

#include <epoxy/egl.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "corda/gl/context.hpp"

namespace corda::gl {

/// An EGL platform, or an EGL device, that this machine may offer a display for.
struct Platform {
    ContextDef def;  ///< that selects only this platform
    std::string name;
    EGLDeviceEXT device = nullptr;
};

/// The platforms that `def` allows, in the order in which to try them. A listed platform need not work.
[[nodiscard]] std::vector<Platform> list_platforms(const ContextDef& def);

/// An initialised EGL display and a surfaceless context, current on this thread. All uses require
/// lock_driver().
class EglSession : NonCopyable {
  public:
    /// Throws corda::Error (kNoGl) with the failed step and EGL's reason.
    explicit EglSession(const Platform& platform);
    ~EglSession();

    /// Throws corda::Error (kNoGl); always in a forked child of the process that made it.
    void make_current() const;
    /// True in a forked child of the process that made it, which must neither use nor destroy its objects.
    [[nodiscard]] bool is_inherited() const { return process_ != getpid(); }

    [[nodiscard]] const ContextInfo& info() const { return info_; }

  private:
    void open_display(const Platform& platform);
    void create_context();
    void read_info();
    void close();

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    ContextInfo info_;
    bool is_shared_ = false;  ///< the host application has initialised the display
    pid_t process_ = getpid();
};

}  // namespace corda::gl
