#include "corda/film/plan_text.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/text.hpp"
#include "corda/film/provenance.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/sim/events.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/solver.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/number_text.hpp"
#include "corda/view/words.hpp"

namespace corda {
namespace {

std::string_view remedy(Refusal::Reason reason) {
    using Reason = Refusal::Reason;
    switch (reason) {
        case Reason::kDefinition:
            return "see its declaration in corda/sim/defs.hpp";
        case Reason::kBarWithoutLength:
            return "move one, or use method relaxation";
        case Reason::kImaginaryBars:
            return "remove the imaginary bars (solver.reach, net.grid.diagonals) or use method relaxation";
        case Reason::kRigidGraph:
            return "use method auto, or let the bars stretch by a compliance";
        case Reason::kRigidStringGraph:
            return "open it, or let it stretch by a compliance";
        case Reason::kRigidString:
            return "use method auto, or let the string stretch by a compliance";
        case Reason::kRigidBendingString:
            return "remove bending, or let the string stretch by a compliance";
        case Reason::kStretchedString:
            return "give a larger link_length, or a compliance";
        case Reason::kUndecidedString:
            return "change its points or velocity a little";
        case Reason::kUnlikeMoves:
            return "give all pins of the body the same waves and path in moves, or let it stretch by a "
                   "compliance";
        case Reason::kTautBetweenPins:
            return "let the rope sag between its pins (other points, or a string with a larger link_length), "
                   "or pin the particles between them too";
        case Reason::kImplicit:
            return "leave out solver.implicit";
        case Reason::kDependentBars:
            return "bend collinear bars a little, leave out bars that others imply, or use method "
                   "relaxation";
        case Reason::kMaterial:
            return "remove compliance, string and bending, or use method auto";
        case Reason::kUnknownTensions:
            return "set style.color_by = \"strain\" or \"speed\", style.arrows = \"velocity\" or "
                   "\"weight\", or let the bars stretch by a compliance";
        case Reason::kManySteps:
            return "give less unequal masses, less bending or more compliance, or name a method";
    }
    return "";
}

constexpr std::string_view kGivenName = "given";

bool is_given(const Plan& plan) {
    return plan.bodies.front().reason == PlanReason::kGiven;
}

/// Range of the values above 0 of one quantity over all bodies.
class Values {
  public:
    void include(double value) {
        if (value == 0.0) return;
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
    }
    [[nodiscard]] bool empty() const { return high_ == 0.0; }
    [[nodiscard]] std::string text() const {
        return low_ == high_ ? fmt::format("{}", low_) : fmt::format("{} .. {}", low_, high_);
    }

