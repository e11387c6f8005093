#pragma once

#include <cerrno>

#include "corda/core/basics.hpp"

namespace corda {

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
