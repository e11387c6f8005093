#pragma once

#include <array>
#include <string_view>

#include "corda/core/basics.hpp"

namespace corda::app {

/// One row of the table that `corda --help` and the manual page print.
struct ExitCodeText {
    ExitCode code;
    std::string_view meaning;
};

inline constexpr std::array<ExitCodeText, 13> kExitCodes{{
    {ExitCode::kOk, "success"},
    {ExitCode::kInternal, "internal error: a bug in corda"},
    {ExitCode::kUsage, "usage: unknown command, flag or value"},
    {ExitCode::kInvalidScene, "invalid scene: its file, or what --set makes of it"},
    {ExitCode::kNoGl, "no usable OpenGL"},
    {ExitCode::kEncoder, "codec missing or encoder failed"},
    {ExitCode::kIo, "input/output error, disk full, or output exists (see --force)"},
    {ExitCode::kMismatch, "compare, golden or verify found a difference or a problem"},
    {ExitCode::kDiverged, "the simulation diverged"},
    {ExitCode::kTemporary, "out of memory, or another temporary failure: try again"},
    {ExitCode::kHungUp, "hung up (SIGHUP): the terminal closed; what was done is kept"},
    {ExitCode::kInterrupted, "interrupted (SIGINT); what was done is kept"},
    {ExitCode::kTerminated, "terminated (SIGTERM); what was done is kept"},
}};

}  // namespace corda::app
