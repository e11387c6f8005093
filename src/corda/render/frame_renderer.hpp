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
#include "corda/render/exposure.hpp"
#include "corda/render/paint.hpp"
#include "corda/render/tiles.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws draw lists with OpenGL into an image in memory. Every frame equals render_reference() byte for byte.
///
/// For each layer, or for several at once if no tile has two of them, OpenGL unites the capsules and halos in
/// two masks, by GL_MAX of values that are exactly k/255, and sums the colours of a tinted layer. Only tiles
/// that layers touch are cleared, drawn and read back. Painting them, averaging the images of an exposure and
/// painting stamps are integer arithmetic on the CPU (render/paint, render/exposure).
class FrameRenderer {
  public:
    /// The context must be current whenever this draws, and must outlive it. If it draws on the CPU, the
    /// caller holds exclusive() to make or destroy a renderer; drawing takes it as long as OpenGL works.
    /// Throws corda::Error: kNoGl if the driver cannot draw a frame of that size, kTemporary if memory is too
    /// small.
    FrameRenderer(const gl::Context& context, int width, int height);
    /// Shares the context and the compiled programs of another renderer.
    FrameRenderer(const FrameRenderer& other, int width, int height);

    /// Draws the next frame; `list` has this renderer's size. Returns what may differ from the last frame.
    /// Draws a large frame in bands and can be cancelled between them. Throws corda::Error: kNoGl,
    /// kInterrupted; the next frame is then drawn whole.
    Damage render(const view::DrawList& list);

    /// Discards lists that were exposed but not developed.
    void begin_exposure() { exposure_.clear(); }
    /// Adds the layers of a list to the frame that develop() will finish; all lists have the same ground.
    /// image() is no frame until then. Throws as render(); then the exposure is discarded.
    void expose(const view::DrawList& list);
    /// Makes the next frame: the mean of the lists exposed since the last one, at least one, below the stamps
    /// of `list`, whose own layers are ignored. Returns what may differ from the last frame.
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

    /// Target of tinted layers; made when the first one is drawn.
    struct Tints {
        gl::Texture sums;
        gl::Framebuffer target;  ///< masks and sums
    };

    FrameRenderer(const gl::Context& context, std::shared_ptr<Programs> programs, int width, int height);
    void make_tints();
    void set_capsule_layout();
    void set_run_layout();
    /// Sets the state that drawing depends on: another renderer may have drawn in this context since.
    void set_state(const PixelRect& band) const;
    /// Prepares for drawing on a ground.
    void begin(const view::DrawList& list);
    /// Draws the layers on the ground of `parts`, which contain all tiles that the layers touch.
    void draw(const view::DrawList& list, const Damage& parts);
    /// Adds tiles to last_touched_.
    void touch(const std::vector<std::uint8_t>& tiles);
    /// Rectangles, without overlap, that have to be redrawn below the stamps of `list`.
    [[nodiscard]] Damage stale_parts(const view::DrawList& list) const;
    /// Paints the stamps on the redrawn parts. Outside of the tiles `touched` the frame is ground and stamps.
    void finish(const view::DrawList& list, const std::vector<std::uint8_t>& touched, const Damage& damage);
    void upload(const view::DrawList& list);
    /// Draws the rows of `band`.
    void draw_band(const PixelRect& band, const Damage& parts);
    void draw_masks(const Batch& batch) const;
    /// Draws masks and reads them into a buffer: first the sums of all reads, if there are tinted layers,
    /// then the coverage. The previous call may have drawn the masks of the first read's batch.
    void read_masks(std::span<const Read> reads, const PixelRect& band, gl::PixelBuffer& buffer);
    [[nodiscard]] std::size_t sums_bytes(std::span<const Read> reads) const;
    /// Waits for the buffer and paints the layers of its reads.
    void paint(std::span<const Read> reads, const PixelRect& band, gl::PixelBuffer& buffer);

    const gl::Context* context_;
    Image image_;  ///< premultiplied while a frame is drawn
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
    std::vector<std::uint8_t> last_touched_;  ///< per tile: 1 unless it is ground and stamps alone
    std::vector<view::Stamp> last_stamps_;
    std::vector<std::uint8_t> last_coverage_;
    std::optional<GroundRows> ground_;
    bool everything_is_stale_ = true;
};

/// Draws a draw list in plain C++, slowly and simply.
[[nodiscard]] Image render_reference(const view::DrawList& list);

/// Averages the layers of several lists in linear light below the stamps of `list`, whose own layers are
/// ignored.
[[nodiscard]] Image render_reference(std::span<const view::DrawList> exposed, const view::DrawList& list);

/// Sets the pixels to `id` of which a capsule of the list covers at least half. `mask`: one per pixel of the
/// list, row 0 on top.
void mark_covered(const view::DrawList& list, std::uint8_t id, std::span<std::uint8_t> mask);

/// Draws a small picture with the programs of a renderer in the current context and compares it with
/// render_reference(), to detect a driver that draws nothing or wrongly before it draws a frame.
/// `with_tints`: checks the programs of tinted layers, which few films need. Runs once per process and
/// driver. Throws corda::Error: kNoGl with the driver and the first pixel that differs, kTemporary.
void check_driver(const gl::Context& context, const FrameRenderer& renderer, bool with_tints);

/// Checks all programs, with a renderer of its own.
void check_driver(const gl::Context& context);

}  // namespace corda::render
