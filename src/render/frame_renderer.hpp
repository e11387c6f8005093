#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/gl/context.hpp"
#include "corda/gl/object.hpp"
#include "corda/gl/pixel_buffer.hpp"
#include "corda/gl/program.hpp"
#include "corda/render/exposure.hpp"
#include "corda/render/ground.hpp"
#include "corda/render/paint.hpp"
#include "corda/render/reads.hpp"
#include "corda/render/tiles.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws draw lists with OpenGL into a picture in memory. Every frame equals that of render_reference() byte
/// for byte.
///
/// Layer by layer, or many at once if no tile has two of them, OpenGL unites the capsules and halos of a
/// layer in two masks, by GL_MAX of values that are exactly k/255, and for a tinted layer sums the colours
/// beside them. Only tiles that the layers touch are emptied, drawn and read back; they are painted in
/// integers (render/paint), as are the mean of the pictures of an exposure and the stamps.
class FrameRenderer {
  public:
    /// The context must be current whenever this draws, and outlive it. Of one that draws on the CPU, only
    /// whoever holds exclusive() makes or destroys a renderer; one that draws takes it for as long as OpenGL
    /// works. Throws corda::Error: kNoGl if the driver cannot draw a frame of that size, kTemporary if memory
    /// is too little.
    FrameRenderer(const gl::Context& context, int width, int height);
    /// In the context of another renderer, with its programs, which no driver then translates again.
    FrameRenderer(const FrameRenderer& other, int width, int height);

    /// Draws the next frame; `list` has this renderer's size. Returns what may differ from the last frame. A
    /// large one is drawn in bands, and `on_progress` is asked between them. Throws corda::Error: kNoGl,
    /// kInterrupted; then the next frame is drawn whole.
    Damage render(const view::DrawList& list, const OnProgress& on_progress = {});

    /// Forgets what was exposed and not developed.
    void begin_exposure() { exposure_.clear(); }
    /// Adds the layers of a list to the frame that develop() will finish; all have the same ground. image()
    /// is no frame until then. Asks and throws as render(); the exposure is lost then, as it is by render().
    void expose(const view::DrawList& list, const OnProgress& on_progress = {});
    /// The next frame is the mean of what was exposed since the last one, at least one list, under the stamps
    /// of `list`, whose own layers are left out. Returns what may differ from the last frame.
    Damage develop(const view::DrawList& list);

    /// The last frame.
    [[nodiscard]] const Image& image() const { return image_; }

  private:
    struct Programs {
        Programs();
        gl::Program capsule;
        gl::Program clear;
        std::optional<gl::Program> tinted_capsule;  ///< made when the first tinted layer is drawn
    };

    /// What tinted layers take besides; made when the first one is drawn.
    struct Tints {
        gl::Texture sums;
        gl::Framebuffer target;  ///< masks and sums
    };

    FrameRenderer(const gl::Context& context, std::shared_ptr<Programs> programs, int width, int height);
    void make_tints();
    void describe_capsules();
    void describe_runs();
    void use(const gl::Program& program) const;
    void use_for_capsules(const gl::Program& program) const;
    /// Sets the state that drawing depends on: another renderer may have drawn in this context meanwhile.
    void set_state(const PixelRect& band) const;
    /// Prepares for drawing on a ground.
    void begin(const view::DrawList& list);
    /// Draws the layers on the ground of some rectangles, which hold all tiles that the layers touch.
    void draw(const view::DrawList& list, const Damage& parts, const OnProgress& on_progress);
    /// Adds tiles to last_touched_.
    void touch(const std::vector<std::uint8_t>& tiles);
    /// What is to be drawn anew under the stamps of `list`, in rectangles that do not overlap.
    [[nodiscard]] Damage stale_parts(const view::DrawList& list) const;
    /// Adds the stamps to what was drawn anew; of that, the tiles `touched` are not the ground alone.
    void finish(const view::DrawList& list, const std::vector<std::uint8_t>& touched, const Damage& damage);
    void upload(const view::DrawList& list);
    /// Draws some rows.
    void draw_band(const PixelRect& band, const Damage& parts);
    void draw_masks(const Batch& batch) const;
    /// Lets OpenGL draw masks and read them into a buffer: first the sums of all reads, if there are tinted
    /// layers, then the coverage of all. The masks of the first read's batch may already have been drawn, by
    /// the call before.
    void read_masks(std::span<const Read> reads, const PixelRect& band, gl::PixelBuffer& buffer);
    [[nodiscard]] std::size_t sums_bytes(std::span<const Read> reads) const;
    [[nodiscard]] const std::byte* wait(gl::PixelBuffer& buffer) const;
    /// Paints the layers of some reads when they are in the buffer.
    void paint(std::span<const Read> reads, const PixelRect& band, gl::PixelBuffer& buffer);

    const gl::Context* context_;
    Image image_;  ///< while a frame is drawn, colours times alpha
    Tiles tiles_;
    Exposure exposure_;
    std::shared_ptr<Programs> programs_;
    gl::VertexArray capsule_array_;
    gl::VertexArray run_array_;
    gl::Buffer capsule_buffer_;
    gl::Buffer run_buffer_;
    gl::Texture masks_;
    gl::Framebuffer mask_target_;
    std::array<gl::PixelBuffer, 2> ring_;  ///< one is painted from while OpenGL reads into the other
    std::unique_ptr<Tints> tints_;
    std::vector<std::uint8_t> last_touched_;  ///< per tile: 1 if it is not the ground and stamps alone
    std::vector<view::Stamp> last_stamps_;
    std::vector<std::uint8_t> last_coverage_;
    std::optional<GroundRows> ground_;
    bool everything_is_stale_ = true;
};

}  // namespace corda::render