  private:
    double low_ = HUGE_VAL;
    double high_ = 0.0;
};

/// Materials of all bodies.
struct Materials {
    Values compliance_1_n;
    Values bending_n_m2;
    bool rigid = false;
    bool slack = false;    ///< there is a string
    bool plastic = false;  ///< there is a rigid string, which loses energy when it comes taut
};

Materials list_materials(const Scene& scene) {
    Materials result;
    const auto include = [&result](const MaterialDef& material) {
        const bool rigid = material.compliance_1_n == 0.0;
        result.compliance_1_n.include(material.compliance_1_n);
        result.rigid = result.rigid || rigid;
        result.slack = result.slack || material.is_string;
        result.plastic = result.plastic || (material.is_string && rigid);
    };
    for (const RopeDef& rope : scene.ropes) {
        include(rope.material);
        result.bending_n_m2.include(rope.bending_n_m2);
    }
    for (const NetDef& net : scene.nets) include(net.material);
    return result;
}

/// The forces, and the loss of energy other than by drag.
std::vector<std::string> force_terms(const Scene& scene, const Materials& materials,
                                     const RelaxationDef* relaxation) {
    std::vector<std::string> terms;
    const bool is_replaced = relaxation != nullptr && relaxation->force_n;
    if (is_replaced) {
        terms.push_back(fmt::format("a force of ({}, {}) N per particle, in place of gravity",
                                    relaxation->force_n->x, relaxation->force_n->y));
    }
    for (const sim::ForceKind& kind : sim::force_kinds()) {
        const sim::ForceTerm term = kind.term(scene.world);
        const bool is_of_air = term.drag_1_s != 0.0 || term.push_m_s2 != Vec2{} || !term.change_m_s2.empty();
        const std::string text = is_replaced && !is_of_air ? "" : kind.text(scene.world);
        if (!text.empty()) terms.push_back(text);
    }
    const auto moves = [](const auto& body) { return !body.moves.empty(); };
    const bool has_moves = std::ranges::any_of(scene.ropes, moves) || std::ranges::any_of(scene.nets, moves);
    if (has_moves) terms.emplace_back("pins that move, whose supports do work");
    const std::string events = sim::events_text(scene.ropes, scene.nets);
    if (!events.empty()) terms.push_back(events);
    if (sim::Forces(scene.world).drag_1_s() != 0.0 || has_moves || !events.empty()) return terms;
    if (relaxation != nullptr && relaxation->delta > 0.0)
        terms.push_back(
            fmt::format("damping: a share of {} of the velocity is lost per step", relaxation->delta));
    else if (relaxation != nullptr)
        terms.emplace_back("no drag; the passes lose energy, and print how much");
    else if (materials.plastic)
        terms.emplace_back("no drag: energy is lost only when a string comes taut");
    else
        terms.emplace_back("no drag: energy is kept");
    return terms;
}

std::string nets_term(const Scene& scene) {
    std::size_t real = 0;
    std::size_t all = 0;
    for (const NetDef& net : scene.nets) {
        all += net.bars.size();
        real += static_cast<std::size_t>(std::ranges::count_if(net.bars, &NetBar::is_real));
    }
    return fmt::format("nets: {}, of {} bars and {} imaginary ones", scene.nets.size(), real, all - real);
}

}  // namespace

std::string_view method_name(const BodyPlan& plan) {
    return plan.reason == PlanReason::kGiven ? kGivenName : method_name(plan.method);
}

std::string method_text(const BodyPlan& plan) {
    return plan.reason == PlanReason::kGiven ? std::string(kGivenName) : sim::method_text(plan.method);
}

std::string system_text(const System& system) {
    const std::int64_t nets = std::ssize(system.bodies) - static_cast<std::int64_t>(rope_count(system));
    const auto ropes = static_cast<std::int64_t>(rope_count(system));
    const std::string what = nets == 0    ? ""
                             : ropes == 0 ? counted(nets, "net") + ": "
                                          : counted(ropes, "rope") + ", " + counted(nets, "net") + ": ";
    return what + fmt::format("{}, {} ({} real)",
                              counted(static_cast<std::int64_t>(system.particle_count()), "particle"),
                              counted(std::ssize(system.bars), "bar"), system.link_count());
}

std::string reason_text(const BodyPlan& plan) {
    switch (plan.reason) {
        case PlanReason::kNamed:
            return fmt::format("the scene asks for {}", method_name(plan.method));
        case PlanReason::kExact:
            return "it has the smallest error for chains, nets of rigid bars and bodies that stretch";
        case PlanReason::kGraph:
            return "it keeps bars at their lengths where method exact cannot: in closed ropes, and in most "
                   "nets";
        case PlanReason::kDependent:
            return "bars depend on each other at the start in such a way that no method can tell the true "
                   "motion; there is no estimate of the error";
        case PlanReason::kCheapest:
            return "its error is within the tolerance, with less work than method exact";
        case PlanReason::kGiven:
            return "its positions are given and not simulated";
        case PlanReason::kManySteps:
            return "methods that keep bars at their lengths would take too many steps; there is no estimate "
                   "of the error";
    }
    return "";
}

std::optional<std::string> horizon_reason(const BodyPlan& plan) {
    if (!plan.horizon_s) return std::nullopt;
    if (plan.diverges) return "the simulation diverges";
    if (plan.unchecked) return "estimates of later times would take too much work";
    if (plan.undecided) {
        return "links of a string come taut so nearly at once, or one so barely, that rounding decides which "
               "do";
    }
    return std::string("the motion magnifies the least differences") +
           (plan.reason == PlanReason::kGraph ? " or bars come into line" : "");
}

std::optional<std::string> still_text(const BodyPlan& plan, bool is_alone) {
    if (plan.stands_still == StandsStill::kNo) return std::nullopt;
    if (plan.stands_still == StandsStill::kRow) {
        return "it hangs from a straight row of bars between its pins, which cannot bend; pin one particle "
               "alone, let the row sag, or let the net stretch by a compliance";
    }
    return std::string(
               "its bars make it a plate, and its pins hold it; pin one particle alone, let it "
               "stretch by a compliance, or ") +
           (is_alone ? "use method relaxation" : "give it method relaxation in [[solver.bodies]]");
}

std::string unknown_tensions_text(const BodyPlan& plan) {
    if (std::holds_alternative<RelaxationDef>(plan.method)) {
        return plan.reason == PlanReason::kNamed
                   ? "method relaxation has none; another solver.method gives them"
               : plan.reason == PlanReason::kManySteps
                   ? "auto takes method relaxation, which has none, because others would take too many "
                     "steps; give less unequal masses"
                   : "auto takes method relaxation, which has none, because bars depend on each other at the "
                     "start; bend collinear bars a little, or let them stretch by a compliance";
    }
    return "bars that depend on each other share them in any way, and a straight row between pins has none; "
           "leave out bars that others imply, let the row sag, or let the bars stretch by a compliance";
}

std::vector<MethodGroup> groups_of(const Plan& plan) {
    std::vector<MethodGroup> groups;
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        const BodyPlan& body = plan.bodies[i];
        const auto same = std::ranges::find_if(groups, [&](const MethodGroup& group) {
            return group.method == body.method && plan.bodies[group.bodies.front()].reason == body.reason;
        });
        if (same == groups.end())
            groups.push_back({body.method, {i}});
        else
            same->bodies.push_back(i);
    }
    return groups;
}

