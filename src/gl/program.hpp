#pragma once

#include <string>

#include "corda/gl/object.hpp"

namespace corda::gl {

/// A linked GL program of one vertex and one fragment shader.
class Program {
  public:
    /// `name` is used in error messages. Throws corda::Error (kNoGl) with the driver's log if a shader does
    /// not compile or the program does not link.
    Program(const std::string& name, const char* vertex_source, const char* fragment_source);

    void use() const;

    /// The location of an active uniform. Throws corda::Error (kInternal) if there is none of that name.
    [[nodiscard]] GLint uniform(const char* uniform_name) const;

  private:
    struct Kind {
        static GLuint create() { return glCreateProgram(); }
        static void destroy(GLuint id) { glDeleteProgram(id); }
    };

    std::string name_;
    Object<Kind> program_;
};

}  // namespace corda::gl
