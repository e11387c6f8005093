#include "corda/pipeline/describe.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace corda {
namespace {

struct InWords {
    std::string operator()(const ExactDef& def) const {
        return fmt::format("exact at tolerance {:.3g}", def.tolerance);
    }
    std::string operator()(const RattleDef& def) const {
        const std::string step = def.step_s ? fmt::format(", step {} s", *def.step_s) : "";
        return fmt::format("rattle of order {}", def.order) + step;
    }
    std::string operator()(const RelaxationDef& def) const {
        const std::string step = def.step_s ? fmt::format(", step {} s", *def.step_s) : "";
        return fmt::format("relaxation with {} sweep{}", def.sweeps, def.sweeps == 1 ? "" : "s") + step;
    }
};

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
            return "set method = \"rattle\", or let the bars stretch by a compliance";
        case Reason::kRigidStringGraph:
            return "open it, or let it stretch by a compliance";
        case Reason::kRigidString:
            return "use method exact, or let the string stretch by a compliance";
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
            return "leave out bars that others imply (diagonals, bars to second and further neighbours), let "
                   "what is straight between pins sag, or use method relaxation";
        case Reason::kMaterial:
            return "remove compliance, string and bending, or use method exact";
    }
    return "";
}

}  // namespace

std::string describe(const System& system) {
    const auto nets = std::count_if(system.bodies.begin(), system.bodies.end(),
                                    [](const Body& body) { return body.is_net; });
    const std::string what = nets == 0 ? "" : fmt::format("{} net{}: ", nets, nets == 1 ? "" : "s");
    return what + fmt::format("{} particles, {} bars ({} real)", system.particle_count(), system.bars.size(),
                              system.link_count());
}

std::string describe(const MethodDef& method) {
    return std::visit(InWords{}, method);
}

std::string describe(const Plan& plan) {
    switch (plan.reason) {
        case PlanReason::kNamed:
            return fmt::format("the scene asks for {}", method_name(plan.method));
        case PlanReason::kExact:
            return "exact moves every body of this scene";
        case PlanReason::kGraph:
            return "rattle keeps the bars of closed ropes and nets at their lengths";
        case PlanReason::kDependent:
            return "the bars depend on each other (diagonals, or a row straight between pins), so that no "
                   "method can tell the true motion; relaxation runs it, without a bound of the error";
        case PlanReason::kCollapsing:
            return "bars of a closed rope or a net come into line during the motion: their tensions are then "
                   "undetermined and rattle stops; relaxation runs it, without a bound of the error";
    }
    return "";
}

namespace pipeline {

Error explained(const Refusal& refusal, const std::string& source) {
    const std::string place = source.empty() ? "" : source + ": ";
    return {refusal.code(), fmt::format("{}{}; {}", place, refusal.what(), remedy(refusal.reason()))};
}

}  // namespace pipeline
}  // namespace corda
