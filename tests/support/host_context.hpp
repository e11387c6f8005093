#pragma once

#include <epoxy/egl.h>
#include <gtest/gtest.h>

#include <array>

namespace corda::test {

/// The OpenGL ES context of an application that uses Corda, with a surface, on a display that Corda uses too.
class HostContext {
  public:
    HostContext() : display_(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)) {
        const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                           EGL_OPENGL_ES2_BIT, EGL_NONE};
        const std::array<EGLint, 3> version{EGL_CONTEXT_MAJOR_VERSION, 2, EGL_NONE};
        const std::array<EGLint, 5> size{EGL_WIDTH, 8, EGL_HEIGHT, 8, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        EXPECT_EQ(eglInitialize(display_, nullptr, nullptr), EGLBoolean{EGL_TRUE});
        EXPECT_EQ(eglBindAPI(EGL_OPENGL_ES_API), EGLBoolean{EGL_TRUE});
        EXPECT_EQ(eglChooseConfig(display_, wanted.data(), &config, 1, &count), EGLBoolean{EGL_TRUE});
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version.data());
        surface_ = eglCreatePbufferSurface(display_, config, size.data());
        make_current();
    }
    HostContext(const HostContext&) = delete;
    HostContext& operator=(const HostContext&) = delete;
    ~HostContext() {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroySurface(display_, surface_);
        eglDestroyContext(display_, context_);
    }

    void make_current() const {
        EXPECT_EQ(eglMakeCurrent(display_, surface_, surface_, context_), EGLBoolean{EGL_TRUE});
    }

    /// True if the context is current in this thread, with its surface and its API.
    [[nodiscard]] bool is_current() const {
        return eglGetCurrentContext() == context_ && eglGetCurrentDisplay() == display_ &&
               eglGetCurrentSurface(EGL_DRAW) == surface_ && eglGetCurrentSurface(EGL_READ) == surface_ &&
               eglQueryAPI() == EGL_OPENGL_ES_API;
    }

    /// True if EGL still accepts it: its display has not been terminated.
    [[nodiscard]] bool is_alive() const {
        return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT) == EGL_TRUE &&
               eglMakeCurrent(display_, surface_, surface_, context_) == EGL_TRUE;
    }

  private:
    EGLDisplay display_;
    EGLContext context_ = EGL_NO_CONTEXT;
    EGLSurface surface_ = EGL_NO_SURFACE;
};

}  // namespace corda::test
