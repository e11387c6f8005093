#include "interrupt.hpp"

#include <csignal>

namespace corda::app {
namespace {

volatile std::sig_atomic_t asked_to_stop_by = 0;

void ask_to_stop(int signal) {
    asked_to_stop_by = signal;
}

}  // namespace

void install_signal_handlers() {
    for (const int signal : {SIGINT, SIGTERM}) {
        struct sigaction action = {};
        action.sa_handler = ask_to_stop;
        action.sa_flags =
            static_cast<int>(SA_RESETHAND | SA_RESTART);  // the second signal has its default effect
        sigemptyset(&action.sa_mask);
        sigaction(signal, &action, nullptr);
    }
    std::signal(SIGPIPE, SIG_IGN);
}

ExitCode interruption() {
    switch (asked_to_stop_by) {
        case SIGINT:
            return ExitCode::kInterrupted;
        case SIGTERM:
            return ExitCode::kTerminated;
        default:
            return ExitCode::kOk;
    }
}

}  // namespace corda::app
