#pragma once

#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"

namespace corda::app {

/// From now on the first SIGINT, SIGTERM or, unless it is ignored, SIGHUP only asks the program to stop at a
/// point that loses no work. If it has not ended 0.8 s later, because a driver or an encoder does not return,
/// or if it still works after 0.8 s of processor time, or 2.4 s in all, the handler says so (with `json` on
/// standard output too) and ends the process with the exit code of the interruption; not while a Saving
/// exists, for half a minute. A second signal, more than a tenth of a second after the first, ends it at
/// once. SIGPIPE and SIGXFSZ become ordinary write errors.
void install_signal_handlers(bool json);

/// To be called when all output and messages are written. If destructors or exit handlers of libraries do not
/// return after a signal, the process then ends with this code and without a message.
void note_end_of_work(int exit_code);

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
