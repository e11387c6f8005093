#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

#pragma GCC visibility push(default)
namespace corda {

/// The exit statuses of the `corda` program. The numbers are a contract: scripts test for them.
enum class ExitCode : int {
    kOk = 0,
    kInternal = 1,
    kUsage = 2,
    kInvalidScene = 3,
    kNoGl = 4,
    kEncoder = 5,
    kIo = 6,
    kMismatch = 7,
    kDiverged = 8,
    kTemporary = 75,
    kHungUp = 129,
    kInterrupted = 130,
    kTerminated = 143,
};

/// Whether it is that of work which a signal ended and which keeps what was done.
[[nodiscard]] constexpr bool is_interruption(ExitCode code) {
    return code == ExitCode::kHungUp || code == ExitCode::kInterrupted || code == ExitCode::kTerminated;
}

/// Bad input or a bad environment. The message says what failed, the value, the library's own reason and one
/// hint; `code` is the exit status of the program. A programmer's error is an assert instead, and a physical
/// outcome is a returned status.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

/// Progress of a piece of work: `done` of `total` equal parts. Returning false stops the work cleanly.
/// May be empty.
using OnProgress = std::function<bool(std::int64_t done, std::int64_t total)>;

/// Asked again and again by work that reports no progress: whether it is to go on. Returning false stops it.
/// May be empty.
using GoesOn = std::function<bool()>;

/// Throws corda::Error (kInterrupted) for the answer false of an OnProgress or a GoesOn.
inline void require_going_on(bool goes_on) {
    if (!goes_on) throw Error(ExitCode::kInterrupted, "stopped by the caller");
}

/// Calls `on_progress`. Throws corda::Error (kInterrupted) if it asks to stop.
inline void report_progress(const OnProgress& on_progress, std::int64_t done, std::int64_t total) {
    if (on_progress) require_going_on(on_progress(done, total));
}

/// How a file is written.
struct OutputOptions {
    bool force = false;        ///< replace an existing file, and keep its permissions
    OnProgress on_progress{};  ///< asked often by what takes long; false ends it with kInterrupted
};

}  // namespace corda
#pragma GCC visibility pop
