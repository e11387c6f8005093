#pragma once

#include <cstdint>

#include "corda/core/basics.hpp"

namespace corda {

/// Calls `on_progress`, and then check_cancelled(). Throws corda::Error (kInterrupted) if it returns false.
void report_progress(const OnProgress& on_progress, std::int64_t done, std::int64_t total);

/// Work after which count_work() calls check_cancelled(): about a millisecond.
constexpr std::uint64_t kUpdatesPerCheck = 10'000;

namespace detail {
inline thread_local std::uint64_t work_since_check = 0;
inline thread_local std::uint64_t work_before_check = 0;
}  // namespace detail

/// All work that this thread has counted.
inline std::uint64_t work_done() {
    return detail::work_before_check + detail::work_since_check;
}

/// Counts work in updates of one particle, 50 to 100 ns each, and now and then calls check_cancelled().
inline void count_work(std::uint64_t updates) {
    detail::work_since_check += updates;
    if (detail::work_since_check >= kUpdatesPerCheck) check_cancelled();
}

}  // namespace corda
