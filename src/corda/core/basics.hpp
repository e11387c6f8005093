#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

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

/// True if a signal ended the work. Finished parts are kept then.
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

/// Base of classes that are neither copied nor moved.
class NonCopyable {
  public:
    NonCopyable() = default;
    NonCopyable(const NonCopyable&) = delete;
    NonCopyable& operator=(const NonCopyable&) = delete;
};

/// Progress of a piece of work: `done` of `total` equal parts. Returning false stops the work cleanly.
/// May be empty.
using OnProgress = std::function<bool(std::int64_t done, std::int64_t total)>;

/// Cancellation of long work on one thread. While a scope lives, check_cancelled() calls its callback, which
/// returns false to end the work. Scopes nest; a thread that the work starts has none.
class [[nodiscard]] CancelScope : NonCopyable {
  public:
    enum class Outer { kAsked, kIgnored };

    /// An empty callback cancels nothing. `outer`: whether check_cancelled() also asks the scopes around this
    /// one.
    explicit CancelScope(std::function<bool()> goes_on, Outer outer = Outer::kAsked);
    /// A callback that returns nothing ends the work by an exception.
    template <class Callback>
    requires std::is_void_v<std::invoke_result_t<Callback&>>
    explicit CancelScope(Callback callback, Outer outer = Outer::kAsked)
        : CancelScope(std::function<bool()>([callback = std::move(callback)]() mutable {
                          callback();
                          return true;
                      }),
                      outer) {}
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

/// How a file is written.
struct OutputOptions {
    bool force = false;  ///< replace an existing file
};

}  // namespace corda
#pragma GCC visibility pop
