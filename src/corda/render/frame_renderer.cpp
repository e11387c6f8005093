#include "corda/render/frame_renderer.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/gl/object.hpp"
#include "corda/render/paint.hpp"
#include "embedded_shaders.hpp"

namespace corda::render {
namespace {

/// True if two stamps look the same. Each refers to the coverage of its own list.
bool same_look(const view::Stamp& a, const std::vector<std::uint8_t>& a_coverage, const view::Stamp& b,
               const std::vector<std::uint8_t>& b_coverage) {
    const bool a_is_solid = a.first_coverage == view::Stamp::kSolid;
    const bool b_is_solid = b.first_coverage == view::Stamp::kSolid;
    if (a.box != b.box || a.color != b.color || a_is_solid != b_is_solid) return false;
    const std::size_t count = pixels_of(a.box);
    return a_is_solid || std::equal(&a_coverage[a.first_coverage], &a_coverage[a.first_coverage] + count,
                                    &b_coverage[b.first_coverage]);
}

/// Side of llvmpipe's tiles.
constexpr int kLlvmpipeTilePx = 64;

/// Number of rows of the damage that are drawn as one band: what llvmpipe draws in a tenth of a second on one
/// core, or in the time of one pass over all capsules, which every band costs. A multiple of the side of
/// llvmpipe's tiles, because a tile on the border of two bands is drawn twice.
int band_rows(const PixelRect& damage, const view::DrawList& list, const Tiles& tiles) {
    // In units of copying and reading one pixel of the ground, at most 12 ns.
    constexpr std::size_t kTile = 2 * std::size_t{Tiles::kSidePx} * Tiles::kSidePx;
    constexpr std::size_t kCapsule = 40;
    constexpr std::size_t kBand = 8'000'000;
    const std::size_t row = static_cast<std::size_t>(damage.width()) +
                            tiles.tiles() * kTile / static_cast<std::size_t>(damage.height());
    const std::size_t rows = std::max(kBand, kCapsule * list.capsules.size()) / row;
    return kLlvmpipeTilePx *
           static_cast<int>(std::clamp<std::size_t>(rows / kLlvmpipeTilePx, 1, kMaxSidePx / kLlvmpipeTilePx));
}

void check_size(int width, int height) {
    GLint largest_texture_px = 0;
    std::array<GLint, 2> largest_viewport_px{};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture_px);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, largest_viewport_px.data());
    const int widest = std::min(largest_texture_px, largest_viewport_px[0]);
    const int highest = std::min(largest_texture_px, largest_viewport_px[1]);
    if (width <= widest && height <= highest) return;
    throw_error(
        ExitCode::kNoGl,
        "a frame of {}x{} pixels is larger than this OpenGL can draw ({}x{}); choose a smaller video.size",
        width, height, widest, highest);
}

/// The variant of a shader for tinted layers.
std::string tinted(std::string source) {
    const std::size_t second_line = source.find('\n') + 1;  // #version must be the first
    return source.insert(second_line, "#define TINTED\n");
}

std::string making_frame(const Image& image) {
    return fmt::format("making a frame of {}x{} pixels", image.width(), image.height());
}

void make_texture(const gl::Texture& texture, GLenum format, const Image& image) {
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, format, image.width(), image.height());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl::check_errors(making_frame(image));  // before an incomplete framebuffer is reported instead
}

/// Attaches textures to a framebuffer, in the order of the shader's outputs.
void make_target(const gl::Framebuffer& target, std::initializer_list<const gl::Texture*> textures,
                 const std::string& what) {
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    std::vector<GLenum> outputs;
    for (const gl::Texture* const texture : textures) {
        outputs.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(outputs.size()));
        glFramebufferTexture2D(GL_FRAMEBUFFER, outputs.back(), GL_TEXTURE_2D, texture->id(), 0);
    }
    glDrawBuffers(static_cast<GLsizei>(outputs.size()), outputs.data());
    gl::check_framebuffer(what);
}

}  // namespace

