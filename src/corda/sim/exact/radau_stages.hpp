#pragma once

#include "corda/sim/exact/radau_chain.hpp"

// The equations of the stages of a step of a RadauChain: section 12 of src/corda/sim/exact/README.md.
namespace corda::sim {

/// Continues the polynomials of the last step to the stages of this one.
void predict(RadauChain& chain);

/// Factorises Newton's matrix at the stages.
void factorise(RadauChain& chain);

/// Corrects the stages once, with that matrix. Returns the largest displacement of a particle in m at the end
/// of the step, in which angles count, too; infinite if the stages cannot be used.
[[nodiscard]] double correct(RadauChain& chain);

/// Estimated error of the step in m.
[[nodiscard]] double error_m(RadauChain& chain);

}  // namespace corda::sim
