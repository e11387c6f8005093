#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace corda {

/// How much a child process may take.
struct ChildLimits {
    std::uint64_t memory_bytes = 0;  ///< of address space, in addition to what this process has
    std::int64_t cpu_s = 0;          ///< of all its threads together
    double wall_s = 0.0;             ///< not counting the time for which this process is stopped
};

/// The end of work in a child process.
struct ChildEnd {
    enum class Outcome { kFinished, kOutOfMemory, kTimedOut, kCrashed };

    Outcome outcome = Outcome::kCrashed;
    std::string text;  ///< the result of the work, or the reason of its end: "crashed (Aborted)"

    [[nodiscard]] bool finished() const { return outcome == Outcome::kFinished; }
};

/// Whether this process has more than one thread.
[[nodiscard]] bool has_other_threads();

/// Runs `work` in a copy of this process within `limits`, and waits for it; std::nullopt if the system starts
/// no further process. A corda::Error that `work` throws is thrown here. Calls check_cancelled() at
/// least ten times a second; if that throws, the child is killed first. No child outlives the call, or this
/// thread.
///
/// The child is a fork without an exec: a lock that another thread of this process holds stays locked in the
/// child, which then waits until `limits` end it. So there should be no other thread (has_other_threads()).
/// Throws corda::Error (kTemporary) if the child was killed by someone else.
[[nodiscard]] std::optional<ChildEnd> run_in_child(const std::function<std::string()>& work,
                                                   const ChildLimits& limits);

}  // namespace corda