FrameRenderer::Programs::Programs()
    : capsule("capsule", shaders::kCapsuleVert, shaders::kCapsuleFrag),
      clear("clear", shaders::kClearVert, shaders::kClearFrag) {
    capsule.set("edge_margin", view::kEdgeMargin);
}

FrameRenderer::FrameRenderer(const gl::Context& context, int width, int height)
    : FrameRenderer(context, std::make_shared<Programs>(), width, height) {}

FrameRenderer::FrameRenderer(const FrameRenderer& other, int width, int height)
    : FrameRenderer(*other.context_, other.programs_, width, height) {}

FrameRenderer::FrameRenderer(const gl::Context& context, std::shared_ptr<Programs> programs, int width,
                             int height)
    : context_(&context),
      image_((check_size(width, height), Image(width, height))),
      exposure_(width, height),
      programs_(std::move(programs)),
      last_touched_(tile_count(width, height)) {
    make_texture(masks_, GL_RG8, image_);
    make_target(mask_target_, {&masks_}, making_frame(image_));
    set_capsule_layout();
    set_run_layout();
    gl::check_errors("preparing the renderer");
}

void FrameRenderer::make_tints() {
    const auto lock = context_->exclusive();
    if (!programs_->tinted_capsule) {
        programs_->tinted_capsule.emplace("tinted capsule", tinted(shaders::kCapsuleVert).c_str(),
                                          tinted(shaders::kCapsuleFrag).c_str());
        programs_->tinted_capsule->set("edge_margin", view::kEdgeMargin);
    }
    auto tints = std::make_unique<Tints>();
    make_texture(tints->sums, GL_RGBA32F, image_);
    make_target(tints->target, {&masks_, &tints->sums}, making_frame(image_));
    tints_ = std::move(tints);
}

void FrameRenderer::set_capsule_layout() {
    static_assert(std::is_standard_layout_v<view::Capsule> && sizeof(view::Capsule) == 9 * sizeof(float));
    glBindVertexArray(capsule_array_.id());
    // The first bind of a name creates the buffer.
    glBindBuffer(GL_ARRAY_BUFFER, capsule_buffer_.id());
    glBindVertexBuffer(0, capsule_buffer_.id(), 0, sizeof(view::Capsule));
    glVertexBindingDivisor(0, 1);
    for (const GLuint attribute : {0U, 1U, 2U}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribBinding(attribute, 0);
    }
    glVertexAttribFormat(0, 4, GL_FLOAT, GL_FALSE, offsetof(view::Capsule, ax));
    glVertexAttribFormat(1, 4, GL_FLOAT, GL_FALSE, offsetof(view::Capsule, length));
    glVertexAttribIFormat(2, 4, GL_UNSIGNED_BYTE, offsetof(view::Capsule, tint));
}

void FrameRenderer::set_run_layout() {
    static_assert(std::is_standard_layout_v<TileRun> && sizeof(PixelRect) == 4 * sizeof(GLint));
    glBindVertexArray(run_array_.id());
    glBindBuffer(GL_ARRAY_BUFFER, run_buffer_.id());
    glBindVertexBuffer(0, run_buffer_.id(), 0, sizeof(TileRun));
    glVertexBindingDivisor(0, 1);
    glEnableVertexAttribArray(0);
    glVertexAttribBinding(0, 0);
    glVertexAttribIFormat(0, 4, GL_INT, offsetof(TileRun, rect));
}

Damage FrameRenderer::stale_parts(const view::DrawList& list) const {
    if (everything_is_stale_) return {image_.rect()};
    std::vector<std::uint8_t> tiles = last_touched_;
    for (std::size_t i = 0; i < std::max(list.stamps.size(), last_stamps_.size()); ++i) {
        const bool is_old = i < last_stamps_.size();
        const bool is_new = i < list.stamps.size();
        if (is_old && is_new && same_look(last_stamps_[i], last_coverage_, list.stamps[i], list.coverage))
            continue;
        if (is_old) mark_tiles(last_stamps_[i].box, image_.width(), tiles);
        if (is_new) mark_tiles(list.stamps[i].box, image_.width(), tiles);
    }
    return rects_of(tiles, image_.width(), image_.height());
}

