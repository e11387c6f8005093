#pragma once

#include "corda/core/exit_code.hpp"

namespace corda::app {

/// From now on the first SIGINT or SIGTERM only asks the program to stop where nothing is lost; one that
/// comes more than a tenth of a second later ends it at once. SIGPIPE and SIGXFSZ become ordinary
/// write errors.
void install_signal_handlers();

/// Gives a closed standard stream a file that takes nothing, so that no file that is opened later gets its
/// number and what is meant for the stream.
void keep_standard_streams();

/// The status to exit with once a signal has asked to stop; kOk before.
[[nodiscard]] ExitCode interruption();

}  // namespace corda::app
