#include "corda/pipeline/describe.hpp"
#include "corda/pipeline/provenance.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/core/version.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/sim/solver.hpp"
#include "corda/view/number_text.hpp"

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
        case Reason::kTautBetweenPins:
            return "let the rope sag between its pins (other points, or a string with a larger link_length), "
                   "or pin the particles between them too";
        case Reason::kDependentBars:
            return "bend what is in line a little, leave out bars that others imply, or use method "
                   "relaxation";
        case Reason::kMaterial:
            return "remove compliance, string and bending, or use method auto";
        case Reason::kUnknownTensions:
            return "leave out --tension, set style.color_by = \"strain\" or \"speed\", or let the bars "
                   "stretch by a compliance";
    }
    return "";
}

}  // namespace

std::string describe(const System& system) {
    const std::int64_t nets = std::ssize(system.bodies) - static_cast<std::int64_t>(rope_count(system));
    const std::string what = nets == 0 ? "" : counted(nets, "net") + ": ";
    return what + fmt::format("{}, {} ({} real)",
                              counted(static_cast<std::int64_t>(system.particle_count()), "particle"),
                              counted(std::ssize(system.bars), "bar"), system.link_count());
}

std::string describe(const MethodDef& method) {
    return sim::method_text(method);
}

std::string describe(const BodyPlan& plan) {
    switch (plan.reason) {
        case PlanReason::kNamed:
            return fmt::format("the scene asks for {}", method_name(plan.method));
        case PlanReason::kExact:
            return "it moves chains, and bodies that stretch, with the least error";
        case PlanReason::kGraph:
            return "it keeps the bars of closed ropes and nets at their lengths";
        case PlanReason::kDependent:
            return "bars depend on each other at the start in such a way that no method can tell the true "
                   "motion; there is no bound of the error";
    }
    return "";
}

std::vector<MethodGroup> groups_of(const Plan& plan) {
    std::vector<MethodGroup> groups;
    std::map<std::pair<std::string, PlanReason>, std::size_t> group_of;
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        const BodyPlan& body = plan.bodies[i];
        const auto [entry, is_new] =
            group_of.try_emplace({method_toml(body.method), body.reason}, groups.size());
        if (is_new) groups.push_back({body.method, {}});
        groups[entry->second].bodies.push_back(i);
    }
    return groups;
}

std::string describe(const System& system, const std::vector<std::size_t>& bodies) {
    std::string text;
    for (std::size_t i = 0; i < bodies.size();) {
        std::size_t last = i;
        while (last + 1 < bodies.size() && bodies[last + 1] == bodies[last] + 1 &&
               system.bodies[bodies[last + 1]].is_net == system.bodies[bodies[i]].is_net)
            ++last;
        if (i > 0) text += ", ";
        text += body_name(system, bodies[i]);
        if (last > i) text += " to " + body_name(system, bodies[last]);
        i = last + 1;
    }
    return text;
}

std::string describe(const System& system, const Plan& plan) {
    const std::vector<MethodGroup> groups = groups_of(plan);
    if (groups.size() == 1) return describe(groups.front().method);
    std::string text;
    for (const MethodGroup& group : groups) {
        if (!text.empty()) text += "; ";
        text += fmt::format("{} ({})", describe(group.method), describe(system, group.bodies));
    }
    return text;
}

std::string method_names(const Plan& plan) {
    std::vector<std::string_view> names;
    for (const BodyPlan& body : plan.bodies) {
        const std::string_view name = method_name(body.method);
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string method_caption(const Plan& plan, const std::optional<double>& error_bound_px) {
    std::string names = method_names(plan);
    if (!error_bound_px) return names;
    constexpr double kSmallest = 1e-3;  // with decimals
    if (*error_bound_px < kSmallest)
        return fmt::format("{}, error below {} px", names, view::power_text(*error_bound_px));
    return fmt::format("{}, error below {:g} px", names, view::rounded_up(*error_bound_px));
}

namespace pipeline {

Error explained(const Refusal& refusal, const std::string& source) {
    const std::string place = source.empty() ? "" : source + ": ";
    return {refusal.code(), fmt::format("{}{}; {}", place, refusal.what(), remedy(refusal.reason()))};
}

}  // namespace pipeline
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

}  // namespace corda
