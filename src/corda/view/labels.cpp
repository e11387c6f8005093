#include "corda/view/labels.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "corda/core/cancel.hpp"

namespace corda::view {
namespace {

/// The share of the picture's width that a label takes at most, and the em that it may always take.
constexpr double kMaxLabel = 0.3;
constexpr double kShortLabel = 6.0;

std::optional<std::size_t> first_pin(const System& system, const Body& body) {
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
        if (system.is_pinned(i)) return i;
    return std::nullopt;
}

bool are_together(const System& system, std::size_t i, std::size_t k) {
    return system.x_m[i] == system.x_m[k] && system.y_m[i] == system.y_m[k];
}

/// True if another body has its label above a pin of body `b`.
bool is_shared(const SceneView& view, std::size_t pin, std::size_t b) {
    const System& system = *view.system;
    for (std::size_t other = 0; other < system.bodies.size(); ++other) {
        const Body& body = system.bodies[other];
        if (other == b || body.label.empty() || view.bodies[other].label_at == LabelAt::kEnd) continue;
        const auto other_pin = first_pin(system, body);
        if (other_pin && are_together(system, *other_pin, pin)) return true;
    }
    return false;
}

BodyLabel label_of(const SceneView& view, std::size_t b) {
    const System& system = *view.system;
    const Body& body = system.bodies[b];
    const auto pin = first_pin(system, body);
    const auto end = free_end(system, body);
    const auto place = [&] {
        const bool has_room = pin && !is_shared(view, *pin, b);
        return view.bodies[b].label_at.value_or(has_room ? LabelAt::kPin : LabelAt::kEnd);
    };
    if (end && (!pin || place() == LabelAt::kEnd)) return label_at(view, *end, body.label);
    if (!pin) return {body.label, body.first_particle, body.first_particle, view.bodies[b].radius_px};
    std::vector<Drawn> supports;
    view.supports.list(supports);
    double clear_px = view.bodies[b].pinned_marker_radius_px;
    for (const Drawn& support : supports) clear_px = std::max(clear_px, support.up_px);
    return {body.label, *pin, *pin, clear_px};
}

/// Distance of a label from its particle, if `free_px` around that are free.
double distance_px(const TextArea& area, const BodyLabel& label, double free_px) {
    return free_px + (kGap + label.row * kLine) * area.em_px + label.raise_px;
}

/// The box of a label in the direction of its line, turned by an eighth turn `turns` times.
PixelRect label_box(const TextArea& area, const std::string& text, const LabelPlace& place, int turns,
                    double clear_px, const Font& font) {
    const PixelPoint at = place.at;
    PixelPoint along{at.x - place.from.x, at.y - place.from.y};
    const double length = sim::length(along.x, along.y);
    along = length > 0.0 ? PixelPoint{along.x / length, along.y / length} : PixelPoint{0.0, -1.0};
    constexpr double kHalfRoot = 0.70710678118654752;
    for (int i = 0; i < turns; ++i)
        along = {kHalfRoot * (along.x - along.y), kHalfRoot * (along.x + along.y)};
    const int width_px = font.width_px(text, area.em_px);
    const double middle_px = at.x + along.x * (clear_px + 0.5 * width_px);
    const double baseline_px = at.y + along.y * clear_px + 0.5 * (1.0 + along.y) * kAscent * area.em_px;
    // Beyond the frame, pixels may be more than an int holds.
    if (!(std::abs(middle_px) < area.width_px + width_px &&
          std::abs(baseline_px) < area.height_px + area.em_px))
        return {};
    const int x_px = rounded(middle_px - 0.5 * width_px);
    return {x_px, rounded(baseline_px) - rounded(kAscent * area.em_px), x_px + width_px,
            rounded(baseline_px)};
}

}  // namespace

BodyLabel label_at(const SceneView& view, std::size_t particle, std::string text) {
    const std::size_t b = body_of(*view.system, particle);
    const Body& body = view.system->bodies[b];
    BodyLabel label{std::move(text), particle, particle,
                    std::max(view.bodies[b].radius_px, view.bodies[b].end_radius_px)};
    for (const Ball& ball : view.bodies[b].balls) {
        if (ball.particle != particle) continue;
        label.clear_px = ball.radius_px;
        label.clear_m = ball.radius_m;
    }
    if (free_end(*view.system, body) == particle)
        label.from = particle == body.first_particle ? particle + 1 : particle - 1;
    return label;
}

std::vector<BodyLabel> body_labels(const SceneView& view) {
    std::vector<BodyLabel> labels;
    for (std::size_t b = 0; b < view.bodies.size(); ++b) {
        if (view.system->bodies[b].label.empty()) continue;
        BodyLabel label = label_of(view, b);
        for (const BodyLabel& other : labels) {
            const bool are_above = label.particle == label.from && other.particle == other.from;
            if (are_above && are_together(*view.system, label.particle, other.particle)) ++label.row;
        }
        labels.push_back(std::move(label));
    }
    return labels;
}

LabelPlace place_of(const BodyLabel& label, const State& state, const Camera& camera) {
    return {camera.at(state, label.particle), camera.at(state, label.from),
            std::max(label.clear_px, label.clear_m * camera.pixels_per_metre())};
}

std::vector<LabelPlace> places_of(std::span<const BodyLabel> labels, const State& state,
                                  const Camera& camera) {
    std::vector<LabelPlace> places;
    for (const BodyLabel& label : labels) places.push_back(place_of(label, state, camera));
    return places;
}

std::vector<BodyLabel> shortened(const TextArea& area, std::vector<BodyLabel> labels) {
    const int most_px = rounded(std::max(kMaxLabel * area.width_px, kShortLabel * area.em_px));
    for (BodyLabel& label : labels)
        label.text = area.words.shortened(std::move(label.text), area.em_px, most_px);
    return labels;
}

bool stack_labels(const TextArea& area, std::span<BodyLabel> labels, const State& state,
                  const Camera& camera) {
    constexpr int kMaxRows = 3;  // more than its own
    const auto box_of = [&](const BodyLabel& label) {
        const LabelPlace place = place_of(label, state, camera);
        return label_box(area, label.text, place, 0, distance_px(area, label, place.clear_px), area.words);
    };
    const int gap_px = rounded(kGap * area.em_px);
    std::vector<PixelRect> taken;
    bool are_stacked = false;
    for (BodyLabel& label : labels) {
        const auto is_free = [&](PixelRect box) {
            box.x0 -= gap_px;
            box.x1 += gap_px;
            return std::ranges::none_of(
                taken, [&](const PixelRect& other) { return !box.intersected(other).empty(); });
        };
        const bool is_above = label.from == label.particle;
        const int own = label.row;
        while (is_above && label.row < own + kMaxRows && !is_free(box_of(label))) ++label.row;
        if (is_above && !is_free(box_of(label))) label.row = own;
        are_stacked = are_stacked || label.row > own;
        taken.push_back(box_of(label));
    }
    return are_stacked;
}

std::vector<Drawn> drawn_labels(const TextArea& area, std::span<const BodyLabel> labels,
                                std::span<const MotionBounds> bounds, double metres_per_px) {
    std::vector<Drawn> drawn;
    for (const BodyLabel& label : labels) {
        const double width_px = area.words.width_px(label.text, area.em_px);
        const double gap_px = distance_px(area, label, label.clear_px) - label.raise_px;
        Drawn text;
        text.bounds = bounds[label.particle].widened(label.clear_m);
        if (label.raise_px > 0.0 && !text.bounds.empty())
            text.bounds.include(text.bounds.max_m().x,
                                text.bounds.max_m().y + label.raise_px * metres_per_px);
        text.up_px = gap_px + kAscent * area.em_px;
        const bool is_above = label.from == label.particle;
        text.left_px = text.right_px = is_above ? 0.5 * width_px : gap_px + width_px;
        if (!is_above) text.down_px = text.up_px;
        drawn.push_back(text);
    }
    return drawn;
}

void draw_label(const TextArea& area, const BodyLabel& label, const LabelPlace& place, DrawList& list) {
    const PixelRect box =
        label_box(area, label.text, place, 0, distance_px(area, label, place.clear_px), area.words);
    if (!box.empty()) area.words.write({box.x0, box.y1, area.em_px, area.color, label.text}, list);
}

LabelRoom::LabelRoom(const TextArea& area, const SceneView& view, std::vector<BodyLabel>& labels)
    : area_(&area),
      view_(&view),
      labels_(&labels),
      above_px_(labels.size(), area.height_px),
      is_taken_(labels.size(), std::vector<bool>(static_cast<std::size_t>(area.height_px))) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
        labels[i].raise_px = 0.0;
        if (is_above_pin(labels[i]))
            above_.push_back({i, 0.5 * area.words.width_px(labels[i].text, area.em_px), {}});
    }
}

