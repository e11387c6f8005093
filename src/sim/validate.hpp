#pragma once

#include <span>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/sim/defs.hpp"

namespace corda {

/// Thrown by `sim` for a definition with a field outside its range and for a system that a method cannot
/// run: an Error of code kInvalidScene. The message gives the physical reason; pipeline adds the name of the
/// scene and, chosen by `reason()`, the keys of the scene file that would help.
class Refusal : public Error {
  public:
    enum class Reason {
        kDefinition,          ///< a field is not what its declaration says
        kBarWithoutLength,    ///< all but `relaxation`: a bar whose particles coincide
        kImaginaryBars,       ///< `exact`: bars of reach > 1
        kRigidGraph,          ///< `exact`: rigid bars that do not form an open chain
        kRigidStringGraph,    ///< `exact`: a string of rigid links that does not form an open chain
        kRigidString,         ///< `rattle`: a string of rigid links
        kRigidBendingString,  ///< `exact`: a string of rigid links that resists bending
        kStretchedString,     ///< `exact`: a rigid link of a string longer at the start than its rest length
        kUndecidedString,     ///< `exact`: the start does not determine which links of a string are taut
        kTautBetweenPins,     ///< a rigid rope that is straight between two pins
        kDependentBars,       ///< `rattle`: the lengths of rigid bars depend on each other
        kMaterial,            ///< `relaxation`: compliance, a string or bending
        kUnknownTensions,     ///< tensions are requested that the method does not know
    };

    Refusal(Reason reason, const std::string& problem)
        : Error(ExitCode::kInvalidScene, problem), reason_(reason) {}

    [[nodiscard]] Reason reason() const noexcept { return reason_; }

  private:
    Reason reason_;
};

namespace sim {

// The reader of scene files checks what it fills in; these check definitions that code has filled in. Each
// throws corda::Refusal for a field outside the range of its declaration. For methods see solver.hpp.

void validate(std::span<const RopeDef> ropes, std::span<const NetDef> nets);
void validate(const WorldDef& world);

}  // namespace sim
}  // namespace corda
