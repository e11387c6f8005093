#pragma once

#include "corda/core/cancel.hpp"

namespace corda::test {

/// Cancels the work on this thread at the check after `checks` of them.
[[nodiscard]] inline CancelScope cancel_after(std::int64_t checks) {
    return CancelScope([left = checks]() mutable { return left-- > 0; });
}

}  // namespace corda::test
