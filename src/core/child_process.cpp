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
#include <fstream>
#include <iterator>
#include <system_error>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"

namespace corda {
namespace {

constexpr int kWaitMs = 100;

/// Kills what still runs when it goes out of scope.
class Child {
  public:
    explicit Child(pid_t pid) : pid_(pid) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
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

std::uint64_t address_space_bytes() {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void lower_limit(decltype(RLIMIT_AS) resource, rlim_t value) {
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = std::min(limit.rlim_cur, value);
    setrlimit(resource, &limit);
}

/// What the child does. It ends without the destructors and handlers of the process that it is a copy of.
[[noreturn]] void be_child(const std::function<std::string()>& work, const ChildLimits& limits,
                           const Descriptor& out) {
    for (const int signal : {SIGINT, SIGTERM, SIGALRM, SIGXCPU}) std::signal(signal, SIG_DFL);
    struct sigaction hangup = {};
    if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
        std::signal(SIGHUP, SIG_DFL);
    lower_limit(RLIMIT_AS, address_space_bytes() + limits.memory_bytes);
    lower_limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_s));
    lower_limit(RLIMIT_CORE, 0);
    try {
        _exit(write_all(out.get(), work()) == 0 ? EXIT_SUCCESS : EXIT_FAILURE);
    } catch (...) {
        _exit(EXIT_FAILURE);
    }
}

/// Appends what the child writes until it closes its end; false if that takes longer than `wall_s`.
bool receive(const Descriptor& in, double wall_s, const std::function<void()>& on_wait, std::string& text) {
    std::array<char, 4096> block{};
    // Waits are counted rather than read off a clock, which goes on while a shell has stopped both processes.
    for (double waited_s = 0.0; waited_s < wall_s;) {
        if (on_wait) on_wait();
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

/// What ended a child that did not finish; throws if it was not its own doing.
std::string fate(int status, const ChildLimits& limits) {
    if (!WIFSIGNALED(status)) return "crashed (status " + std::to_string(WEXITSTATUS(status)) + ")";
    const int signal = WTERMSIG(status);
    for (const int foreign : {SIGKILL, SIGTERM, SIGINT, SIGHUP}) {
        if (signal == foreign)
            throw Error(ExitCode::kTemporary, std::string("a child process was ended from outside (") +
                                                  strsignal(signal) +
                                                  "), as a system does that runs out of memory; try again");
    }
    if (signal == SIGXCPU) return "took more than " + std::to_string(limits.cpu_s) + " s of computing";
    return std::string("crashed (") + strsignal(signal) + ")";
}

}  // namespace

bool has_other_threads() {
    std::error_code failure;
    const std::filesystem::directory_iterator tasks("/proc/self/task", failure);
    return failure || std::distance(tasks, {}) > 1;
}

std::optional<ChildEnd> run_in_child(const std::function<std::string()>& work, const ChildLimits& limits,
                                     const std::function<void()>& on_wait) {
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
    ChildEnd end;
    if (!receive(in, limits.wall_s, on_wait, end.text)) {
        child.kill();
        std::array<char, 32> seconds{};
        const auto [stop, status] = std::to_chars(seconds.begin(), seconds.end(), limits.wall_s);
        end.text = "did not end within " + std::string(seconds.begin(), stop) + " s";
        return end;
    }
    const int status = child.wait();
    if (on_wait) on_wait();  // a signal that ended the child may have been meant for both
    end.finished = status == 0 && !end.text.empty();
    if (!end.finished) end.text = fate(status, limits);
    return end;
}

}  // namespace corda
