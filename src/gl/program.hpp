#pragma once

#include <string>

#include "corda/gl/object.hpp"

namespace corda::gl {

/// A linked pair of a vertex and a fragment shader.
class Program {
  public:
    /// `name` stands in error messages. Throws corda::Error (kNoGl) with the driver's log where a shader does
    /// not compile or the pair does not link.
    Program(const std::string& name, const char* vertex_source, const char* fragment_source);

    void use() const;

    /// Location of an active uniform. Throws corda::Error (kInternal) where there is none of that name.
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
