#include "corda/film/draw.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/series.hpp"
#include "corda/view/words.hpp"

namespace corda::film {
namespace {

/// Maximum number of capsules in several poses: more would be indistinguishable, and take much memory.
constexpr std::size_t kMaxPoseCapsules = 5'000'000;

/// The texts of a state's picture.
view::Caption caption_of(const Look& look, const Motion& motion, const State& state, const Figures& figures,
                         const view::Camera& map) {
    const Plan& plan = motion.plan;
    std::optional<double> estimate_px;
    if (plan.error_estimate_m) {
        estimate_px = view::errors_shown(look.scene.camera) * *plan.error_estimate_m * map.pixels_per_metre();
    }
    view::Caption caption{state.time_s, figures.energy_error,
                          method_caption(plan, estimate_px, look.scene.overlay.language)};
    if (look.scene.overlay.energy && !figures.energy_error) {
        caption.energy = motion.energy_of(state);
        caption.energy->weight_j -= look.energy_zero_j;
    }
    caption.labels = view::places_of(look.overlay.labels, state, map);
    return caption;
}

/// Fills a list with a state, its trails, and curves up to a time.
void draw_state(const Look& look, const State& state, const view::Camera& map, double plotted_s,
                view::DrawList& list) {
    view::draw(look.view, state, map, list, look.paths.to(state));
    view::draw_curves(look.overlay, plotted_s, list);
}

/// The times of an exposure at `time_s`, in order.
std::vector<double> exposed_s(const Look& look, const Motion& motion, double time_s, double shutter) {
    const VideoDef& video = look.scene.video;
    std::vector<double> times_s;
    for (int i = 0; i < video.subframes; ++i)
        times_s.push_back(subframe_s(video, time_s, shutter, motion.end_s(), i));
    return times_s;
}

Painted paint_blurred(const Look& look, const Motion& motion, double time_s, double shutter,
                      render::Canvas& canvas) {
    view::DrawList& list = canvas.list();
    const view::Camera map = look.map_at(time_s);
    std::vector<double> times_s = exposed_s(look, motion, time_s, shutter);
    const auto middle = times_s.insert(std::ranges::lower_bound(times_s, time_s), time_s);
    auto next = times_s.begin();
    view::Caption caption;
    bool is_empty = true;
    canvas.begin_exposure();
    // The times of frames are states of their own, which give the caption.
    motion.for_each(times_s, [&](const State& state, const Figures& figures) {
        if (next++ == middle) {
            caption = caption_of(look, motion, state, figures, map);
            return;
        }
        draw_state(look, state, look.map_at(state.time_s), time_s, list);
        is_empty = is_empty && list.shows_nothing();
        canvas.expose(list);
    });
    view::start(look.view, list);
    view::draw(look.overlay, caption, map.pixels_per_metre(), list);
    return {canvas.develop(list), is_empty};
}

/// Adds one of several poses; returns the place of its time.
view::PoseTime add_pose(const Look& look, const State& state, const view::Camera& map, double opacity,
                        view::DrawList& list) {
    const std::size_t first_layer = list.layers.size();
    view::draw_pose(look.view, state, map, list);
    for (std::size_t l = first_layer; l < list.layers.size(); ++l) {
        Color& color = list.layers[l].color;
        color.a = static_cast<std::uint8_t>(std::lround(opacity * color.a));
    }
    const view::BodyLabel label = view::label_at(look.view, tip_of(*look.system), "");
    return {label, view::place_of(label, state, map), opacity};
}

}  // namespace

void draw(const Look& look, const Motion& motion, double time_s, view::DrawList& list) {
    const view::Camera map = look.map_at(time_s);
    motion.for_each({&time_s, 1}, [&](const State& state, const Figures& figures) {
        draw_state(look, state, map, time_s, list);
        view::draw(look.overlay, caption_of(look, motion, state, figures, map), map.pixels_per_metre(), list);
    });
}

void draw(const Look& look, const State& state, view::DrawList& list) {
    const view::Camera map = look.map_at(0.0);
    view::draw(look.view, state, map, list);
    view::Caption caption;
    caption.labels = view::places_of(look.overlay.labels, state, map);
    view::draw(look.overlay, caption, map.pixels_per_metre(), list);
}

void draw_poses(const Look& look, const Motion& motion, std::span<const double> times_s,
                view::DrawList& list) {
    const view::Camera map = look.map_at(times_s.back());
    view::start(look.view, list);
    view::draw_trails(look.view, look.paths.to(motion.at(times_s.back())), times_s.back(), map, list);
    std::vector<view::PoseTime> poses;
    view::Caption caption;
    motion.for_each(times_s, [&](const State& state, const Figures& figures) {
        check_cancelled();
        const double opacity = view::pose_opacity(poses.size(), times_s.size());
        poses.push_back(add_pose(look, state, map, opacity, list));
        if (poses.size() > 1 && list.capsules.size() > kMaxPoseCapsules) {
            throw_usage("{} of {} poses have over {} lines in all; ask for fewer times", poses.size(),
                        times_s.size(), kMaxPoseCapsules);
        }
        if (poses.size() < times_s.size()) return;
        view::draw_supports(look.view, state, map, list, times_s.front());
        caption = caption_of(look, motion, state, figures, map);
    });
    if (times_s.size() > 1) {  // the picture has no single time
        caption.time_s.reset();
        caption.energy_error.reset();
        const std::vector<std::string> digits = view::digits_of(times_s);
        for (std::size_t k = 0; k < poses.size(); ++k)
            poses[k].label.text = view::localized(digits[k] + " s", look.scene.overlay.language);
        if (look.overlay.has_time) view::draw_times(look.overlay.area, poses, list);
    }
    view::draw_curves(look.overlay, times_s.back(), list);
    view::draw(look.overlay, caption, map.pixels_per_metre(), list);
}

Painted paint(const Look& look, const Motion& motion, double time_s, double shutter, render::Canvas& canvas) {
    if (!(shutter >= 0.0 && shutter <= 1.0)) throw_usage("a shutter of {} is not within 0 .. 1", shutter);
    if (shutter > 0.0) return paint_blurred(look, motion, time_s, shutter, canvas);
    view::DrawList& list = canvas.list();
    draw(look, motion, time_s, list);
    return {canvas.paint(list), list.shows_nothing()};
}

Painted paint_poses(const Look& look, const Motion& motion, std::span<const double> times_s,
                    render::Canvas& canvas) {
    view::DrawList& list = canvas.list();
    draw_poses(look, motion, times_s, list);
    return {canvas.paint(list), list.shows_nothing()};
}

bool is_empty(const Look& look, const Motion& motion, double time_s, double shutter) {
    view::DrawList list;
    bool is_empty = true;
    const std::vector<double> times_s =
        shutter > 0.0 ? exposed_s(look, motion, time_s, shutter) : std::vector<double>{time_s};
    motion.for_each(times_s, [&](const State& state, const Figures& /*figures*/) {
        draw_state(look, state, look.map_at(state.time_s), time_s, list);
        is_empty = is_empty && list.shows_nothing();
    });
    return is_empty;
}

std::vector<std::uint8_t> mask(const Look& look, const State& state) {
    constexpr std::size_t kMaxDistinct = 255;
    const std::size_t bodies = look.system->bodies.size();
    if (bodies > kMaxDistinct)
        throw_usage("a mask distinguishes {} bodies, and the scene has {}", kMaxDistinct, bodies);
    const view::Camera map = look.map_at(state.time_s);
    view::DrawList list;
    view::start(look.view, list);
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(list.width) * list.height);
    for (std::size_t i = 0; i < bodies; ++i) {
        check_cancelled();
        list.clear();
        view::draw_bodies(look.view, i, i + 1, state, map, list);
        render::mark_covered(list, static_cast<std::uint8_t>(i + 1), mask);
    }
    return mask;
}

}  // namespace corda::film
