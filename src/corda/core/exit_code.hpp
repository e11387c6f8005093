#pragma once

#include <cerrno>

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

/// The exit code for an errno value: kIo for a full or failing disk, kTemporary for too many open files or no
/// memory, `otherwise` for others.
[[nodiscard]] inline ExitCode exit_code_of_errno(int error_number, ExitCode otherwise = ExitCode::kIo) {
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
        case EIO:
            return ExitCode::kIo;
        case EMFILE:
        case ENFILE:
        case ENOMEM:
            return ExitCode::kTemporary;
        default:
            return otherwise;
    }
}

}  // namespace corda
#pragma GCC visibility pop
