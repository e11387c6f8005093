#include "corda/report/writers.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"

namespace corda::report {
namespace {

[[noreturn]] void fail(const char* what, const std::string& program, int error_number) {
    throw Error(ExitCode::kIo, fmt::format("{} {}: {}", what, program, std::strerror(error_number)));
}

// Nameless files instead of pipes: neither side ever waits for the other to read.
FileHandle temporary_file(const std::string& program) {
    FileHandle file(std::tmpfile());
    if (!file) fail("cannot make a temporary file for", program, errno);
    return file;
}

std::string contents(const FileHandle& file) {
    std::string text;
    std::rewind(file.get());
    std::array<char, 65536> block{};
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
        text.append(block.data(), count);
    }
    return text;
}

/// Becomes the program. Between a fork of a process with threads and this, no lock may be taken.
[[noreturn]] void become(char* const* arguments, char* const* environment, const std::array<int, 3>& streams,
                         pid_t parent, int report) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // no orphan, whatever ends corda
    if (getppid() != parent) _exit(EXIT_FAILURE);
    // In a process group of its own: Ctrl-C at a terminal reaches corda alone, which still needs the picture.
    setpgid(0, 0);
    // The program starts with the default actions of signals that corda ignores.
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_DFL);
    int failure = 0;
    for (int stream = 0; stream < 3; ++stream)
        if (dup2(streams[static_cast<std::size_t>(stream)], stream) < 0) failure = errno;
    if (failure == 0) {
        execvpe(arguments[0], arguments, environment);
        failure = errno;
    }
    static_cast<void>(!write(report, &failure, sizeof failure));
    _exit(EXIT_FAILURE);
}

/// That of this process, but in UTC and English: what a program writes does not depend on where it runs.
std::vector<char*> environment_of_child(std::string& time_zone, std::string& locale) {
    std::vector<char*> result{time_zone.data(), locale.data()};
    for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
        const std::string_view text(*entry);
        if (!text.starts_with("TZ=") && !text.starts_with("LC_ALL=") && !text.starts_with("LANGUAGE="))
            result.push_back(*entry);
    }
    result.push_back(nullptr);
    return result;
}

/// Starts the program; returns its process. Throws corda::Error: kTemporary for want of processes or memory,
/// else kIo, which ends with `hint`.
pid_t start(const std::vector<std::string>& command, const std::array<int, 3>& streams,
            const std::string& hint) {
    std::vector<std::string> words = command;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::string time_zone = "TZ=UTC0";
    std::string locale = "LC_ALL=C.UTF-8";
    const std::vector<char*> environment = environment_of_child(time_zone, locale);
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("cannot make a pipe for", command.front(), errno);
    const Descriptor in(ends[0]);
    Descriptor out(ends[1]);
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child == 0) become(arguments.data(), environment.data(), streams, parent, out.get());
    int failure = child < 0 ? errno : 0;
    static_cast<void>(out.close());
    if (child > 0) {
        ssize_t bytes = 0;  // none: the program has begun, and its copy of the pipe is closed
        while ((bytes = read(in.get(), &failure, sizeof failure)) < 0 && errno == EINTR) {
        }
        if (bytes > 0) waitpid(child, nullptr, 0);
    }
    if (failure == EAGAIN || failure == ENOMEM)
        throw Error(ExitCode::kTemporary,
                    fmt::format("{} does not start: {}; run fewer processes, or raise the limits (ulimit -u, "
                                "ulimit -v)",
                                command.front(), std::strerror(failure)));
    if (failure != 0)
        throw Error(ExitCode::kIo,
                    fmt::format("{} does not start: {}; {}", command.front(), std::strerror(failure), hint));
    return child;
}

int wait_for(pid_t child, const std::string& program) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) fail("cannot wait for", program, errno);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

ChildResult run_child(const std::vector<std::string>& command, const std::string& input,
                      const std::string& hint) {
    const std::string& program = command.front();
    const FileHandle in = temporary_file(program);
    const FileHandle out = temporary_file(program);
    const FileHandle err = temporary_file(program);
    if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() || std::fflush(in.get()) != 0) {
        fail("cannot write the input of", program, errno);
    }
    std::rewind(in.get());
    const pid_t child = start(command, {::fileno(in.get()), ::fileno(out.get()), ::fileno(err.get())}, hint);
    ChildResult result;
    result.exit_code = wait_for(child, program);
    result.out = contents(out);
    result.err = contents(err);
    return result;
}

}  // namespace corda::report
