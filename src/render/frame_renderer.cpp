#include "corda/render/frame_renderer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/gl/check.hpp"
#include "corda/render/ground.hpp"
#include "corda/render/stamps.hpp"
#include "embedded_shaders.hpp"

namespace corda::render {
namespace {

constexpr std::array<float, 4> kNothing{0, 0, 0, 0};

/// Rows of the ground between two questions; a multiple of the tiles' side.
constexpr int kAskingRows = 1024;

constexpr GLuint kFrameUnit = 0;
constexpr GLuint kGroundUnit = 1;
constexpr GLuint kMaskUnit = 2;
constexpr GLuint kSumsUnit = 3;

/// Whether two stamps look the same, each with the coverage of its own list.
bool same_look(const view::Stamp& a, const std::vector<std::uint8_t>& a_coverage, const view::Stamp& b,
               const std::vector<std::uint8_t>& b_coverage) {
    const bool a_is_solid = a.first_coverage == view::Stamp::kSolid;
    const bool b_is_solid = b.first_coverage == view::Stamp::kSolid;
    if (a.box != b.box || a.color != b.color || a_is_solid != b_is_solid) return false;
    const std::size_t count = static_cast<std::size_t>(a.box.width()) * a.box.height();
    return a_is_solid || std::equal(&a_coverage[a.first_coverage], &a_coverage[a.first_coverage] + count,
                                    &b_coverage[b.first_coverage]);
}

/// Side of the tiles in which llvmpipe draws.
constexpr int kLlvmpipeTilePx = 64;

/// How many rows of the damage are drawn at once, a multiple of the side of llvmpipe's tiles, as one that is
/// cut in two takes twice as long: as many as llvmpipe draws in a tenth of a second on one core, or in the
/// time in which it passes over all capsules, as every band does.
int band_rows(const PixelRect& damage, const view::DrawList& list, const Tiles& tiles) {
    // In units of what a pixel of the ground takes to copy and to read, at most 12 ns.
    constexpr std::size_t kTile = 2 * std::size_t{Tiles::kSidePx} * Tiles::kSidePx;
    constexpr std::size_t kCapsule = 40;
    constexpr std::size_t kBand = 8'000'000;
    const std::size_t row = static_cast<std::size_t>(damage.width()) +
                            tiles.tiles().size() * kTile / static_cast<std::size_t>(damage.height());
    const std::size_t rows = std::max(kBand, kCapsule * list.capsules.size()) / row;
    return kLlvmpipeTilePx * static_cast<int>(std::clamp<std::size_t>(rows / kLlvmpipeTilePx, 1,
                                                                      kLargestSidePx / kLlvmpipeTilePx));
}

void check_size(int width, int height) {
    GLint largest_texture_px = 0;
    std::array<GLint, 2> largest_viewport_px{};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture_px);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, largest_viewport_px.data());
    const int widest = std::min(largest_texture_px, largest_viewport_px[0]);
    const int highest = std::min(largest_texture_px, largest_viewport_px[1]);
    if (width <= widest && height <= highest) return;
    throw Error(ExitCode::kNoGl,
                fmt::format("a frame of {}x{} pixels is larger than this OpenGL can draw ({}x{}); choose a "
                            "smaller video.size",
                            width, height, widest, highest));
}

/// The same shader for tinted layers.
std::string tinted(std::string source) {
    const std::size_t second_line = source.find('\n') + 1;  // #version stays the first
    return source.insert(second_line, "#define TINTED\n");
}

gl::Program tinted_program(const std::string& name, const char* vertex, const char* fragment) {
    return {name, tinted(vertex).c_str(), tinted(fragment).c_str()};
}

void make_texture(const gl::Texture& texture, GLenum format, const Image& image) {
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, format, image.width(), image.height());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

/// A framebuffer of these textures, in the order of the shader's outputs.
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

std::string making_frame(const Image& image) {
    return fmt::format("making a frame of {}x{} pixels", image.width(), image.height());
}

}  // namespace

FrameRenderer::Tints::Tints()
    : capsule_program(tinted_program("tinted capsule", shaders::kCapsuleVert, shaders::kCapsuleFrag)),
      paint_program(tinted_program("tinted paint", shaders::kPaintVert, shaders::kPaintFrag)) {}

