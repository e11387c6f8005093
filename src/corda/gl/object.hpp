#pragma once

#include <epoxy/egl.h>
// epoxy/egl.h must precede epoxy/gl.h.
#include <epoxy/gl.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "corda/core/basics.hpp"

namespace corda::gl {

/// Owns one OpenGL object name and deletes it with `Kind::destroy`. Move-only. Its context must be current
/// when it is destroyed, so declare a context before the objects created in it.
template <typename Kind>
class Object {
  public:
    Object() : id_(Kind::create()) {}
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    Object(Object&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    Object& operator=(Object&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~Object() {
        if (id_ != 0) Kind::destroy(id_);
    }

    [[nodiscard]] GLuint id() const { return id_; }

  private:
    GLuint id_;
};

/// Objects that OpenGL makes and deletes by the array, with these functions.
template <auto& kGenerate, auto& kDelete>
struct ArrayKind {
    static GLuint create() {
        GLuint id = 0;
        kGenerate(1, &id);
        return id;
    }
    static void destroy(GLuint id) { kDelete(1, &id); }
};

using Buffer = Object<ArrayKind<glGenBuffers, glDeleteBuffers>>;
using VertexArray = Object<ArrayKind<glGenVertexArrays, glDeleteVertexArrays>>;
using Texture = Object<ArrayKind<glGenTextures, glDeleteTextures>>;
using Framebuffer = Object<ArrayKind<glGenFramebuffers, glDeleteFramebuffers>>;

/// Throws corda::Error if glGetError() reports an error: kTemporary for GL_OUT_OF_MEMORY, kNoGl for others.
/// The message names the error and the operation `what`.
void check_errors(const std::string& what);

/// Throws corda::Error (kNoGl) with OpenGL's reason if the bound draw framebuffer is incomplete.
void check_framebuffer(const std::string& what);

/// A linked program of one vertex and one fragment shader.
class Program {
  public:
    /// `name` is used in error messages. Throws corda::Error (kNoGl) with the driver's log if a shader does
    /// not compile or the program does not link.
    Program(const std::string& name, const char* vertex_source, const char* fragment_source);

    void use() const;

    /// Sets an active uniform. Throws corda::Error (kInternal) if there is none of that name.
    void set(const char* uniform, float value) const;
    void set(const char* uniform, float x, float y) const;

  private:
    struct Kind {
        static GLuint create() { return glCreateProgram(); }
        static void destroy(GLuint id) { glDeleteProgram(id); }
    };

    [[nodiscard]] GLint location_of(const char* uniform) const;

    std::string name_;
    Object<Kind> program_;
};

/// A buffer that OpenGL reads pixels into asynchronously. Its context must be current whenever it is used and
/// when it is destroyed.
class PixelBuffer : NonCopyable {
  public:
    ~PixelBuffer();

    /// Makes room for `bytes` and discards earlier contents. Until end(), glReadPixels() writes to this
    /// buffer and takes buffer_offset() as its address. Throws corda::Error (kTemporary) if memory is too
    /// small.
    void begin(std::size_t bytes);
    void end();

    /// Waits for the reads between begin() and end(), and returns the start of the buffer, valid until the
    /// next begin(). Throws corda::Error (kNoGl) if the driver fails.
    [[nodiscard]] const std::byte* wait();

  private:
    void delete_fence();

    std::optional<Buffer> buffer_;
    std::size_t bytes_ = 0;
    const std::byte* mapped_ = nullptr;  ///< valid as long as the buffer lives
    GLsync fence_ = nullptr;             ///< signalled after the reads
};

/// An offset in a PixelBuffer in the form that glReadPixels() takes.
[[nodiscard]] void* buffer_offset(std::size_t bytes);

}  // namespace corda::gl
