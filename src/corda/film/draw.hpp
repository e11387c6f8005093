#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/film/look.hpp"
#include "corda/film/motion.hpp"
#include "corda/render/canvas.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::film {

/// Fills a draw list with the sharp picture at a time. Throws as Motion::for_each().
void draw(const Look& look, const Motion& motion, double time_s, view::DrawList& list);

/// Fills a draw list with the picture of a state of a look_within().
void draw(const Look& look, const State& state, view::DrawList& list);

/// Fills a draw list with the poses at one or more increasing times: earlier ones fainter, the last one
/// opaque and on top. Throws corda::Error as Motion::for_each(), and kUsage for poses with too many lines in
/// total.
void draw_poses(const Look& look, const Motion& motion, std::span<const double> times_s,
                view::DrawList& list);

/// A picture on a canvas.
struct Painted {
    Damage damage;          ///< what may differ from the canvas's last picture
    bool is_empty = false;  ///< it shows only the ground
};

/// Paints the picture at a time, blurred over a share of the frame interval if `shutter` (0 .. 1) is more
/// than 0. Throws corda::Error as Motion::for_each() and Canvas::paint(), and kUsage for another shutter.
Painted paint(const Look& look, const Motion& motion, double time_s, double shutter, render::Canvas& canvas);

/// Paints draw_poses().
Painted paint_poses(const Look& look, const Motion& motion, std::span<const double> times_s,
                    render::Canvas& canvas);

/// True if the picture of paint() would show only the ground.
[[nodiscard]] bool is_empty(const Look& look, const Motion& motion, double time_s, double shutter);

/// See Film::mask().
[[nodiscard]] std::vector<std::uint8_t> mask(const Look& look, const State& state);

}  // namespace corda::film