FrameRenderer::FrameRenderer(int width, int height)
    : image_((check_size(width, height), Image(width, height))),
      bare_(width, height),
      exposure_(width, height),
      capsule_program_("capsule", shaders::kCapsuleVert, shaders::kCapsuleFrag),
      paint_program_("paint", shaders::kPaintVert, shaders::kPaintFrag),
      last_touched_(tile_count(width, height)) {
    make_textures();
    describe_capsules();
    describe_tiles();
    set_uniforms();
    gl::check_errors("preparing the renderer");
}

void FrameRenderer::make_textures() {
    make_texture(frame_, GL_RGBA8, image_);
    make_texture(ground_, GL_RGBA8, image_);
    make_texture(masks_, GL_RG8, image_);
    make_target(mask_target_, {&masks_}, making_frame(image_));
    make_target(frame_target_, {&frame_, &masks_}, making_frame(image_));
}

void FrameRenderer::make_tints() {
    auto tints = std::make_unique<Tints>();
    make_texture(tints->sums, GL_RGBA32F, image_);
    make_target(tints->mask_target, {&masks_, &tints->sums}, making_frame(image_));
    make_target(tints->frame_target, {&frame_, &masks_, &tints->sums}, making_frame(image_));
    set_capsule_uniforms(tints->capsule_program);
    set_paint_uniforms(tints->paint_program);
    glUniform1i(tints->paint_program.uniform("sums"), kSumsUnit);
    tints_ = std::move(tints);
    masks_are_empty_ = false;
    everything_is_stale_ = true;
}

void FrameRenderer::describe_capsules() {
    static_assert(std::is_standard_layout_v<view::Capsule> && sizeof(view::Capsule) == 8 * sizeof(float));
    glBindVertexArray(capsule_array_.id());
    // Binding a name for the first time creates the buffer.
    glBindBuffer(GL_ARRAY_BUFFER, capsule_buffer_.id());
    glBindVertexBuffer(0, capsule_buffer_.id(), 0, sizeof(view::Capsule));
    glVertexBindingDivisor(0, 1);
    for (const GLuint attribute : {0U, 1U, 2U}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribBinding(attribute, 0);
    }
    glVertexAttribFormat(0, 4, GL_FLOAT, GL_FALSE, offsetof(view::Capsule, ax));
    glVertexAttribFormat(1, 3, GL_FLOAT, GL_FALSE, offsetof(view::Capsule, length));
    glVertexAttribIFormat(2, 4, GL_UNSIGNED_BYTE, offsetof(view::Capsule, tint));
}

void FrameRenderer::describe_tiles() {
    static_assert(std::is_standard_layout_v<Tile> && sizeof(Tile) == 5 * sizeof(float));
    glBindVertexArray(tile_array_.id());
    glBindBuffer(GL_ARRAY_BUFFER, tile_buffer_.id());
    glBindVertexBuffer(0, tile_buffer_.id(), 0, sizeof(Tile));
    glVertexBindingDivisor(0, 1);
    for (const GLuint attribute : {0U, 1U, 2U}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribBinding(attribute, 0);
    }
    glVertexAttribFormat(0, 4, GL_FLOAT, GL_FALSE, offsetof(Tile, x0));
    glVertexAttribIFormat(1, 4, GL_UNSIGNED_BYTE, offsetof(Tile, color));
}

void FrameRenderer::set_uniforms() {
    set_capsule_uniforms(capsule_program_);
    set_paint_uniforms(paint_program_);
}

void FrameRenderer::set_capsule_uniforms(const gl::Program& program) const {
    program.use();
    glUniform2f(program.uniform("frame_size"), static_cast<float>(image_.width()),
                static_cast<float>(image_.height()));
    glUniform1f(program.uniform("edge_margin"), view::kEdgeMargin);
}

void FrameRenderer::set_paint_uniforms(const gl::Program& program) const {
    program.use();
    glUniform2f(program.uniform("frame_size"), static_cast<float>(image_.width()),
                static_cast<float>(image_.height()));
    glUniform1i(program.uniform("frame"), kFrameUnit);
    glUniform1i(program.uniform("ground"), kGroundUnit);
    glUniform1i(program.uniform("masks"), kMaskUnit);
}

Damage FrameRenderer::stale_parts() const {
    return everything_is_stale_ ? Damage{image_.rect()}
                                : rects_of(last_touched_, image_.width(), image_.height());
}

