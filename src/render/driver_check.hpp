#pragma once

#include "corda/gl/context.hpp"

namespace corda::render {

/// Draws a small picture with every shader program of the current context and compares it with
/// render_reference(): a driver that draws nothing, or wrongly, is found before it draws a frame. Done once
/// per process and driver; later calls return at once. Throws corda::Error: kNoGl with the driver and the
/// first pixel that differs, kTemporary.
void check_driver(const gl::Context& context);

}  // namespace corda::render
