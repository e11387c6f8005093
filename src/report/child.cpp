#include "corda/report/child.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

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

/// posix_spawn's file actions and attributes.
struct SpawnSetup {
    posix_spawn_file_actions_t actions{};
    posix_spawnattr_t attributes{};

    SpawnSetup() {
        posix_spawn_file_actions_init(&actions);
        posix_spawnattr_init(&attributes);
        // corda ignores SIGPIPE, and an ignored signal stays ignored in a child.
        sigset_t defaults;
        sigemptyset(&defaults);
        sigaddset(&defaults, SIGPIPE);
        posix_spawnattr_setsigdefault(&attributes, &defaults);
        // In a process group of its own (number 0): Ctrl-C at a terminal asks corda alone, which still needs
        // what the child draws.
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    }
    SpawnSetup(const SpawnSetup&) = delete;
    SpawnSetup& operator=(const SpawnSetup&) = delete;
    ~SpawnSetup() {
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
    }
};

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
    SpawnSetup setup;
    posix_spawn_file_actions_adddup2(&setup.actions, ::fileno(in.get()), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&setup.actions, ::fileno(out.get()), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&setup.actions, ::fileno(err.get()), STDERR_FILENO);
    std::vector<std::string> words = command;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int status =
        posix_spawnp(&child, program.c_str(), &setup.actions, &setup.attributes, arguments.data(), environ);
    if (status != 0) {
        throw Error(ExitCode::kIo,
                    fmt::format("{} does not start: {}; {}", program, std::strerror(status), hint));
    }
    ChildResult result;
    result.exit_code = wait_for(child, program);
    result.out = contents(out);
    result.err = contents(err);
    return result;
}

}  // namespace corda::report
