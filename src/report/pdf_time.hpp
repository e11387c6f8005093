#pragma once

#include <string>

namespace corda::report {

/// Puts a fixed time in the place of that at which cairo made a PDF, so that it has the same bytes at any
/// time. What cairo 1.18 compresses, the date among it, becomes plain: compressed, its length would depend on
/// the date.
void forget_time(std::string& pdf);

}  // namespace corda::report
