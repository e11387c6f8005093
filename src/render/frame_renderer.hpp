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
#include "corda/render/exposure.hpp"
#include "corda/render/tiles.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws draw lists with OpenGL into a picture in memory. Every frame equals that of render_reference() byte
/// for byte.
///
/// Layer by layer, or many at once if no tile has two of them: the capsules and halos of a layer are united
/// in two masks, by GL_MAX of values that are exactly k/255; then a pass over its tiles paints it in
/// integers. A tinted layer has sums of colours beside its masks. Only tiles that may differ from the last
/// frame are drawn and read back. What is then done without OpenGL, in integers, too: the mean of the
/// pictures of an exposure; and stamps, which change alone.
class FrameRenderer {
  public:
    /// A gl::Context must be current and outlive this. Throws corda::Error (kNoGl) if the driver cannot draw
    /// a frame of that size.
    FrameRenderer(int width, int height);

    /// Draws the next frame; `list` has this renderer's size. Returns what may differ from the last frame. A
    /// large one is drawn in bands, and `on_progress` is asked between them. Throws corda::Error: kNoGl,
    /// kInterrupted; then the next frame is drawn whole.
    Damage render(const view::DrawList& list, const OnProgress& on_progress = {});

    /// Forgets what was exposed and not developed.
    void begin_exposure() { exposure_.clear(); }
    /// Adds the layers of a list to the frame that develop() will finish; all have the same ground. Asks and
    /// throws as render(); the exposure is lost then, as it is by render().
    void expose(const view::DrawList& list, const OnProgress& on_progress = {});
    /// The next frame is the mean of what was exposed since the last one, at least one list, under the stamps
    /// of `list`, whose own layers are left out. Returns what may differ from the last frame.
    Damage develop(const view::DrawList& list);

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
    /// Prepares for drawing on a ground.
    void begin(const view::DrawList& list, const OnProgress& on_progress);
    /// Draws the layers in some rectangles, a multiple of tiles, to bare_.
    void draw(const view::DrawList& list, const Damage& parts, const OnProgress& on_progress);
    /// Adds tiles to last_touched_.
    void touch(const std::vector<std::uint8_t>& tiles);
    /// Where bare_ may differ from what the last frame was made of.
    [[nodiscard]] Damage stale_parts() const;
    /// Adds the boxes of stamps that differ from the last frame's.
    void add_changed_stamps(const view::DrawList& list, Damage& damage) const;
    /// Makes the frame of bare_, whose tiles `touched` are not the ground alone, and the stamps. `damage` is
    /// that of bare_; returns it with that of the stamps.
    Damage finish(const view::DrawList& list, const std::vector<std::uint8_t>& touched, Damage damage);
    void upload(const view::DrawList& list);
    void upload_ground(const Ground& ground, const OnProgress& on_progress);
    void draw_capsules(const Batch& batch) const;
    /// Draws and reads some rows.
    void draw_band(const PixelRect& band, const Damage& parts);
    void draw_masks(const Batch& batch) const;
    void paint(const Batch& batch) const;

    Image image_;
    Image bare_;  ///< without stamps, colours times alpha
    Tiles tiles_;
    Exposure exposure_;
    gl::Program capsule_program_;
    gl::Program paint_program_;
    gl::VertexArray capsule_array_;
    gl::VertexArray tile_array_;
    gl::Buffer capsule_buffer_;
    gl::Buffer tile_buffer_;
    gl::Texture ground_;
    gl::Texture masks_;
    gl::Texture frame_;
    gl::Framebuffer mask_target_;
    gl::Framebuffer frame_target_;
    std::unique_ptr<Tints> tints_;
    std::vector<std::uint8_t> last_touched_;  ///< per tile: 1 if it has not been the ground alone
    std::vector<view::Stamp> last_stamps_;
    std::vector<std::uint8_t> last_coverage_;
    std::optional<Ground> last_ground_;  ///< that of ground_
    bool masks_are_empty_ = false;
    bool everything_is_stale_ = true;
};

}  // namespace corda::render
