#pragma once

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"

namespace corda::app {

/// From now on the first SIGINT, SIGTERM or, unless it is ignored, SIGHUP interrupts a waiting call, and
/// otherwise only asks the program to stop at a point that loses no work. A second signal, more than a tenth
/// of a second after the first, ends it at once. SIGPIPE and SIGXFSZ become ordinary write errors.
void install_signal_handlers();

/// Opens /dev/null for each closed standard stream: a file opened later would get its number, and with it the
/// text for the stream.
void keep_standard_streams();

/// The status to exit with once a signal has asked to stop; kOk before.
[[nodiscard]] ExitCode interruption();

/// For work that has not written anything yet, and for work that says itself what it has written.
inline constexpr const char* kNothingWritten = "interrupted; nothing was written";
inline constexpr const char* kSomethingWritten = "interrupted";

/// Sets the message of stop_if_asked(), kNothingWritten at first.
void set_interruption_message(const char* message);

/// Throws corda::Error of that status once a signal has asked to stop. check_cancelled() on the main thread
/// calls it; work on other threads takes stopping_if_asked().
void stop_if_asked();
[[nodiscard]] OnProgress stopping_if_asked();

}  // namespace corda::app