Damage FrameRenderer::render(const view::DrawList& list) {
    exposure_.clear();
    begin(list);
    tiles_.plan(list);
    touch(tiles_.touched());
    Damage damage = stale_parts(list);
    draw(list, damage);
    finish(list, tiles_.touched(), damage);
    return damage;
}

void FrameRenderer::expose(const view::DrawList& list) {
    try {
        begin(list);
        tiles_.plan(list);
        touch(tiles_.touched());
        draw(list, rects_of(tiles_.touched(), list.width, list.height));
    } catch (...) {
        exposure_.clear();
        throw;
    }
    exposure_.add(image_, tiles_.touched(), list.ground);
}

Damage FrameRenderer::develop(const view::DrawList& list) {
    Damage damage = stale_parts(list);
    for (const PixelRect& part : damage) ground_->write(part, image_);
    exposure_.develop(list.ground, image_);
    finish(list, exposure_.touched(), damage);
    return damage;
}

void FrameRenderer::finish(const view::DrawList& list, const std::vector<std::uint8_t>& touched,
                           const Damage& damage) {
    for (const PixelRect& part : damage) {
        paint_stamps(list, part, image_);
        if (!list.ground.is_opaque()) straighten(part, image_);
    }
    last_touched_ = touched;
    last_stamps_ = list.stamps;
    last_coverage_ = list.coverage;
    everything_is_stale_ = false;
}

void FrameRenderer::touch(const std::vector<std::uint8_t>& tiles) {
    for (std::size_t i = 0; i < tiles.size(); ++i) last_touched_[i] |= tiles[i];
}

void FrameRenderer::upload(const view::DrawList& list) {
    const auto lock = context_->exclusive();
    const auto fill = [](const gl::Buffer& buffer, const auto& values) {
        glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])),
                     values.data(), GL_STREAM_DRAW);
    };
    fill(capsule_buffer_, list.capsules);
    fill(run_buffer_, tiles_.runs());
}

void FrameRenderer::begin(const view::DrawList& list) {
    if (list.has_tints() && !tints_) make_tints();
    if (ground_ && ground_->ground() == list.ground) return;
    ground_.emplace(list.ground, image_.height());
    everything_is_stale_ = true;
}

void FrameRenderer::draw(const view::DrawList& list, const Damage& parts) {
    PixelRect all;
    for (const PixelRect& part : parts) all = all.united(part);
    if (all.empty()) return;
    const bool was_stale = std::exchange(everything_is_stale_, true);  // in case drawing fails
    upload(list);
    const int rows = band_rows(all, list, tiles_);
    for (PixelRect band = all; band.y0 < all.y1; band.y0 = band.y1) {
        if (band.y0 > all.y0) check_cancelled();
        band.y1 = std::min((band.y0 + rows) / kLlvmpipeTilePx * kLlvmpipeTilePx, all.y1);
        draw_band(band, parts);
    }
    everything_is_stale_ = was_stale;
}

void FrameRenderer::draw_band(const PixelRect& band, const Damage& parts) {
    const std::vector<Read> reads = plan_reads(tiles_, band);
    const std::vector<std::span<const Read>> slices = slices_of(reads);
    if (!slices.empty()) read_masks(slices.front(), band, ring_.front());
    for (const PixelRect& part : parts) ground_->write(part.intersected(band), image_);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        if (i > 0) check_cancelled();  // ten thousand ropes may be as many layers
        // OpenGL draws the next slice while the CPU paints this one.
        if (i + 1 < slices.size()) read_masks(slices[i + 1], band, ring_[(i + 1) % ring_.size()]);
        paint(slices[i], band, ring_[i % ring_.size()]);
    }
}

