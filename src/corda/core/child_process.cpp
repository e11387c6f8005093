#include "corda/core/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <new>
#include <system_error>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"

namespace corda {
namespace {

constexpr int kWaitMs = 100;
// The first byte of a child's answer.
constexpr char kResult = '+';
constexpr char kError = '-';
constexpr char kNoMemory = '!';

/// Kills what still runs when it goes out of scope.
class Child : NonCopyable {
  public:
    explicit Child(pid_t pid) : pid_(pid) {}
    ~Child() {
        if (pid_ != 0) kill();
    }

    /// Waits for the end, and returns waitpid's status.
    int wait() {
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        pid_ = 0;
        return status;
    }

    void kill() {
        ::kill(pid_, SIGKILL);
        wait();
    }

  private:
    pid_t pid_;
};

void lower_limit(decltype(RLIMIT_AS) resource, rlim_t value) {
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = std::min(limit.rlim_cur, value);
    setrlimit(resource, &limit);
}

/// Runs the work in the child, which ends without the destructors and handlers of the process that it is a
/// copy of.
[[noreturn]] void be_child(const std::function<std::string()>& work, const ChildLimits& limits,
                           const Descriptor& out) {
    const CancelScope shield({}, CancelScope::Outer::kIgnored);
    for (const int signal : {SIGINT, SIGTERM, SIGALRM, SIGXCPU}) std::signal(signal, SIG_DFL);
    struct sigaction hangup = {};
    if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
        std::signal(SIGHUP, SIG_DFL);
    lower_limit(RLIMIT_AS, address_space_bytes() + limits.memory_bytes);
    lower_limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_s));
    lower_limit(RLIMIT_CORE, 0);
    std::string answer;
    try {
        answer = kResult + work();
    } catch (const Error& error) {
        answer = kError + std::to_string(static_cast<int>(error.code())) + ' ' + error.what();
    } catch (const std::bad_alloc&) {
        answer = kNoMemory;
    } catch (...) {
        _exit(EXIT_FAILURE);
    }
    _exit(write_all(out.get(), answer) == 0 ? EXIT_SUCCESS : EXIT_FAILURE);
}

/// The end of a child that has sent `answer`. Throws its corda::Error.
ChildEnd end_of(const std::string& answer) {
    if (answer.front() == kResult) return {ChildEnd::Outcome::kFinished, answer.substr(1)};
    if (answer.front() == kNoMemory)
        return {ChildEnd::Outcome::kOutOfMemory, "asks for more memory than it may have"};
    const std::size_t space = answer.find(' ');
    throw Error(static_cast<ExitCode>(std::stoi(answer.substr(1, space - 1))), answer.substr(space + 1));
}

/// Appends what the child writes until it closes its end; false if that takes longer than `wall_s`.
bool receive(const Descriptor& in, double wall_s, std::string& text) {
    std::array<char, 4096> block{};
    // Waits are counted instead of read off a clock, which runs while a shell has stopped both processes.
    for (double waited_s = 0.0; waited_s < wall_s;) {
        check_cancelled();
        pollfd ready{in.get(), POLLIN, 0};
        const int count = poll(&ready, 1, kWaitMs);
        if (count == 0) waited_s += kWaitMs / 1000.0;
        if (count <= 0) continue;
        const ssize_t bytes = read(in.get(), block.data(), block.size());
        if (bytes == 0) return true;
        if (bytes > 0) text.append(block.data(), static_cast<std::size_t>(bytes));
    }
    return false;
}

/// The end of a child that has sent no answer; throws if something else ended it.
ChildEnd end_without_answer(int status, const ChildLimits& limits) {
    using Outcome = ChildEnd::Outcome;
    if (!WIFSIGNALED(status))
        return {Outcome::kCrashed, "crashed (status " + std::to_string(WEXITSTATUS(status)) + ")"};
    const int signal = WTERMSIG(status);
    for (const int foreign : {SIGKILL, SIGTERM, SIGINT, SIGHUP}) {
        if (signal == foreign)
            throw Error(ExitCode::kTemporary, std::string("a child process was ended from outside (") +
                                                  strsignal(signal) +
                                                  "), as a system does that runs out of memory; try again");
    }
    if (signal == SIGXCPU)
        return {Outcome::kTimedOut, "took more than " + std::to_string(limits.cpu_s) + " s of computing"};
    return {Outcome::kCrashed, std::string("crashed (") + strsignal(signal) + ")"};
}

}  // namespace

bool has_other_threads() {
    std::error_code failure;
    const std::filesystem::directory_iterator tasks("/proc/self/task", failure);
    return failure || std::distance(tasks, {}) > 1;
}

std::optional<ChildEnd> run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail_file("make a pipe for", "a child process", errno);
    const Descriptor in(ends[0]);
    Descriptor out(ends[1]);
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid < 0) return std::nullopt;
    if (pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(EXIT_FAILURE);
        be_child(work, limits, out);
    }
    Child child(pid);
    static_cast<void>(out.close());
    std::string answer;
    if (!receive(in, limits.wall_s, answer)) {
        child.kill();
        std::array<char, 32> seconds{};
        const auto [stop, status] = std::to_chars(seconds.begin(), seconds.end(), limits.wall_s);
        return ChildEnd{ChildEnd::Outcome::kTimedOut,
                        "did not end within " + std::string(seconds.begin(), stop) + " s"};
    }
    const int status = child.wait();
    check_cancelled();  // a signal to the process group may have ended the child
    return status == 0 && !answer.empty() ? end_of(answer) : end_without_answer(status, limits);
}

}  // namespace corda
