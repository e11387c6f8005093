#pragma once

namespace corda {

/// The natural logarithm of a positive normal number, to within a few roundings of 1 + |ln x|; exactly 0
/// for 1. Like std::log, but computed from +, -, * and / alone, whose results IEEE 754 fixes: C libraries
/// differ in the last bit.
[[nodiscard]] double natural_log(double x);

/// e^x for |x| < 700, to within some 1e-15 of it; exactly 1 for 0. Like std::exp, for the same reason.
[[nodiscard]] double exponential(double x);

}  // namespace corda
