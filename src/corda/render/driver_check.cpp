#include "corda/render/frame_renderer.hpp"

#include <unistd.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/gl/driver.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {
namespace {

// Larger than a tile of llvmpipe (64 pixels), and not a multiple of it.
constexpr int kWidth = 88;
constexpr int kHeight = 72;

/// A gradient with lines and discs, with and without halo, wide and thin, opaque and faded, in opaque and
/// transparent layers, which overlap and extend beyond the edge; some are tinted if `with_tints`. `shift_px`
/// moves them.
view::DrawList test_picture(double shift_px, bool with_tints) {
    view::DrawList list;
    list.width = kWidth;
    list.height = kHeight;
    list.ground = {{250, 240, 230}, {20, 60, 90}};
    for (const bool is_tinted : {false, true}) {
        if (is_tinted && !with_tints) break;
        for (const bool is_opaque : {true, false}) {
            list.add_layer({200, 30, 10, static_cast<std::uint8_t>(is_opaque ? 255 : 120)}, is_tinted);
            const double x = shift_px + (is_opaque ? 3.3 : 40.7);
            const double y = is_tinted ? 30.2 : 8.6;
            list.add_capsule({x, y}, {x + 31.0, y + 9.4}, 3.7, 2.5, {10, 200, 90, 1});
            list.add_capsule({x + 31.0, y + 9.4}, {x + 12.5, y + 33.1}, 0.4, 0.0, {240, 20, 250, 1}, 0.7);
            list.add_capsule({x + 12.5, y + 20.0}, {x + 12.5, y + 20.0}, 8.2, 1.0, {40, 90, 255, 64});
        }
    }
    return list;
}

/// Describes the first pixel in which two images differ; std::nullopt if they are equal.
std::optional<std::string> first_difference(const Image& drawn, const Image& wanted) {
    const auto text = [](const std::uint8_t* rgba) {
        return fmt::format("({}, {}, {}, {})", rgba[0], rgba[1], rgba[2], rgba[3]);
    };
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const std::uint8_t* const pixel = drawn.pixel(x, y);
            if (std::equal(pixel, pixel + 4, wanted.pixel(x, y))) continue;
            return fmt::format("pixel ({}, {}) of the test picture is {} and should be {}", x, y, text(pixel),
                               text(wanted.pixel(x, y)));
        }
    }
    return std::nullopt;
}

}  // namespace

void check_driver(const gl::Context& context, const FrameRenderer& renderer, bool with_tints) {
    static std::set<std::string> checked;
    const auto lock = gl::lock_driver();
    const gl::ContextInfo& info = context.info();
    const std::string driver = fmt::format("{} ({}), OpenGL {}, by {}", info.gl_renderer, info.gl_vendor,
                                           info.gl_version, context.platform());
    // A forked child repeats the check: parts of the driver are lost in it.
    const std::string key = fmt::format("{} {} {}", getpid(), with_tints, driver);
    if (checked.contains(key)) return;
    FrameRenderer small(renderer, kWidth, kHeight);
    for (const double shift_px : {0.0, 5.5}) {  // the second frame redraws parts of the first
        const view::DrawList list = test_picture(shift_px, with_tints);
        small.render(list);
        const auto difference = first_difference(small.image(), render_reference(list));
        if (!difference) continue;
        gl::note_faulty_driver();
        throw_error(
            ExitCode::kNoGl,
            "the driver draws wrongly: {}. Driver: {}\nChoose another one by --backend (`corda doctor` "
            "checks each). {}",
            *difference, driver, gl::kDriverRemedy);
    }
    checked.insert(key);
}

void check_driver(const gl::Context& context) {
    const auto lock = context.exclusive();
    const FrameRenderer renderer(context, kWidth, kHeight);
    for (const bool with_tints : {false, true}) check_driver(context, renderer, with_tints);
}

}  // namespace corda::render
