#pragma once

#include <cstddef>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/gl/object.hpp"
#include "corda/gl/program.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws draw lists with OpenGL into a picture in memory. Every frame equals that of render_reference() byte
/// for byte.
///
/// The capsules of a layer are united in a mask, by GL_MAX of values that are exactly k/255; a texture slice
/// holds four masks. Then one pass paints all layers in integers. Only the damage, what may differ from the
/// last frame, is cleared, drawn and read back.
class FrameRenderer {
  public:
    /// A gl::Context must be current and outlive this. Throws corda::Error (kNoGl) if the driver cannot draw
    /// a frame of that size.
    FrameRenderer(int width, int height);

    /// Draws the next frame; `list` has this renderer's size. Returns the damage: the pixels that may differ
    /// from the last frame. A large one is drawn in bands, and `on_progress` is asked between them. Throws
    /// corda::Error: kNoGl, kInterrupted; then the next frame is drawn whole.
    PixelRect render(const view::DrawList& list, const OnProgress& on_progress = {});

    /// The last frame.
    [[nodiscard]] const Image& image() const { return image_; }

  private:
    /// Sets the state that drawing depends on: another renderer may have drawn in this context meanwhile.
    void set_state(const PixelRect& band) const;
    void reserve_masks(std::size_t layer_count);
    void upload_capsules(const view::DrawList& list);
    void bind_masks(std::size_t slice);
    /// All of the damage at once: a part of a frame takes a driver much longer per pixel to clear.
    void clear_masks(const PixelRect& damage, std::size_t layer_count, const OnProgress& on_progress);
    /// Draws and reads some rows.
    void draw_band(const view::DrawList& list, const PixelRect& band);
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