bool LabelRoom::is_needed(std::span<const MotionBounds> bounds) const {
    double top_m = -HUGE_VAL;
    for (const MotionBounds& one : bounds) top_m = std::max(top_m, one.max_m().y);
    return std::ranges::any_of(*labels_, [&](const BodyLabel& label) {
        return is_above_pin(label) && bounds[label.particle].min_m().y < top_m;
    });
}

void LabelRoom::include(const State& state, const Camera& camera, std::span<const Trail> trails) {
    constexpr std::size_t kPairsPerUpdate = 50;  // of a line and a label, per update of count_work()
    const System& system = *view_->system;
    at_.resize(system.particle_count());
    for (std::size_t k = 0; k < at_.size(); ++k) at_[k] = camera.at(state, k);
    for (Above& above : above_) {
        above.pin = at_[(*labels_)[above.label].particle];
        above_px_[above.label] = std::min(above_px_[above.label], above.pin.y);
    }
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        const Body& body = system.bodies[b];
        const BodyView& look = view_->bodies[b];
        const double radius_px = std::max(look.radius_px, look.end_radius_px);
        count_work(1 + (body.link_count + look.balls.size()) * (1 + above_.size()) / kPairsPerUpdate);
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k)
            if (system.has_bar_at(k, state.time_s))
                add_line(at_[system.bars[k].a], at_[system.bars[k].b], radius_px);
        for (const Ball& ball : look.balls)
            add_line(at_[ball.particle], at_[ball.particle], ball.radius_in(camera));
    }
    for (const Trail& trail : trails) {
        count_work(1 + trail.size() * (1 + above_.size()) / kPairsPerUpdate);
        for (std::size_t k = 1; k < trail.size(); ++k) {
            const Vec2 a_m = trail[k - 1].at_m;
            const Vec2 b_m = trail[k].at_m;
            add_line({camera.x_px(a_m.x), camera.y_px(a_m.y)}, {camera.x_px(b_m.x), camera.y_px(b_m.y)},
                     view_->rope_width_px);
        }
    }
}

