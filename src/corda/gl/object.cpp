#include "corda/gl/object.hpp"

#include <array>
#include <bit>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "corda/core/text.hpp"

namespace corda::gl {
namespace {

struct Name {
    GLenum value;
    const char* text;
};

constexpr std::array<Name, 6> kErrors{{{GL_INVALID_ENUM, "GL_INVALID_ENUM"},
                                       {GL_INVALID_VALUE, "GL_INVALID_VALUE"},
                                       {GL_INVALID_OPERATION, "GL_INVALID_OPERATION"},
                                       {GL_INVALID_FRAMEBUFFER_OPERATION, "GL_INVALID_FRAMEBUFFER_OPERATION"},
                                       {GL_OUT_OF_MEMORY, "GL_OUT_OF_MEMORY"},
                                       {GL_CONTEXT_LOST, "GL_CONTEXT_LOST"}}};
constexpr std::array<Name, 4> kFramebufferStates{
    {{GL_FRAMEBUFFER_UNDEFINED, "GL_FRAMEBUFFER_UNDEFINED"},
     {GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT, "GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT"},
     {GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT, "GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT"},
     {GL_FRAMEBUFFER_UNSUPPORTED, "GL_FRAMEBUFFER_UNSUPPORTED"}}};

/// The name of a value, or `kind` with its number.
std::string text_of(std::span<const Name> names, GLenum value, std::string_view kind) {
    for (const Name& name : names)
        if (name.value == value) return name.text;
    return fmt::format("{} {:#x}", kind, value);
}

template <GLenum kStage>
struct ShaderKind {
    static GLuint create() { return glCreateShader(kStage); }
    static void destroy(GLuint id) { glDeleteShader(id); }
};

/// The log of a shader or program, read by these functions.
template <class GetInteger, class GetLog>
std::string log_of(GLuint id, const GetInteger& get_integer, const GetLog& get_log) {
    GLint size = 0;
    get_integer(id, GL_INFO_LOG_LENGTH, &size);
    std::string log(static_cast<std::size_t>(size), '\0');
    get_log(id, size, nullptr, log.data());
    return log;
}

void compile(GLuint shader, const char* source, const std::string& what) {
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_TRUE) return;
    throw_error(ExitCode::kNoGl, "the driver cannot compile the {} shader: {}", what,
                log_of(shader, glGetShaderiv, glGetShaderInfoLog));
}

/// Clears OpenGL's error flags for the next check. A lost context reports errors endlessly, hence the limit.
void discard_errors() {
    for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; ++i) {
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
    throw_error(ExitCode::kNoGl, "{}: OpenGL reports {}; see: corda doctor", what,
                text_of(kErrors, error, "GL error"));
}

void check_framebuffer(const std::string& what) {
    const GLenum status = glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) return;
    throw_error(ExitCode::kNoGl, "{}: OpenGL reports {}; see: corda doctor", what,
                text_of(kFramebufferStates, status, "framebuffer status"));
}

Program::Program(const std::string& name, const char* vertex_source, const char* fragment_source)
    : name_(name) {
    const Object<ShaderKind<GL_VERTEX_SHADER>> vertex;
    const Object<ShaderKind<GL_FRAGMENT_SHADER>> fragment;
    compile(vertex.id(), vertex_source, name + " vertex");
    compile(fragment.id(), fragment_source, name + " fragment");
    glAttachShader(program_.id(), vertex.id());
    glAttachShader(program_.id(), fragment.id());
    glLinkProgram(program_.id());
    glDetachShader(program_.id(), vertex.id());
    glDetachShader(program_.id(), fragment.id());
    GLint linked = GL_FALSE;
    glGetProgramiv(program_.id(), GL_LINK_STATUS, &linked);
    if (linked == GL_TRUE) return;
    throw_error(ExitCode::kNoGl, "the driver cannot link the {} program: {}", name,
                log_of(program_.id(), glGetProgramiv, glGetProgramInfoLog));
}

void Program::use() const {
    glUseProgram(program_.id());
}

void Program::set(const char* uniform, float value) const {
    glProgramUniform1f(program_.id(), location_of(uniform), value);
}

void Program::set(const char* uniform, float x, float y) const {
    glProgramUniform2f(program_.id(), location_of(uniform), x, y);
}

GLint Program::location_of(const char* uniform) const {
    const GLint location = glGetUniformLocation(program_.id(), uniform);
    if (location < 0) throw_error(ExitCode::kInternal, "program {} has no uniform {}", name_, uniform);
    return location;
}

PixelBuffer::~PixelBuffer() {
    delete_fence();
}

void PixelBuffer::begin(std::size_t bytes) {
    delete_fence();
    if (buffer_ && bytes <= bytes_) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_->id());
        return;
    }
    bytes = std::bit_ceil(bytes);  // few reallocations for frames that need more and more
    buffer_.reset();
    buffer_.emplace();
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_->id());
    constexpr GLbitfield kFlags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const auto size = static_cast<GLsizeiptr>(bytes);
    glBufferStorage(GL_PIXEL_PACK_BUFFER, size, nullptr, kFlags);
    mapped_ = static_cast<const std::byte*>(glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0, size, kFlags));
    if (mapped_ == nullptr) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        buffer_.reset();
        discard_errors();
        throw_error(
            ExitCode::kTemporary,
            "OpenGL has no {} bytes to read pixels into; take a smaller size, or try again with more memory",
            bytes);
    }
    bytes_ = bytes;
}

void PixelBuffer::end() {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    fence_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();  // some drivers start only at the wait otherwise
}

const std::byte* PixelBuffer::wait() {
    GLenum status = GL_TIMEOUT_EXPIRED;
    while (status == GL_TIMEOUT_EXPIRED)  // a driver may limit the timeout
        status = glClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, std::numeric_limits<GLuint64>::max());
    if (status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED) return mapped_;
    throw Error(ExitCode::kNoGl, "OpenGL failed to read pixels; see: corda doctor");
}

void PixelBuffer::delete_fence() {
    if (fence_ != nullptr) glDeleteSync(std::exchange(fence_, nullptr));
}

void* buffer_offset(std::size_t bytes) {
    return std::bit_cast<void*>(bytes);
}

}  // namespace corda::gl
