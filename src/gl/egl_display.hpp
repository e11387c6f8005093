#pragma once

#include <epoxy/egl.h>

#include <optional>
#include <string>
#include <vector>

#include "corda/gl/context.hpp"

namespace corda::gl {

/// A way to an EGL display that this machine may have.
struct Platform {
    enum class Kind { kDevice, kSurfaceless, kDefault };
    Kind kind = Kind::kDefault;
    std::string name;
    int device_index = -1;
    EGLDeviceEXT device = nullptr;
};

/// The platforms that `def` allows, in the order to try them. Being listed does not mean that one works.
[[nodiscard]] std::vector<Platform> list_platforms(const ContextDef& def);

/// An initialised EGL display with a surfaceless context made current, or the reason why there is none.
class EglSession {
  public:
    /// Throws corda::Error (kNoGl) that names the failed step and EGL's reason.
    explicit EglSession(const Platform& platform);
    EglSession(const EglSession&) = delete;
    EglSession& operator=(const EglSession&) = delete;
    ~EglSession();

    [[nodiscard]] const ContextInfo& info() const { return info_; }

  private:
    void open_display(const Platform& platform);
    void create_context();
    void read_info();
    void close();

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    ContextInfo info_;
};

}  // namespace corda::gl
