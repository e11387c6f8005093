// Checks of definitions as a whole: the schema checks each value.
#include <fmt/format.h>

#include <algorithm>

#include "corda/core/image.hpp"
#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"
#include "corda/view/arrows.hpp"
#include "corda/view/font.hpp"

namespace corda::scene {
namespace {

void add_if_empty(std::string_view key, const std::optional<Interval>& range,
                  std::vector<DefProblem>& problems) {
    if (range && !(range->high > range->low))
        problems.push_back(
            {key, 1, fmt::format("{} is not above {}", number_text(range->high), number_text(range->low)),
             "give the lower end first"});
}

}  // namespace

std::vector<DefProblem> problems_of(const VideoDef& video) {
    // A speed out of its range is refused by itself.
    if (video.speed.is_rate() && !video.scene_fraction().is_rate())
        return {{"speed",
                 {},
                 fmt::format("{} frames per second at this speed are {} per second of the scene, not a "
                             "fraction of integers within 1 .. {}",
                             video.fps.rational().text(), video.scene_fraction().text(), Rational::kMaxPart),
                 "give a simpler fraction"}};
    const std::int64_t pixels = std::int64_t{video.width_px} * video.height_px;
    if (pixels <= kMaxPicturePx) return {};
    return {{"size",
             {},
             fmt::format("{} x {} are {} pixels, over the limit of {}", video.width_px, video.height_px,
                         pixels, kMaxPicturePx),
             "give a smaller size"}};
}

std::vector<DefProblem> problems_of(const OverlayTextDef& text) {
    if (!text.to_s || *text.to_s > text.from_s) return {};
    return {{"to",
             {},
             fmt::format("{} s is not after {} s, when it appears", *text.to_s, text.from_s),
             "give a later time"}};
}

std::vector<DefProblem> problems_of(const OverlayDef& overlay, const std::vector<RopeDef>& ropes) {
    const auto has_one_pin = [](const RopeDef& rope) { return rope.pinned.size() == 1 && !rope.closed; };
    const auto moves = [](const RopeDef& rope) { return rope.pinned.size() < rope.points_m.size(); };
    const bool has_angle = std::ranges::any_of(ropes, has_one_pin);
    const std::vector<LivePlot>& plots = overlay.plots;
    std::vector<DefProblem> problems;
    for (std::size_t i = 0; i < plots.size(); ++i) {
        const auto add = [&](const char* what, const char* remedy) {
            problems.push_back({"plots", i, what, remedy});
        };
        const auto now = plots.begin() + static_cast<std::ptrdiff_t>(i);
        if (std::find(plots.begin(), now, *now) != now) add("the same plot twice", "remove one");
        if ((*now == LivePlot::kAngle || *now == LivePlot::kPhase) && !has_angle)
            add("no rope has one pinned particle, to measure the angle about, and a free end",
                "pin one particle of an open rope, or remove this plot");
        if (*now == LivePlot::kDivergence && ropes.size() < 2)
            add("it is the distance of the tips of ropes 0 and 1, and there are not two ropes",
                "give another [[rope]] or rope.copies, or remove this plot");
        else if (*now == LivePlot::kDivergence && !(moves(ropes[0]) && moves(ropes[1])))
            add("it is the distance of the tips of ropes 0 and 1, and all particles of one of them are "
                "pinned",
                "pin fewer, give ropes that move first, or remove this plot");
    }
    const bool shows_energy = overlay.energy || std::ranges::count(plots, LivePlot::kEnergy) > 0;
    if (overlay.energy_zero != EnergyZero::kStart && !shows_energy)
        problems.push_back({"energy_zero",
                            {},
                            "no energy is shown",
                            "give overlay.plots = [\"energy\"], or remove energy_zero"});
    return problems;
}

std::vector<DefProblem> problems_of(const PlotRangesDef& ranges, const std::vector<LivePlot>& plots) {
    std::vector<DefProblem> problems;
    for (const Key& key : keys_of("overlay.plot_range")) {
        const auto plot = static_cast<LivePlot>(&key - keys_of("overlay.plot_range").data());
        const std::optional<Interval>& range = ranges.of[static_cast<std::size_t>(plot)];
        add_if_empty(key.name, range, problems);
        const bool is_shown = std::ranges::any_of(plots, [plot](LivePlot shown) {
            return shown == plot || (plot == LivePlot::kAngle && shown == LivePlot::kPhase);
        });
        if (range && !is_shown)
            problems.push_back({key.name,
                                {},
                                fmt::format("the plot {} is not shown", key.name),
                                "add it to overlay.plots, or remove its range"});
    }
    return problems;
}

std::vector<DefProblem> problems_of(const StyleDef& style, const std::vector<RopeDef>& ropes,
                                    const std::vector<NetDef>& nets) {
    std::size_t most = 0;
    for (const RopeDef& rope : ropes) most = std::max(most, rope.points_m.size());
    for (const NetDef& net : nets) most = std::max(most, net.points_m.size());
    const auto count = static_cast<std::int64_t>(most);
    std::vector<DefProblem> problems;
    add_if_empty("color_range", style.color_range, problems);
    if (style.color_range && !quantity_of(style.color_by))
        problems.push_back({"color_range",
                            {},
                            "the colours show no quantity",
                            "give style.color_by = \"tension\", \"speed\" or \"strain\", or remove it"});
    if (style.arrow_scale_px && style.arrows == Arrows::kNone)
        problems.push_back({"arrow_scale", {}, "there are no arrows", "give style.arrows, or remove it"});
    const bool has_balls =
        style.payload && std::ranges::any_of(ropes, [](const RopeDef& rope) {
            return rope.payload_kg > 0.0 || rope.points_m.size() <= view::kLinksOfPendulum + 1;
        });
    if (style.payload_radius_m && !has_balls)
        problems.push_back({"payload_radius",
                            {},
                            "there are no balls",
                            "give a rope a payload, with style.payload = true, or remove it"});
    if (!style.trail_of.empty() && style.trail_s == 0.0)
        problems.push_back(
            {"trail_of", {}, "no trail without a length", "give style.trail_s, or remove trail_of"});
    for (std::size_t i = 0; i < style.trail_of.size(); ++i) {
        const std::int64_t particle = style.trail_of[i];
        if (particle < -count || particle >= count)
            problems.push_back({"trail_of", i, fmt::format("{} is out of range", particle),
                                fmt::format("the particles of the longest rope or net are 0 .. {}, or -1 .. "
                                            "-{} from its end",
                                            count - 1, count)});
    }
    return problems;
}

std::vector<DefProblem> problems_of(const CameraDef& camera, std::size_t bodies) {
    if (camera.follow && !camera.path.empty())
        return {{"path",
                 {},
                 "the camera follows something, or has a path",
                 "remove camera.follow or camera.path"}};
    if (camera.follow && *camera.follow >= static_cast<int>(bodies))
        return {{"follow",
                 {},
                 fmt::format("{} is out of range", *camera.follow),
                 fmt::format("the ropes and nets are 0 .. {}", bodies - 1)}};
    for (std::size_t i = 1; i < camera.path.size(); ++i) {
        if (camera.path[i].time_s <= camera.path[i - 1].time_s)
            return {{"path",
                     {},
                     fmt::format("{} s after {} s", camera.path[i].time_s, camera.path[i - 1].time_s),
                     "give times that increase"}};
    }
    return {};
}

std::vector<DefProblem> problems_of(const GoldenDef& golden) {
    std::vector<DefProblem> problems;
    for (std::size_t i = 1; i < golden.at_s.size(); ++i) {
        if (golden.at_s[i] > golden.at_s[i - 1]) continue;
        problems.push_back({"at", i, fmt::format("{} s after {} s", golden.at_s[i], golden.at_s[i - 1]),
                            "give times that increase"});
    }
    if (!is_picture_size(golden.width_px, golden.height_px))
        problems.push_back(
            {"size", {}, fmt::format("over the limit of {} pixels", kMaxPicturePx), "give a smaller size"});
    return problems;
}

std::optional<Problem> problem_of_texts(const Scene& scene) {
    try {
        return view::missing_glyphs(shown_texts(scene), font_path(scene), scene.overlay.font);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kInvalidScene) throw;
        return error.problems().front();
    }
}

}  // namespace corda::scene
