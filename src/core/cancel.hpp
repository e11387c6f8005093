#pragma once

#include <cstdint>
#include <functional>

#include "corda/core/basics.hpp"

namespace corda {

/// Cancellation of long work on one thread. While a scope lives, check_cancelled() calls its callback, which
/// returns false to end the work. Scopes nest; a thread that the work starts has none.
class CancelScope {
  public:
    enum class Outer { kAsked, kIgnored };

    /// An empty callback cancels nothing. `outer`: whether check_cancelled() also asks the scopes around this
    /// one.
    explicit CancelScope(std::function<bool()> goes_on, Outer outer = Outer::kAsked);
    CancelScope(const CancelScope&) = delete;
    CancelScope& operator=(const CancelScope&) = delete;
    ~CancelScope();

  private:
    friend void check_cancelled();
    static void ask(const CancelScope* scope);

    std::function<bool()> goes_on_;
    const CancelScope* outer_;
    bool ignores_outer_;
};

/// Calls the callbacks of this thread's scopes, the outermost first. Throws corda::Error (kInterrupted) if
/// one returns false, and what a callback throws. Work inside a callback calls none of them.
void check_cancelled();

/// Calls `on_progress`, and then check_cancelled(). Throws corda::Error (kInterrupted) if it returns false.
void report_progress(const OnProgress& on_progress, std::int64_t done, std::int64_t total);

/// Number of callbacks of a scope or of report_progress() that this thread is inside of.
[[nodiscard]] int callback_depth();

/// Work after which count_work() calls check_cancelled(): about a millisecond.
constexpr std::uint64_t kUpdatesPerCheck = 10'000;

namespace detail {
inline thread_local std::uint64_t work_since_check = 0;
}

/// Counts work in updates of one particle, about 100 ns each, and now and then calls check_cancelled().
inline void count_work(std::uint64_t updates) {
    detail::work_since_check += updates;
    if (detail::work_since_check >= kUpdatesPerCheck) check_cancelled();
}

}  // namespace corda