void FrameRenderer::add_changed_stamps(const view::DrawList& list, Damage& damage) const {
    if (everything_is_stale_) return;
    for (std::size_t i = 0; i < std::max(list.stamps.size(), last_stamps_.size()); ++i) {
        const bool is_old = i < last_stamps_.size();
        const bool is_new = i < list.stamps.size();
        if (is_old && is_new && same_look(last_stamps_[i], last_coverage_, list.stamps[i], list.coverage))
            continue;
        if (is_old) damage.push_back(last_stamps_[i].box);
        if (is_new && !(is_old && last_stamps_[i].box == list.stamps[i].box))
            damage.push_back(list.stamps[i].box);
    }
}

Damage FrameRenderer::render(const view::DrawList& list, const OnProgress& on_progress) {
    exposure_.clear();
    begin(list, on_progress);
    tiles_.plan(list);
    touch(tiles_.touched());
    Damage damage = stale_parts();
    draw(list, damage, on_progress);
    return finish(list, tiles_.touched(), std::move(damage));
}

void FrameRenderer::expose(const view::DrawList& list, const OnProgress& on_progress) {
    try {
        begin(list, on_progress);
        tiles_.plan(list);
        touch(tiles_.touched());
        draw(list, rects_of(tiles_.touched(), list.width, list.height), on_progress);
    } catch (...) {
        exposure_.clear();
        throw;
    }
    exposure_.add(bare_, tiles_.touched(), list.ground);
}

Damage FrameRenderer::develop(const view::DrawList& list) {
    Damage damage = stale_parts();
    for (const PixelRect& part : damage) write_ground(list.ground, part, bare_);
    exposure_.develop(list.ground, bare_);
    return finish(list, exposure_.touched(), std::move(damage));
}

Damage FrameRenderer::finish(const view::DrawList& list, const std::vector<std::uint8_t>& touched,
                             Damage damage) {
    add_changed_stamps(list, damage);
    for (const PixelRect& part : damage) {
        for (int y = part.y0; y < part.y1; ++y)
            std::copy_n(bare_.pixel(part.x0, y), 4 * part.width(), image_.pixel(part.x0, y));
        paint_stamps(list, part, image_);
        if (!list.ground.is_opaque()) straighten(part, image_);
    }
    last_touched_ = touched;
    last_stamps_ = list.stamps;
    last_coverage_ = list.coverage;
    everything_is_stale_ = false;
    return damage;
}

void FrameRenderer::touch(const std::vector<std::uint8_t>& tiles) {
    for (std::size_t i = 0; i < tiles.size(); ++i) last_touched_[i] |= tiles[i];
}

void FrameRenderer::upload(const view::DrawList& list) {
    const auto fill = [](const gl::Buffer& buffer, const auto& values) {
        glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])),
                     values.data(), GL_STREAM_DRAW);
    };
    fill(capsule_buffer_, list.capsules);
    fill(tile_buffer_, tiles_.tiles());
}

void FrameRenderer::upload_ground(const Ground& ground, const OnProgress& on_progress) {
    if (last_ground_ == ground) return;
    last_ground_.reset();
    const int width = image_.width();
    const int height = image_.height();
    std::vector<std::uint8_t> rows(image_.row_bytes() * Tiles::kSidePx);
    for (int y = 0; y < height; y += Tiles::kSidePx) {
        const int count = std::min(Tiles::kSidePx, height - y);
        for (int row = 0; row < count; ++row)
            write_ground_row(ground, y + row, width, height, &rows[image_.row_bytes() * row]);
        set_state(image_.rect());
        glActiveTexture(GL_TEXTURE0);
        glBindTexture(GL_TEXTURE_2D, ground_.id());
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, y, width, count, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
        if (y > 0 && y % kAskingRows == 0) report_progress(on_progress, 0, height);
    }
    gl::check_errors("drawing the ground");
    last_ground_ = ground;
}

void FrameRenderer::begin(const view::DrawList& list, const OnProgress& on_progress) {
    const bool has_tints = std::any_of(list.layers.begin(), list.layers.end(),
                                       [](const view::Layer& layer) { return layer.is_tinted; });
    if (has_tints && !tints_) make_tints();
    if (last_ground_ != list.ground) everything_is_stale_ = true;
    upload_ground(list.ground, on_progress);
    if (masks_are_empty_) return;
    set_state(image_.rect());
    glBindFramebuffer(GL_FRAMEBUFFER, mask_target_.id());
    glClearBufferfv(GL_COLOR, 0, kNothing.data());
    if (!tints_) return;
    glBindFramebuffer(GL_FRAMEBUFFER, tints_->mask_target.id());
    glClearBufferfv(GL_COLOR, 1, kNothing.data());
}

