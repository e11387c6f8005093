#include "corda/serve/file_watch.hpp"

#include <poll.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "corda/core/text.hpp"

namespace corda::serve {

FileWatch::FileWatch(const std::string& path)
    : path_(path), inotify_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)), last_(stamp()) {
    // The folder is watched, because many editors put a new file in the place of the old one.
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    constexpr unsigned kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE;
    if (inotify_ && ::inotify_add_watch(inotify_.get(), folder.empty() ? "." : folder.c_str(), kEvents) >= 0)
        return;
    const int reason = errno;
    if (reason != EMFILE && reason != ENFILE && reason != ENOSPC) fail_file("watch", path, reason);
    throw_error(ExitCode::kTemporary,
                "cannot watch '{}': {}; raise fs.inotify.max_user_instances and fs.inotify.max_user_watches",
                path, std::generic_category().message(reason));
}

bool FileWatch::wait(int timeout_ms) {
    pollfd events{inotify_.get(), POLLIN, 0};
    static_cast<void>(::poll(&events, 1, timeout_ms));
    alignas(inotify_event) std::array<char, 4096> ignored{};
    while (::read(inotify_.get(), ignored.data(), ignored.size()) > 0) continue;
    const Stamp now = stamp();
    return std::exchange(last_, now) != now;
}

FileWatch::Stamp FileWatch::stamp() const {
    struct ::stat info {};
    if (::stat(path_.c_str(), &info) != 0) return {};
    return {info.st_mtim.tv_sec, info.st_mtim.tv_nsec, info.st_size, info.st_ino};
}

}  // namespace corda::serve
