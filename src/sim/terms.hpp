#pragma once

namespace corda::sim {

/// Whether the terms that a rope may do without (compliance, strings, bending) are compiled in. Every branch
/// on whether a scene names one begins with this constant. It is false only in the second copy of the
/// simulation that benchmark/absent_terms.cpp compares with: there the branches are gone, and the difference
/// in time is what absent terms cost.
#ifdef CORDA_PLAIN_ROPES
inline constexpr bool kTermsCompiledIn = false;
#else
inline constexpr bool kTermsCompiledIn = true;
#endif

}  // namespace corda::sim
