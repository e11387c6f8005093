#include "corda/scene/read_file.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/schema.hpp"

namespace corda::scene {
namespace {

[[noreturn]] void fail_io(const std::string& path, std::string_view what, int reason) {
    if (reason == EINTR)
        throw_error(ExitCode::kInterrupted, "{}: interrupted while waiting for the {}", path, what);
    const bool is_denied = reason == EACCES || reason == EPERM;
    throw Error(ExitCode::kIo, Problem{{.source = path, .key = {}},
                                       fmt::format("cannot read the {} file: {}", what,
                                                   std::generic_category().message(reason)),
                                       is_denied ? std::string(hint_for_errno(reason, FileUse::kRead))
                                                 : "give the path of a TOML file"});
}

/// Standard input stays open: closing it would give its number to the next file.
FileHandle open(const std::string& path) {
    return FileHandle(path == "-" ? ::fdopen(::dup(STDIN_FILENO), "rb") : std::fopen(path.c_str(), "rb"));
}

}  // namespace

std::string read_file(const std::string& path, std::string_view what) {
    check_path(path);
    const std::string name = source_name(path);
    const FileHandle file = open(path);
    if (!file) fail_io(name, what, errno);
    std::string text;
    std::array<char, 65536> block{};
    while (true) {
        errno = 0;
        const std::size_t count = std::fread(block.data(), 1, block.size(), file.get());
        if (std::ferror(file.get()) != 0) fail_io(name, what, errno);  // also after a part: a signal came
        if (count == 0) return text;
        text.append(block.data(), count);
        check_file_bytes(name, text.size());
    }
}

std::string source_name(const std::string& path) {
    return path == "-" ? "stdin" : path;
}

void check_file_bytes(const std::string& source_name, std::size_t bytes) {
    if (bytes <= static_cast<std::size_t>(Limits::kFileBytes)) return;
    throw Error(
        ExitCode::kInvalidScene,
        Problem{{.source = source_name, .key = {}},
                fmt::format("{} bytes or more are over the limit of {} bytes", bytes, Limits::kFileBytes),
                "a scene has fewer particles"});
}

}  // namespace corda::scene