void FrameRenderer::draw(const view::DrawList& list, const Damage& parts, const OnProgress& on_progress) {
    PixelRect all;
    for (const PixelRect& part : parts) all = all.united(part);
    if (all.empty()) return;
    const bool was_stale = std::exchange(everything_is_stale_, true);  // if it fails on the way
    masks_are_empty_ = false;
    upload(list);
    const int rows = on_progress ? band_rows(all, list, tiles_) : kLargestSidePx;
    for (PixelRect band = all; band.y0 < all.y1; band.y0 = band.y1) {
        if (band.y0 > all.y0) report_progress(on_progress, band.y0 - all.y0, all.height());
        band.y1 = std::min((band.y0 + rows) / kLlvmpipeTilePx * kLlvmpipeTilePx, all.y1);
        draw_band(band, parts);
    }
    masks_are_empty_ = true;
    everything_is_stale_ = was_stale;
}

void FrameRenderer::draw_band(const PixelRect& band, const Damage& parts) {
    const auto for_each_part = [&](const auto& visit) {
        for (const PixelRect& part : parts) {
            const PixelRect rect = part.intersected(band);
            if (!rect.empty()) visit(rect);
        }
    };
    set_state(band);
    for_each_part([&](const PixelRect& rect) {
        glCopyImageSubData(ground_.id(), GL_TEXTURE_2D, 0, rect.x0, rect.y0, 0, frame_.id(), GL_TEXTURE_2D, 0,
                           rect.x0, rect.y0, 0, rect.width(), rect.height(), 1);
    });
    for (const Batch& batch : tiles_.batches()) {
        draw_masks(batch);
        paint(batch);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, frame_target_.id());
    // The first waits until the band is drawn.
    for_each_part([&](const PixelRect& rect) {
        glReadPixels(rect.x0, rect.y0, rect.width(), rect.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                     bare_.pixel(rect.x0, rect.y0));
    });
    gl::check_errors("drawing a frame");
}

void FrameRenderer::set_state(const PixelRect& band) const {
    glDisable(GL_DITHER);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glEnable(GL_SCISSOR_TEST);
    glScissor(band.x0, band.y0, band.width(), band.height());
    glViewport(0, 0, image_.width(), image_.height());
    for (const GLenum alignment : {GL_PACK_ALIGNMENT, GL_UNPACK_ALIGNMENT}) glPixelStorei(alignment, 4);
    for (const GLenum length : {GL_PACK_ROW_LENGTH, GL_UNPACK_ROW_LENGTH})
        glPixelStorei(length, image_.width());
    glBlendEquation(GL_MAX);
    const auto bind = [](GLuint unit, const gl::Texture& texture) {
        glActiveTexture(GL_TEXTURE0 + unit);
        glBindTexture(GL_TEXTURE_2D, texture.id());
        glBindSampler(unit, 0);
    };
    bind(kFrameUnit, frame_);
    bind(kGroundUnit, ground_);
    bind(kMaskUnit, masks_);
    if (tints_) bind(kSumsUnit, tints_->sums);
}

void FrameRenderer::draw_masks(const Batch& batch) const {
    glBindFramebuffer(GL_FRAMEBUFFER, batch.is_tinted ? tints_->mask_target.id() : mask_target_.id());
    glEnable(GL_BLEND);
    draw_capsules(batch);
    glDisable(GL_BLEND);
}

void FrameRenderer::draw_capsules(const Batch& batch) const {
    glBindVertexArray(capsule_array_.id());
    (batch.is_tinted ? tints_->capsule_program : capsule_program_).use();
    if (batch.is_tinted) {
        glBlendEquationi(1, GL_FUNC_ADD);
        glBlendFunci(1, GL_ONE, GL_ONE);
    }
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(batch.capsule_count),
                                      static_cast<GLuint>(batch.first_capsule));
    if (batch.is_tinted) glBlendEquation(GL_MAX);
}

void FrameRenderer::paint(const Batch& batch) const {
    glBindFramebuffer(GL_FRAMEBUFFER, batch.is_tinted ? tints_->frame_target.id() : frame_target_.id());
    glBindVertexArray(tile_array_.id());
    (batch.is_tinted ? tints_->paint_program : paint_program_).use();
    glTextureBarrier();  // it reads what it draws on
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(batch.tile_count),
                                      static_cast<GLuint>(batch.first_tile));
}

}  // namespace corda::render
