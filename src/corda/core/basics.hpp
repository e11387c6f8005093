#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

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

/// A value of a file, or of a setting in its place.
struct Place {
    std::string source;      ///< the file, or "--set world.drag=-1"; may be empty
    std::size_t line = 0;    ///< from 1; 0: not known
    std::size_t column = 0;  ///< from 1, in characters
    std::string key;         ///< dotted: "rope[0].mass"; may be empty

    /// "swing.toml:12:5: rope[0].mass"
    [[nodiscard]] std::string text() const;
};

/// One thing that is wrong, as fields until it is printed.
struct Problem {
    Place place;             ///< may be empty
    std::string what;        ///< with the value: "0 is not > 0"
    std::string remedy;      ///< "give a number > 0"; may be empty
    std::string value = {};  ///< as TOML has it, perhaps cut off: "0"; empty: none, or a list or table

    /// "swing.toml:12:5: rope[0].mass: 0 is not > 0; give a number > 0"
    [[nodiscard]] std::string text() const;
};

/// Bad input or a bad environment. Its problems say what failed, the value, the library's own reason and one
/// hint, and what() has one of them per line; `code` is the exit status of the program. A programmer's error
/// is an assert instead, and a physical outcome is a returned status.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : Error(code, Problem{{}, message, {}}) {}
    Error(ExitCode code, Problem problem) : Error(code, std::vector{std::move(problem)}) {}
    Error(ExitCode code, std::vector<Problem> problems);

    [[nodiscard]] ExitCode code() const noexcept { return code_; }
    /// At least one.
    [[nodiscard]] const std::vector<Problem>& problems() const noexcept { return *problems_; }

  private:
    ExitCode code_;
    std::shared_ptr<const std::vector<Problem>> problems_;  // shared, because copies of errors must not throw
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
