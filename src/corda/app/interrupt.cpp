#include "interrupt.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"

namespace corda::app {
namespace {

/// timeout(1) signals its child and then their whole process group, which is to count once.
constexpr std::int64_t kSameWishNs = 100'000'000;

/// Time from the first signal until the process ends, whatever its threads wait for. A sanitized program is
/// ten times slower.
#ifdef CORDA_SANITIZE
constexpr std::int64_t kMaxNs = 20'000'000'000;
#else
constexpr std::int64_t kMaxNs = 800'000'000;
#endif
constexpr std::int64_t kTickNs = 100'000'000;
/// The same for a process that uses a processor: on a busy machine it may need this long to notice the
/// signal. A process that waits for a driver uses less processor time than kMinWorkNs.
constexpr std::int64_t kMaxWorkNs = 3 * kMaxNs;
constexpr std::int64_t kMinWorkNs = 100'000'000;
/// The same while results are flushed to disk and get their names.
constexpr std::int64_t kMaxSavingNs = 30'000'000'000;

constexpr std::array kRequests{SIGHUP, SIGINT, SIGTERM};
constexpr int kSignalBase = 128;  // a shell's exit code of a process that a signal ended, without its number

/// Messages of a process that the watchdog ends.
struct Words {
    std::string text;  ///< on standard error
    std::string json;  ///< on standard output; empty without --json
};

/// The words for each signal of kRequests, made before one comes: a handler can only write them.
using LastWords = std::array<Words, kRequests.size()>;

std::atomic<int> asked_to_stop_by{0};
std::atomic<std::int64_t> asked_at_ns{0};
std::atomic<std::int64_t> asked_at_processor_ns{0};
std::atomic<int> exit_code_of_ended_work{-1};
std::atomic<const char*> interruption_message{kNothingWritten};
std::atomic<const LastWords*> last_words{nullptr};
bool reports_json = false;
bool is_on_terminal = false;  // standard error
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<const LastWords*>::is_always_lock_free,
              "a signal handler may use nothing else");

std::int64_t ns_of(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::int64_t now_ns() {
    return ns_of(CLOCK_MONOTONIC);
}

/// Of all threads.
std::int64_t processor_ns() {
    return ns_of(CLOCK_PROCESS_CPUTIME_ID);
}

Words words_for(int signal, const std::string& kept) {
    const std::string message = fmt::format(
        "interrupted (SIG{}); the work, a driver, an encoder or another program did not stop in time{}",
        sigabbrev_np(signal), kept);
    Words words{fmt::format("{}corda: error: {}\n", is_on_terminal ? "\r\x1b[K" : "", message), {}};
    if (reports_json) {
        const nlohmann::json error{{"code", kSignalBase + signal}, {"message", message}};
        words.json = nlohmann::json{{"schema", 1}, {"error", error}}.dump(2) + "\n";
    }
    return words;
}

void make_last_words(const std::string& kept) {
    auto words = std::make_unique<LastWords>();
    for (std::size_t i = 0; i < kRequests.size(); ++i) (*words)[i] = words_for(kRequests[i], kept);
    static std::vector<std::unique_ptr<const LastWords>> all;  // a handler may be reading earlier ones
    last_words = all.emplace_back(std::move(words)).get();
}

/// Writes as much as goes without waiting: a full pipe must not hold up the end.
void write_at_once(int descriptor, std::string_view text) {
    pollfd ready{descriptor, POLLOUT, 0};
    if (poll(&ready, 1, 0) == 1) static_cast<void>(!write(descriptor, text.data(), text.size()));
}

/// Ends the process from a signal handler. Not by the signal's default action, which the first process of a
/// container does not have.
[[noreturn]] void end_process(int signal, bool with_words) {
    const LastWords* const last = last_words;
    const int ended = exit_code_of_ended_work;
    if (with_words && last != nullptr && ended < 0) {
        for (std::size_t i = 0; i < kRequests.size(); ++i) {
            if (kRequests[i] != signal) continue;
            write_at_once(STDERR_FILENO, (*last)[i].text);
            write_at_once(STDOUT_FILENO, (*last)[i].json);
        }
    }
    if (!with_words && is_on_terminal) write_at_once(STDERR_FILENO, "\n");  // ends the line of a bar
    _exit(ended < 0 ? kSignalBase + signal : ended);
}

/// True if the process has not ended in the time that it has after the first signal.
bool is_overdue(std::int64_t waited_ns) {
    if (waited_ns < kMaxNs) return false;
    if (Saving::is_active()) return waited_ns >= kMaxSavingNs;
    const std::int64_t worked_ns = processor_ns() - asked_at_processor_ns;
    return worked_ns < kMinWorkNs || worked_ns >= kMaxNs || waited_ns >= kMaxWorkNs;
}

/// A call that began to wait just after the signal does not know of it: from now on SIGALRM breaks off every
/// one that takes long, and ends the process if none of that helps.
void begin_to_tick() {
    const itimerval often{{0, kTickNs / 1000}, {0, kTickNs / 1000}};
    setitimer(ITIMER_REAL, &often, nullptr);
}

void on_signal(int signal) {
    const int kept_errno = errno;
    const std::int64_t at_ns = now_ns();
    std::int64_t first_ns = 0;
    if (signal == SIGALRM) {
        first_ns = asked_at_ns;
        if (first_ns != 0 && is_overdue(at_ns - first_ns)) end_process(asked_to_stop_by, true);
    } else if (asked_at_ns.compare_exchange_strong(first_ns, at_ns)) {
        asked_to_stop_by = signal;
        asked_at_processor_ns = processor_ns();
        begin_to_tick();
    } else if (at_ns - first_ns > kSameWishNs) {
        end_process(signal, false);
    }
    errno = kept_errno;
}

}  // namespace

void install_signal_handlers(bool json) {
    reports_json = json;
    is_on_terminal = isatty(STDERR_FILENO) == 1;
    make_last_words("");
    for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGALRM}) {
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

void note_end_of_work(int exit_code) {
    std::fflush(stdout);
    std::fflush(stderr);
    exit_code_of_ended_work = exit_code;
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
