#include "corda/render/driver_check.hpp"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/child_process.hpp"
#include "corda/gl/driver.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/reference_renderer.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {
namespace {

// Larger than a tile of llvmpipe (64 pixels), and no multiple of one.
constexpr int kWidth = 88;
constexpr int kHeight = 72;

/// A trial takes 0.1 s, and as much memory as it needs.
constexpr ChildLimits kTrialLimits{std::uint64_t{1} << 46U, 20, 20.0};

/// Lines and discs with and without halo, wide and thin, opaque and transparent, tinted and not, that overlap
/// and leave the picture, on a gradient. `shift_px` moves them.
view::DrawList test_picture(double shift_px) {
    view::DrawList list;
    list.width = kWidth;
    list.height = kHeight;
    list.ground = {{250, 240, 230}, {20, 60, 90}};
    for (const bool is_tinted : {false, true}) {
        for (const bool is_opaque : {true, false}) {
            list.add_layer({200, 30, 10, static_cast<std::uint8_t>(is_opaque ? 255 : 120)}, is_tinted);
            const double x = shift_px + (is_opaque ? 3.3 : 40.7);
            const double y = is_tinted ? 30.2 : 8.6;
            list.add_capsule({x, y}, {x + 31.0, y + 9.4}, 3.7, 2.5, {10, 200, 90, 1});
            list.add_capsule({x + 31.0, y + 9.4}, {x + 12.5, y + 33.1}, 0.4, 0.0, {240, 20, 250, 1});
            list.add_capsule({x + 12.5, y + 20.0}, {x + 12.5, y + 20.0}, 8.2, 1.0, {40, 90, 255, 64});
        }
    }
    return list;
}

/// The first pixel in which two pictures differ, in words; empty if they are equal.
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

/// How making a context and drawing in it ends a child process: "crashed (Aborted)"; empty if it does not.
/// This process may have other threads: fork() leaves the locks of memory, of the loader and of the driver
/// usable in the child, and it takes no others.
std::string failure_in_child(const gl::ContextDef& def) {
    gl::prepare_driver();
    const auto draw = [&def]() -> std::string {
        try {
            const gl::Context context(def);
            check_driver(context);
        } catch (const Error&) {  // this process will throw it, too
        }
        return "done";
    };
    const auto end = run_in_child(draw, kTrialLimits);
    return !end || end->finished ? "" : end->text;
}

}  // namespace

void try_driver(const gl::ContextDef& def) {
    // How each trial failed; empty if it did not. Other variables are another trial.
    static std::map<std::tuple<gl::ContextDef::Backend, std::optional<int>, std::string>, std::string> trials;
    const auto lock = gl::lock_driver();
    if (!gl::has_unusual_variables()) return;
    const auto [trial, is_new] = trials.try_emplace({def.backend, def.device, gl::driver_variables()});
    if (is_new) trial->second = failure_in_child(def);
    if (trial->second.empty()) return;
    throw Error(ExitCode::kNoGl, fmt::format("the OpenGL driver {} when it was tried in a child process\n"
                                             "Unset what chooses or changes the driver: {}",
                                             trial->second, gl::driver_variables()));
}

void check_driver(const gl::Context& context) {
    static std::set<std::string> checked;
    const auto lock = gl::lock_driver();
    const gl::ContextInfo& info = context.info();
    const std::string driver = fmt::format("{} ({}), OpenGL {}, by {}", info.gl_renderer, info.gl_vendor,
                                           info.gl_version, context.platform());
    // A forked child repeats the check: parts of the driver are lost in it.
    const std::string key = fmt::format("{} {}", getpid(), driver);
    if (checked.contains(key)) return;
    FrameRenderer renderer(context, kWidth, kHeight);
    for (const double shift_px : {0.0, 5.5}) {  // the second picture is drawn over the first one
        const view::DrawList list = test_picture(shift_px);
        renderer.render(list);
        const auto difference = first_difference(renderer.image(), render_reference(list));
        if (!difference) continue;
        gl::note_faulty_driver();
        const std::string variables = gl::driver_variables();
        throw Error(
            ExitCode::kNoGl,
            fmt::format("the driver draws wrongly: {}. Driver: {}\n{}", *difference, driver,
                        variables.empty() ? "Choose another driver by --backend (`corda doctor` checks "
                                            "each), or install another version of it"
                                          : "Unset what chooses or changes the driver: " + variables));
    }
    checked.insert(key);
}

}  // namespace corda::render
