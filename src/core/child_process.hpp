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

/// How work in a child process ended.
struct ChildEnd {
    bool finished = false;
    std::string text;  ///< what the work returned, or what ended it: "crashed (Aborted)"
};

/// Whether this process has more than one thread.
[[nodiscard]] bool has_other_threads();

/// Runs `work` in a copy of this process within `limits`, and waits for it; std::nullopt if the system starts
/// no further process. `work` returns at least one character; if it throws, that is a crash. `on_wait` is
/// called at least ten times a second, and may throw: then the child is killed first. No child outlives the
/// call, or this thread.
///
/// The child is a fork without an exec: a lock that another thread of this process holds stays locked in the
/// child, which then waits until `limits` end it. So there should be no other thread (has_other_threads()).
/// Throws corda::Error (kTemporary) if the child was killed by someone else.
[[nodiscard]] std::optional<ChildEnd> run_in_child(const std::function<std::string()>& work,
                                                   const ChildLimits& limits,
                                                   const std::function<void()>& on_wait = {});

}  // namespace corda