std::string bodies_text(const System& system, const std::vector<std::size_t>& bodies) {
    std::string text;
    for (std::size_t i = 0; i < bodies.size();) {
        std::size_t last = i;
        while (last + 1 < bodies.size() && bodies[last + 1] == bodies[last] + 1 &&
               system.bodies[bodies[last + 1]].is_net == system.bodies[bodies[i]].is_net &&
               system.bodies[bodies[i]].label.empty() && system.bodies[bodies[last + 1]].label.empty())
            ++last;
        if (i > 0) text += ", ";
        text += body_name(system, bodies[i]);
        if (last > i) text += " to " + body_name(system, bodies[last]);
        i = last + 1;
    }
    return text;
}

std::string plan_text(const System& system, const Plan& plan) {
    const std::vector<MethodGroup> groups = groups_of(plan);
    const auto text_of = [&](const MethodGroup& group) {
        return method_text(plan.bodies[group.bodies.front()]);
    };
    if (groups.size() == 1) return text_of(groups.front());
    std::string text;
    for (const MethodGroup& group : groups) {
        if (!text.empty()) text += "; ";
        text += fmt::format("{} ({})", text_of(group), bodies_text(system, group.bodies));
    }
    return text;
}

std::string method_names(const Plan& plan) {
    std::vector<std::string_view> names;
    for (const BodyPlan& body : plan.bodies) {
        const std::string_view name = method_name(body);
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string method_caption(const Plan& plan, const std::optional<double>& error_estimate_px,
                           Language language) {
    std::string names = method_names(plan);
    if (!error_estimate_px) return names;
    constexpr double kSmallest = 1e-3;  // with decimals
    const std::string estimate = *error_estimate_px < kSmallest
                                     ? view::power_text(*error_estimate_px)
                                     : fmt::format("{:g}", view::rounded_up(*error_estimate_px));
    return names + ", " +
           fmt::format(fmt::runtime(view::translated("error below {} px", language)),
                       view::localized(estimate, language));
}

Error film::explained(const Refusal& refusal, const Scene& scene) {
    Place place{.source = scene.source, .key = {}};
    if (refusal.reason() == Refusal::Reason::kUnknownTensions) {
        if (scene.style.color_by == ColorBy::kTension) place.key = "style.color_by";
        if (scene.style.arrows == Arrows::kTension) place.key = "style.arrows";
        if (!scene.tensions_place.key.empty()) place = scene.tensions_place;
    }
    return {refusal.code(), Problem{place, refusal.what(), std::string(remedy(refusal.reason()))}};
}

PngInfo picture_info(const std::string& scene_name, const std::string& times, const std::string& frames,
                     const std::string& provenance) {
    PngInfo info;
    info.text = {{"Software", fmt::format("corda {}", version())},
                 {"Title", printable(scene_name)},
                 {"Time", times + " s"}};
    if (!frames.empty()) info.text.emplace_back("Frame", frames);
    info.text.emplace_back(kProvenanceKeyword, provenance);
    return info;
}

nlohmann::json or_null(const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json or_null(const std::optional<std::string>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

std::vector<std::string> modelled_terms(const Scene& scene, const Plan& plan) {
    if (is_given(plan))
        return {"nothing: the positions are given, so forces, velocities, moves and methods change nothing"};
    const RelaxationDef* relaxation = nullptr;
    bool relaxes_all = true;
    for (const BodyPlan& body : plan.bodies) {
        const auto* const def = std::get_if<RelaxationDef>(&body.method);
        relaxes_all = relaxes_all && def != nullptr;
        if (def != nullptr) relaxation = def;
    }
    const Materials materials = list_materials(scene);
    std::vector<std::string> terms = force_terms(scene, materials, relaxation);
    if (relaxation != nullptr) terms.emplace_back("bars that stretch by what the passes of relaxation leave");
    if (!relaxes_all && materials.rigid) terms.emplace_back("links that do not stretch");
    if (!materials.compliance_1_n.empty()) {
        terms.push_back(fmt::format("links that stretch by {} of their length per newton",
                                    materials.compliance_1_n.text()));
    }
    if (materials.slack) terms.emplace_back("strings: links that pull and never push");
    if (!materials.bending_n_m2.empty())
        terms.push_back(fmt::format("bending stiffness of {} N m2", materials.bending_n_m2.text()));
    const auto closed = std::ranges::count_if(scene.ropes, &RopeDef::closed);
    if (closed > 0) terms.push_back(fmt::format("closed ropes: {}", closed));
    if (!scene.nets.empty()) terms.push_back(nets_term(scene));
    return terms;
}

std::optional<std::string> error_estimate_text(const Film& film) {
    const Plan& plan = film.plan();
    std::optional<double> largest_m;
    std::vector<std::size_t> without_estimate;
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        if (plan.bodies[i].error_estimate_m)
            largest_m = std::max(largest_m.value_or(0.0), *plan.bodies[i].error_estimate_m);
        else
            without_estimate.push_back(i);
    }
    if (!largest_m || plan.horizon_s == 0.0) return std::nullopt;
    const double largest_px = view::error_px(film.camera(), *largest_m, film.camera().height_m.value(),
                                             film.scene().video.height_px);
    std::string text =
        fmt::format("{:.2g} px, {:.2g} m", view::rounded_up(largest_px), view::rounded_up(*largest_m));
    text += plan.horizon_s ? fmt::format(", up to {:.6g} s", *plan.horizon_s) : ", up to the end";
    if (!without_estimate.empty()) text += ", except " + bodies_text(film.system(), without_estimate);
    return text;
}

Scene frozen_scene(const Film& film) {
    Scene scene = film.scene();
    scene.camera = film.camera();
    if (is_given(film.plan())) return scene;
    std::vector<MethodGroup> groups = groups_of(film.plan());
    // [solver] is for the largest group.
    std::ranges::stable_sort(
        groups, [](const MethodGroup& a, const MethodGroup& b) { return a.bodies.size() > b.bodies.size(); });
    scene.solver = solver_of(groups.front().method);
    scene.body_solvers.clear();
    for (std::size_t i = 1; i < groups.size(); ++i) {
        BodySolverDef& own = scene.body_solvers.emplace_back();
        own.method = groups[i].method;
        for (const std::size_t body : groups[i].bodies) {
            const bool is_rope = body < scene.ropes.size();
            (is_rope ? own.ropes : own.nets)
                .push_back(static_cast<std::uint32_t>(is_rope ? body : body - scene.ropes.size()));
        }
    }
    return scene;
}

std::string frozen_toml(const Film& film) {
    return write_solver_and_camera(frozen_scene(film));
}

}  // namespace corda
