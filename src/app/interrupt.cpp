#include "interrupt.hpp"

#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

#include "corda/core/basics.hpp"

namespace corda::app {
namespace {

/// timeout(1) signals its child and then their whole process group, which is to count once.
constexpr std::int64_t kSameWishNs = 100'000'000;

std::atomic<int> asked_to_stop_by{0};
std::atomic<std::int64_t> asked_at_ns{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may use nothing else");

std::int64_t now_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// A call that began to wait just after the signal does not know of it: from now on SIGALRM breaks off every
/// one that takes long.
void break_off_waiting() {
    const itimerval often{{0, 100'000}, {0, 100'000}};
    setitimer(ITIMER_REAL, &often, nullptr);
}

void ask_to_stop(int signal) {
    if (signal == SIGALRM) return;
    const std::int64_t at_ns = now_ns();
    std::int64_t first_ns = 0;
    if (asked_at_ns.compare_exchange_strong(first_ns, at_ns)) {
        asked_to_stop_by = signal;
        break_off_waiting();
    } else if (at_ns - first_ns > kSameWishNs) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
}

}  // namespace

void install_signal_handlers() {
    for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGALRM}) {
        struct sigaction before = {};
        // nohup(1) has it ignored, so that the work survives its terminal.
        if (signal == SIGHUP && sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN)
            continue;
        struct sigaction action = {};  // without SA_RESTART: opening a pipe that nobody writes to must end
        action.sa_handler = ask_to_stop;
        sigemptyset(&action.sa_mask);
        sigaction(signal, &action, nullptr);
    }
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

void keep_standard_streams() {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
        // The lowest number that is free: this stream's. For reading: a write fails, as it did.
        if (fcntl(stream, F_GETFD) == -1) static_cast<void>(open("/dev/null", O_RDONLY));
    }
}

ExitCode interruption() {
    switch (asked_to_stop_by) {
        case SIGHUP:
            return ExitCode::kHungUp;
        case SIGINT:
            return ExitCode::kInterrupted;
        case SIGTERM:
            return ExitCode::kTerminated;
        default:
            return ExitCode::kOk;
    }
}

void stop_if_asked(const char* message) {
    if (interruption() != ExitCode::kOk) throw Error(interruption(), message);
}

OnProgress stopping_if_asked(const char* message) {
    return [message](std::int64_t, std::int64_t) {
        stop_if_asked(message);
        return true;
    };
}

}  // namespace corda::app
