#include "corda/gl/check.hpp"

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/gl/object.hpp"

namespace corda::gl {
namespace {

std::string error_text(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        case GL_CONTEXT_LOST:
            return "GL_CONTEXT_LOST";
        default:
            return fmt::format("GL error {:#x}", error);
    }
}

std::string framebuffer_text(GLenum status) {
    switch (status) {
        case GL_FRAMEBUFFER_UNDEFINED:
            return "GL_FRAMEBUFFER_UNDEFINED";
        case GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT:
            return "GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT";
        case GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT:
            return "GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT";
        case GL_FRAMEBUFFER_UNSUPPORTED:
            return "GL_FRAMEBUFFER_UNSUPPORTED";
        default:
            return fmt::format("framebuffer status {:#x}", status);
    }
}

}  // namespace

void check_errors(const std::string& what) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    if (error == GL_OUT_OF_MEMORY) {
        throw Error(ExitCode::kTemporary,
                    what + ": OpenGL is out of memory; take a smaller size, or try again with more memory");
    }
    throw Error(ExitCode::kNoGl,
                fmt::format("{}: OpenGL reports {}; see: corda doctor", what, error_text(error)));
}

void check_framebuffer(const std::string& what) {
    const GLenum status = glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) return;
    throw Error(ExitCode::kNoGl,
                fmt::format("{}: OpenGL reports {}; see: corda doctor", what, framebuffer_text(status)));
}

}  // namespace corda::gl
