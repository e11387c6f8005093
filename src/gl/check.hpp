#pragma once

#include <string>

namespace corda::gl {

/// Throws corda::Error (kNoGl) where GL holds an error, naming it and `what` was being done.
void check_errors(const std::string& what);

/// Throws corda::Error (kNoGl) where the bound draw framebuffer cannot be drawn to, with GL's reason.
void check_framebuffer(const std::string& what);

}  // namespace corda::gl
