#include "corda/render/frame_renderer.hpp"

#include <array>
#include <cassert>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/gl/check.hpp"
#include "embedded_shaders.hpp"

namespace corda::render {
namespace {

constexpr std::size_t kLayersPerSlice = 4;
constexpr std::array<float, 4> kNoCoverage{0, 0, 0, 0};

/// llvmpipe draws in tiles of that side; one that is cut in two takes twice as long.
constexpr int kTilePx = 64;

/// How many rows of the damage are drawn at once, a multiple of kTilePx: as many as llvmpipe draws in a
/// quarter of a second on one core, or in the time in which it passes over all capsules, as every band does.
int band_rows(const PixelRect& damage, const view::DrawList& list) {
    // In units of what a layer of one pixel takes, measured 12 ns.
    constexpr std::size_t kPixel = 4;
    constexpr std::size_t kCapsule = 40;
    constexpr std::size_t kBand = 20'000'000;
    const std::size_t row = static_cast<std::size_t>(damage.width()) * (kPixel + list.layers.size());
    const std::size_t rows = std::max(kBand, kCapsule * list.capsules.size()) / row;
    return kTilePx * static_cast<int>(std::clamp<std::size_t>(rows / kTilePx, 1, kLargestSidePx / kTilePx));
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

}  // namespace

FrameRenderer::FrameRenderer(int width, int height)
    : image_((check_size(width, height), Image(width, height))),
      capsule_program_("capsule", shaders::kCapsuleVert, shaders::kCapsuleFrag),
      composite_program_("composite", shaders::kCompositeVert, shaders::kCompositeFrag) {
    glBindTexture(GL_TEXTURE_2D, color_.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, color_target_.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_.id(), 0);
    gl::check_framebuffer(fmt::format("making a frame of {}x{} pixels", width, height));

    static_assert(std::is_standard_layout_v<view::Capsule> && sizeof(view::Capsule) == 6 * sizeof(float));
    glBindVertexArray(capsule_array_.id());
    glBindBuffer(GL_ARRAY_BUFFER,
                 capsule_buffer_.id());  // binding a name for the first time creates the buffer
    glBindVertexBuffer(0, capsule_buffer_.id(), 0, sizeof(view::Capsule));
    glVertexBindingDivisor(0, 1);
    for (const GLuint attribute : {0U, 1U}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribBinding(attribute, 0);
    }
    glVertexAttribFormat(0, 4, GL_FLOAT, GL_FALSE, offsetof(view::Capsule, ax));
    glVertexAttribFormat(1, 2, GL_FLOAT, GL_FALSE, offsetof(view::Capsule, length));

    capsule_program_.use();
    glUniform2f(capsule_program_.uniform("frame_size"), static_cast<float>(width),
                static_cast<float>(height));
    glUniform1f(capsule_program_.uniform("edge_margin"), view::kEdgeMargin);
    channel_uniform_ = capsule_program_.uniform("channel");
    composite_program_.use();
    glUniform1i(composite_program_.uniform("masks"), 0);
    background_uniform_ = composite_program_.uniform("background");
    layer_count_uniform_ = composite_program_.uniform("layer_count");
    layer_color_uniform_ = composite_program_.uniform("layer_color");
    gl::check_errors("preparing the renderer");
}

PixelRect FrameRenderer::render(const view::DrawList& list, const OnProgress& on_progress) {
    assert(list.width == image_.width() && list.height == image_.height());
    assert(list.layers.size() <= view::kMaxLayers);
    if (!(list.background == last_background_)) everything_is_stale_ = true;
    const PixelRect damage = everything_is_stale_ ? image_.rect() : last_bounds_.united(list.bounds);
    if (damage.empty()) return damage;

    everything_is_stale_ = true;  // if it fails on the way
    reserve_masks(list.layers.size());
    upload_capsules(list);
    const OnProgress nobody;
    const int rows = on_progress ? band_rows(damage, list) : kLargestSidePx;
    clear_masks(damage, list.layers.size(), rows < damage.height() ? on_progress : nobody);
    for (PixelRect band = damage; band.y0 < damage.y1; band.y0 = band.y1) {
        if (band.y0 > damage.y0) report_progress(on_progress, band.y0 - damage.y0, damage.height());
        band.y1 = std::min(band.y0 - band.y0 % kTilePx + rows, damage.y1);
        draw_band(list, band);
    }
    last_bounds_ = list.bounds;
    last_background_ = list.background;
    everything_is_stale_ = false;
    return damage;
}

void FrameRenderer::upload_capsules(const view::DrawList& list) {
    glBindBuffer(GL_ARRAY_BUFFER, capsule_buffer_.id());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.capsules.size() * sizeof(view::Capsule)),
                 list.capsules.data(), GL_STREAM_DRAW);
}