void FrameRenderer::set_state(const PixelRect& band) const {
    glDisable(GL_DITHER);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_SCISSOR_TEST);
    glScissor(band.x0, band.y0, band.width(), band.height());
    glViewport(0, 0, image_.width(), image_.height());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    glBlendEquation(GL_MAX);
    const auto set_size = [this](const gl::Program& program) {
        program.set("frame_size", static_cast<float>(image_.width()), static_cast<float>(image_.height()));
    };
    set_size(programs_->clear);
    set_size(programs_->capsule);
    if (programs_->tinted_capsule) set_size(*programs_->tinted_capsule);
}

void FrameRenderer::draw_masks(const Batch& batch) const {
    glDisable(GL_BLEND);
    programs_->clear.use();
    glBindVertexArray(run_array_.id());
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(batch.run_count),
                                      static_cast<GLuint>(batch.first_run));
    glEnable(GL_BLEND);
    if (batch.is_tinted) {
        glBlendEquationi(1, GL_FUNC_ADD);
        glBlendFunci(1, GL_ONE, GL_ONE);
    }
    (batch.is_tinted ? *programs_->tinted_capsule : programs_->capsule).use();
    glBindVertexArray(capsule_array_.id());
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(batch.capsule_count),
                                      static_cast<GLuint>(batch.first_capsule));
    if (batch.is_tinted) glBlendEquation(GL_MAX);
}

void FrameRenderer::read_masks(std::span<const Read> reads, const PixelRect& band, gl::PixelBuffer& buffer) {
    const auto lock = context_->exclusive();
    const std::size_t coverage_at = sums_bytes(reads);
    buffer.begin(coverage_at + 2 * pixels_of(reads));
    set_state(band);
    std::size_t pixels = 0;
    for (const Read& read : reads) {
        const Batch& batch = *read.batch;
        const PixelRect& rect = read.rect;
        const auto read_from = [&rect](GLenum source, GLenum format, GLenum type, std::size_t offset) {
            glReadBuffer(source);
            glReadPixels(rect.x0, rect.y0, rect.width(), rect.height(), format, type,
                         gl::buffer_offset(offset));
        };
        glBindFramebuffer(GL_FRAMEBUFFER, batch.is_tinted ? tints_->target.id() : mask_target_.id());
        if (read.is_first_of_batch) draw_masks(batch);
        if (batch.is_tinted) read_from(GL_COLOR_ATTACHMENT1, GL_RGBA, GL_FLOAT, pixels * sizeof(TintSums));
        read_from(GL_COLOR_ATTACHMENT0, GL_RG, GL_UNSIGNED_BYTE, coverage_at + 2 * pixels);
        pixels += pixels_of(rect);
    }
    buffer.end();
    gl::check_errors("drawing a frame");
}

std::size_t FrameRenderer::sums_bytes(std::span<const Read> reads) const {
    static_assert(std::is_standard_layout_v<TintSums> && sizeof(TintSums) == 4 * sizeof(float));
    return tints_ ? pixels_of(reads) * sizeof(TintSums) : 0;
}

void FrameRenderer::paint(std::span<const Read> reads, const PixelRect& band, gl::PixelBuffer& buffer) {
    const std::byte* const masks = [&] {
        const auto lock = context_->exclusive();
        return buffer.wait();
    }();
    const void* const coverage = masks + sums_bytes(reads);
    const void* const sums = masks;
    std::size_t pixels = 0;
    for (const Read& read : reads) {
        const int row_px = read.rect.width();
        for (std::size_t run = read.first_run; run < read.end_run; ++run) {
            const TileRun& tiles = tiles_.runs()[run];
            const PixelRect rect = tiles.rect.intersected(band);
            if (rect.empty()) continue;
            const std::size_t first =
                pixels + static_cast<std::size_t>(rect.y0 - read.rect.y0) * row_px + rect.x0 - read.rect.x0;
            paint_run(rect, tiles.color,
                      {.coverage = static_cast<const std::uint8_t*>(coverage) + 2 * first,
                       .sums = read.batch->is_tinted ? static_cast<const TintSums*>(sums) + first : nullptr,
                       .row_px = row_px},
                      *ground_, image_);
        }
        pixels += pixels_of(read.rect);
    }
}

}  // namespace corda::render
