#include "interrupt.hpp"

#include <fcntl.h>
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
constexpr int kSignalBase = 128;  // a shell's exit code of a process that a signal ended, without its number

std::atomic<int> asked_to_stop_by{0};
std::atomic<std::int64_t> asked_at_ns{0};
std::atomic<const char*> interruption_message{kNothingWritten};
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal handler may use nothing else");

void on_signal(int signal) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t at_ns = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
    std::int64_t first_ns = 0;
    if (asked_at_ns.compare_exchange_strong(first_ns, at_ns))
        asked_to_stop_by = signal;
    else if (at_ns - first_ns > kSameWishNs)
        _exit(kSignalBase + signal);  // the default action does not end the first process of a container
}

}  // namespace

void install_signal_handlers() {
    for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
        struct sigaction before = {};
        // nohup(1) has it ignored, so that the work survives its terminal.
        if (signal == SIGHUP && sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN)
            continue;
        struct sigaction action = {};  // without SA_RESTART: opening a pipe without a writer must end
        action.sa_handler = on_signal;
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
    return asked_to_stop_by == 0 ? ExitCode::kOk : static_cast<ExitCode>(kSignalBase + asked_to_stop_by);
}

void set_interruption_message(const char* message) {
    interruption_message = message;
}

void stop_if_asked() {
    if (interruption() != ExitCode::kOk) throw Error(interruption(), interruption_message.load());
}

OnProgress stopping_if_asked() {
    return [](std::int64_t, std::int64_t) {
        stop_if_asked();
        return true;
    };
}

}  // namespace corda::app
