#include "corda/serve/file_watch.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "corda/core/basics.hpp"

namespace corda::serve {

FileWatch::FileWatch(const std::string& path) : path_(path), last_(stamp()) {
    // The folder is watched, because many editors put a new file in the place of the old one.
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    constexpr unsigned kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE;
    inotify_ = Descriptor(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK));
    if (inotify_ && ::inotify_add_watch(inotify_.get(), folder.empty() ? "." : folder.c_str(), kEvents) >= 0)
        return;
    const int reason = errno;
    if (reason == ENOENT || reason == ENOTDIR || reason == EACCES) fail_file("watch", path, reason);
    inotify_ = Descriptor();
    warning_ = fmt::format(
        "the system reports no changes of '{}': {}; it is looked at 5 times a second "
        "(fs.inotify.max_user_instances "
        "and fs.inotify.max_user_watches limit the reports)",
        path, std::generic_category().message(reason));
}

bool FileWatch::wait(int timeout_ms) {
    if (inotify_) {
        pollfd events{inotify_.get(), POLLIN, 0};
        static_cast<void>(::poll(&events, 1, std::min(timeout_ms, kLookMs)));
        alignas(inotify_event) std::array<char, 4096> ignored{};
        while (::read(inotify_.get(), ignored.data(), ignored.size()) > 0) continue;
    } else {
        static_cast<void>(::poll(nullptr, 0, std::min(timeout_ms, kLookMs)));
    }
    const Stamp now = stamp();
    return std::exchange(last_, now) != now;
}

FileWatch::Stamp FileWatch::stamp() const {
    struct ::stat info {};
    if (::stat(path_.c_str(), &info) != 0) return {};
    return {{info.st_mtim.tv_sec, info.st_mtim.tv_nsec},
            {info.st_ctim.tv_sec, info.st_ctim.tv_nsec},
            info.st_size,
            info.st_ino};
}

}  // namespace corda::serve
