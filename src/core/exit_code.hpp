#pragma once

#include <array>
#include <string_view>

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
    kInterrupted = 130,
    kTerminated = 143,
};

/// One row of the table that `corda --help` prints.
struct ExitCodeText {
    ExitCode code;
    std::string_view meaning;
};

inline constexpr std::array<ExitCodeText, 12> kExitCodes{{
    {ExitCode::kOk, "success"},
    {ExitCode::kInternal, "internal error: a bug in corda"},
    {ExitCode::kUsage, "usage: unknown command, flag or value"},
    {ExitCode::kInvalidScene, "invalid scene file"},
    {ExitCode::kNoGl, "no usable OpenGL"},
    {ExitCode::kEncoder, "codec missing or encoder failed"},
    {ExitCode::kIo, "input/output error, disk full, or output exists (see --force)"},
    {ExitCode::kMismatch, "compare or verify found a difference or a problem"},
    {ExitCode::kDiverged, "the simulation diverged"},
    {ExitCode::kTemporary, "temporary failure: try again"},
    {ExitCode::kInterrupted, "interrupted (SIGINT); what was done is kept"},
    {ExitCode::kTerminated, "terminated (SIGTERM); what was done is kept"},
}};

}  // namespace corda
