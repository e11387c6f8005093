#include "corda/view/labels.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace corda::view {
namespace {

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

}  // namespace

BodyLabel label_at(const SceneView& view, std::size_t particle, std::string text) {
    const std::size_t b = body_of(*view.system, particle);
    const Body& body = view.system->bodies[b];
    double clear_px = std::max(view.bodies[b].radius_px, view.bodies[b].end_radius_px);
    for (const Ball& ball : view.bodies[b].balls)
        if (ball.particle == particle) clear_px = ball.radius_px;
    const bool is_end = free_end(*view.system, body) == particle;
    const std::size_t next = particle == body.first_particle ? particle + 1 : particle - 1;
    return {std::move(text), particle, is_end ? next : particle, clear_px};
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

}  // namespace corda::view