void LabelRoom::add_line(PixelPoint a, PixelPoint b, double radius_px) {
    const auto [left_px, right_px] = std::minmax(a.x, b.x);
    const double top_px = std::min(a.y, b.y) - radius_px;
    for (const Above& above : above_) {
        const double reach_px = above.half_px + radius_px + 1.0;  // more than rounding
        if (top_px > above.pin.y + 1.0 || left_px > above.pin.x + reach_px ||
            right_px < above.pin.x - reach_px)
            continue;
        add_line(above, {a.x - above.pin.x, above.pin.y - a.y}, {b.x - above.pin.x, above.pin.y - b.y},
                 radius_px);
    }
}

void LabelRoom::add_line(const Above& above, Vec2 a_px, Vec2 b_px, double radius_px) {
    const double half_px = above.half_px + radius_px;
    if (a_px.x > b_px.x) std::swap(a_px, b_px);
    if (a_px.x > half_px || b_px.x < -half_px) return;
    const auto height_at = [&](double x_px) {
        return a_px.y + (x_px - a_px.x) / (b_px.x - a_px.x) * (b_px.y - a_px.y);
    };
    const double from_px = a_px.x < -half_px ? height_at(-half_px) : a_px.y;
    const double to_px = b_px.x > half_px ? height_at(half_px) : b_px.y;
    std::vector<bool>& rows = is_taken_[above.label];
    const auto row = [&](double height_px) {
        return static_cast<std::size_t>(std::clamp(height_px, 0.0, static_cast<double>(rows.size())));
    };
    const std::size_t end = row(std::max(from_px, to_px) + radius_px);
    for (std::size_t k = row(std::min(from_px, to_px) - radius_px); k < end; ++k) rows[k] = true;
}

