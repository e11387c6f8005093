#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/gl/object.hpp"
#include "corda/gl/program.hpp"
#include "corda/render/tiles.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws draw lists with OpenGL into a picture in memory. Every frame equals that of render_reference() byte
/// for byte.
///
/// Layer by layer, or many at once if no tile has two of them: the capsules and halos of a layer are united
/// in two masks, by GL_MAX of values that are exactly k/255; then a pass over its tiles paints it in
/// integers. So are stamps. A tinted layer has sums of colours beside its masks. Only the damage, what may
/// differ from the last frame, is drawn and read back.
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
    /// What tinted layers take besides; made when the first one is drawn.
    struct Tints {
        Tints();
        gl::Program capsule_program;
        gl::Program paint_program;
        gl::Texture sums;
        gl::Framebuffer mask_target;   ///< masks and sums
        gl::Framebuffer frame_target;  ///< frame, masks and sums
    };

    void make_textures();
    void make_tints();
    void describe_capsules();
    void describe_tiles();
    void set_uniforms();
    void set_capsule_uniforms(const gl::Program& program) const;
    void set_paint_uniforms(const gl::Program& program) const;
    /// Sets the state that drawing depends on: another renderer may have drawn in this context meanwhile.
    void set_state(const PixelRect& band) const;
    [[nodiscard]] PixelRect damage_of(const view::DrawList& list) const;
    void upload(const view::DrawList& list);
    void upload_ground(const Ground& ground, const OnProgress& on_progress);
    void empty_masks() const;
    void draw_capsules(const Batch& batch) const;
    /// Draws and reads some rows.
    void draw_band(const PixelRect& band);
    void draw_masks(const Batch& batch) const;
    void paint(const Batch& batch) const;

    Image image_;
    Tiles tiles_;
    gl::Program capsule_program_;
    gl::Program stamp_program_;
    gl::Program paint_program_;
    gl::VertexArray capsule_array_;
    gl::VertexArray tile_array_;
    gl::Buffer capsule_buffer_;
    gl::Buffer coverage_buffer_;
    gl::Buffer tile_buffer_;
    gl::Texture ground_;
    gl::Texture masks_;
    gl::Texture coverage_;
    gl::Texture frame_;
    gl::Framebuffer mask_target_;
    gl::Framebuffer frame_target_;
    std::unique_ptr<Tints> tints_;
    PixelRect last_bounds_;
    std::vector<view::Stamp> last_stamps_;
    std::vector<std::uint8_t> last_coverage_;
    std::optional<Ground> last_ground_;  ///< that of ground_
    bool everything_is_stale_ = true;
};

}  // namespace corda::render
