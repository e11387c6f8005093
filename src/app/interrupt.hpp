#pragma once

#include "corda/core/basics.hpp"

namespace corda::app {

/// From now on the first SIGINT, SIGTERM or, unless it is ignored, SIGHUP only asks the program to stop at a
/// point that loses no work; one that comes more than a tenth of a second later ends it at once. SIGPIPE and
/// SIGXFSZ become ordinary write errors.
void install_signal_handlers();

/// Opens /dev/null for each closed standard stream: a file opened later would get its number, and with it
/// what is meant for the stream.
void keep_standard_streams();

/// The status to exit with once a signal has asked to stop; kOk before.
[[nodiscard]] ExitCode interruption();

/// For work that has not written anything yet, and for work that says itself what it has written.
inline constexpr const char* kNothingWritten = "interrupted; nothing was written";
inline constexpr const char* kSomethingWritten = "interrupted";

/// Throws corda::Error of that status once a signal has asked to stop.
void stop_if_asked(const char* message = kNothingWritten);

/// The same as a callback for work that reports its progress.
[[nodiscard]] OnProgress stopping_if_asked(const char* message = kNothingWritten);

}  // namespace corda::app
