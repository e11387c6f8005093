#pragma once

#include <cstddef>

#include "corda/core/image.hpp"
#include "corda/gl/object.hpp"
#include "corda/gl/program.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws lists with OpenGL into a picture in memory. Every frame equals render_reference byte for byte.
///
/// Each layer's capsules are united in a mask (GL_MAX of values that are exactly k/255, four layers a
/// texture), then one pass paints all layers in integers. Only what differs from the last frame is cleared,
/// drawn and read back.
class FrameRenderer {
  public:
    /// A gl::Context must be current and outlive this. Throws corda::Error (kNoGl) where the driver cannot
    /// hold a frame of that size.
    FrameRenderer(int width, int height);

    /// Draws the next frame, of this renderer's size, and returns the pixels that may differ from the last
    /// one.
    PixelRect render(const view::DrawList& list);

    /// The last frame.
    [[nodiscard]] const Image& image() const { return image_; }

    /// Makes the next frame a full redraw.
    void invalidate() { everything_is_stale_ = true; }

  private:
    void reserve_masks(std::size_t layer_count);
    void draw_masks(const view::DrawList& list);
    void composite(const view::DrawList& list);

    Image image_;
    gl::Program capsule_program_;
    gl::Program composite_program_;
    gl::VertexArray capsule_array_;
    gl::VertexArray empty_array_;
    gl::Buffer capsule_buffer_;
    gl::Texture masks_;
    gl::Texture color_;
    gl::Framebuffer mask_target_;
    gl::Framebuffer color_target_;
    GLint channel_uniform_ = -1;
    GLint background_uniform_ = -1;
    GLint layer_count_uniform_ = -1;
    GLint layer_color_uniform_ = -1;
    std::size_t mask_slices_ = 0;
    PixelRect last_bounds_;
    Color last_background_;
    bool everything_is_stale_ = true;
};

}  // namespace corda::render
