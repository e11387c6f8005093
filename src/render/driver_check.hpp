#pragma once

#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"

namespace corda::render {

/// Tries in a child process to make a context by `def` and to draw in it, if the environment has unusual
/// variables (see gl::has_unusual_variables()): Mesa crashes with some of their values. Once per process,
/// `def` and variables; later calls return or throw at once. Call it before a context is made. Throws
/// corda::Error: kNoGl if the child crashes or hangs, with the variables to unset; what gl::prepare_driver()
/// and run_in_child() throw. Says nothing of a driver that gives no context: Context does.
void try_driver(const gl::ContextDef& def);

/// Draws a small picture with the shader programs of a renderer in the current context and compares it with
/// render_reference(): a driver that draws nothing, or wrongly, is found before it draws a frame. Those of
/// tinted layers, which few films have, are checked by `with_tints`. Each is done once per process and
/// driver; later calls return at once. Throws corda::Error: kNoGl with the driver and the first pixel that
/// differs, kTemporary.
void check_driver(const gl::Context& context, const FrameRenderer& renderer, bool with_tints);

/// Checks all of them with a renderer of its own.
void check_driver(const gl::Context& context);

}  // namespace corda::render
