#include "corda/gl/program.hpp"

#include <fmt/format.h>

#include "corda/core/basics.hpp"

namespace corda::gl {
namespace {

template <GLenum kStage>
struct ShaderKind {
    static GLuint create() { return glCreateShader(kStage); }
    static void destroy(GLuint id) { glDeleteShader(id); }
};

void compile(GLuint shader, const char* source, const std::string& what) {
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_TRUE) return;
    GLint size = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &size);
    std::string log(static_cast<std::size_t>(size), '\0');
    glGetShaderInfoLog(shader, size, nullptr, log.data());
    throw Error(ExitCode::kNoGl, fmt::format("the driver cannot compile the {} shader: {}", what, log));
}

}  // namespace

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
    GLint size = 0;
    glGetProgramiv(program_.id(), GL_INFO_LOG_LENGTH, &size);
    std::string log(static_cast<std::size_t>(size), '\0');
    glGetProgramInfoLog(program_.id(), size, nullptr, log.data());
    throw Error(ExitCode::kNoGl, fmt::format("the driver cannot link the {} program: {}", name, log));
}

void Program::use() const {
    glUseProgram(program_.id());
}

GLint Program::uniform(const char* uniform_name) const {
    const GLint location = glGetUniformLocation(program_.id(), uniform_name);
    if (location < 0) {
        throw Error(ExitCode::kInternal, fmt::format("program {} has no uniform {}", name_, uniform_name));
    }
    return location;
}

}  // namespace corda::gl
