#pragma once

#include <string>

namespace corda::gl {

/// Throws corda::Error if glGetError() reports an error: kTemporary for GL_OUT_OF_MEMORY, kNoGl for others.
/// The message names the error and `what` was being done.
void check_errors(const std::string& what);

/// Throws corda::Error (kNoGl) with GL's reason if the bound draw framebuffer is not complete.
void check_framebuffer(const std::string& what);

}  // namespace corda::gl