bool LabelRoom::raise_labels(bool will_fit) {
    bool are_raised = false;
    const int gap_px = rounded(kGap * area_->em_px);
    const int text_px = rounded(kAscent * area_->em_px);
    for (std::size_t i = 0; i < labels_->size(); ++i) {
        BodyLabel& label = (*labels_)[i];
        const std::vector<bool>& rows = is_taken_[i];
        const auto is_free = [&](int first, int end) {
            for (int k = std::max(first, 0); k < std::min<int>(end, static_cast<int>(rows.size())); ++k)
                if (rows[static_cast<std::size_t>(k)]) return false;
            return true;
        };
        for (std::size_t k = 0; k < i; ++k)  // its row is above those of the same pin
            if (are_together(*view_->system, (*labels_)[k].particle, label.particle) && label.row > 0)
                label.raise_px = std::max(label.raise_px, (*labels_)[k].raise_px);
        const int least_px = rounded(distance_px(*area_, label, label.clear_px));
        if (is_free(least_px, least_px + text_px)) continue;
        const double room_px = std::clamp(above_px_[i], 0.0, static_cast<double>(rows.size()));
        const int most_px = will_fit ? static_cast<int>(rows.size()) : static_cast<int>(room_px) - text_px;
        for (int at_px = least_px + 1; at_px <= most_px; ++at_px) {
            if (!is_free(at_px - gap_px, at_px + text_px + gap_px)) continue;
            label.raise_px += at_px - least_px;
            break;
        }
        are_raised = are_raised || label.raise_px > 0.0;
    }
    return are_raised;
}

void draw_times(const TextArea& area, std::span<const PoseTime> poses, DrawList& list) {
    constexpr int kTurns[] = {0, 1, 7, 2, 6, 3, 5, 4};
    constexpr double kFaintest = 0.6;
    const int gap_px = rounded(kGap * area.em_px);
    std::vector<PixelRect> taken{
        {0, area.height_px - area.edge_px - area.em_px, area.width_px, area.height_px}};
    for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
        const auto distance_px = [](const PixelRect& box, const PoseTime& to) {  // from its ball
            const double x_px = std::clamp<double>(to.place.at.x, box.x0, box.x1) - to.place.at.x;
            const double y_px = std::clamp<double>(to.place.at.y, box.y0, box.y1) - to.place.at.y;
            return sim::length(x_px, y_px) - to.place.clear_px;
        };
        const auto is_clear = [&](const PixelRect& box) {  // whose time it is
            return std::ranges::all_of(poses, [&](const PoseTime& other) {
                return &other == &*pose || distance_px(box, other) > distance_px(box, *pose) + gap_px;
            });
        };
        const auto is_free = [&](const PixelRect& box) {
            const PixelRect around{box.x0 - gap_px, box.y0 - gap_px, box.x1 + gap_px, box.y1 + gap_px};
            return !box.empty() && around.intersected({0, 0, area.width_px, area.height_px}) == around &&
                   std::ranges::all_of(
                       taken, [&](const PixelRect& other) { return around.intersected(other).empty(); });
        };
        for (int i = 0; i < 16; ++i) {  // near, then farther away
            const double clear_px = pose->place.clear_px + gap_px + (i < 8 ? 0.0 : kLine * area.em_px);
            const PixelRect box =
                label_box(area, pose->label.text, pose->place, kTurns[i % 8], clear_px, area.font);
            if (!is_free(box) || !is_clear(box)) continue;
            Color color = area.color;
            color.a = static_cast<std::uint8_t>(std::lround(255.0 * std::max(kFaintest, pose->opacity)));
            area.font.write({box.x0, box.y1, area.em_px, color, pose->label.text}, list);
            taken.push_back(box);
            break;
        }
    }
}

}  // namespace corda::view