void FrameRenderer::bind_masks(std::size_t slice) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, mask_target_.id());
    glFramebufferTextureLayer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, masks_.id(), 0,
                              static_cast<GLint>(slice));
    gl::check_framebuffer("drawing a layer's mask");
}

void FrameRenderer::clear_masks(const PixelRect& damage, std::size_t layer_count,
                                const OnProgress& on_progress) {
    set_state(damage);
    for (std::size_t l = 0; l < layer_count; l += kLayersPerSlice) {
        bind_masks(l / kLayersPerSlice);
        glClearBufferfv(GL_COLOR, 0, kNoCoverage.data());
        if (!on_progress) continue;
        glFinish();
        report_progress(on_progress, 0, damage.height());
    }
}

void FrameRenderer::draw_band(const view::DrawList& list, const PixelRect& band) {
    set_state(band);
    draw_masks(list);
    composite(list);
    // Waits until the band is drawn.
    glReadPixels(band.x0, band.y0, band.width(), band.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                 image_.pixel(band.x0, band.y0));
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
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glPixelStorei(GL_PACK_ROW_LENGTH, image_.width());
}

void FrameRenderer::reserve_masks(std::size_t layer_count) {
    const std::size_t slices =
        std::max<std::size_t>(1, (layer_count + kLayersPerSlice - 1) / kLayersPerSlice);
    if (slices <= mask_slices_) return;
    mask_slices_ = 0;  // if it fails on the way
    masks_ = gl::Texture();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, masks_.id());
    glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_RGBA8, image_.width(), image_.height(),
                   static_cast<GLsizei>(slices));
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl::check_errors(fmt::format("making masks for {} layers of {}x{} pixels", layer_count, image_.width(),
                                 image_.height()));
    mask_slices_ = slices;
}

void FrameRenderer::draw_masks(const view::DrawList& list) {
    glBindVertexArray(capsule_array_.id());
    capsule_program_.use();
    glBlendEquation(GL_MAX);
    glEnable(GL_BLEND);
    for (std::size_t l = 0; l < list.layers.size(); ++l) {
        const std::size_t channel = l % kLayersPerSlice;
        if (channel == 0) bind_masks(l / kLayersPerSlice);
        const view::Layer& layer = list.layers[l];
        if (layer.capsule_count == 0) continue;
        std::array<float, kLayersPerSlice> select{};
        select[channel] = 1.0F;
        glUniform4fv(channel_uniform_, 1, select.data());
        glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(layer.capsule_count),
                                          static_cast<GLuint>(layer.first_capsule));
    }
    glDisable(GL_BLEND);
}

void FrameRenderer::composite(const view::DrawList& list) {
    std::array<GLint, 4 * view::kMaxLayers> colors{};
    for (std::size_t l = 0; l < list.layers.size(); ++l) {
        const Color& color = list.layers[l].color;
        colors[4 * l] = color.r;
        colors[4 * l + 1] = color.g;
        colors[4 * l + 2] = color.b;
        colors[4 * l + 3] = color.a;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, color_target_.id());
    glBindVertexArray(empty_array_.id());
    composite_program_.use();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, masks_.id());
    glUniform4i(background_uniform_, list.background.r, list.background.g, list.background.b, 255);
    glUniform1i(layer_count_uniform_, static_cast<GLint>(list.layers.size()));
    glUniform4iv(layer_color_uniform_, static_cast<GLsizei>(view::kMaxLayers), colors.data());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace corda::render
