#include "corda/core/range_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

namespace corda {
namespace {

/// A lock of the open file, not of the process: threads keep each other out, too. `length` 0: all.
struct ::flock exclusive_lock(std::int64_t first, std::int64_t length) {
    struct ::flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    lock.l_start = first;
    lock.l_len = length;
    return lock;
}

enum class Locked { kYes, kNo, kCannot };

Locked lock_range(const Descriptor& file, std::int64_t first, std::int64_t length) {
    struct ::flock wanted = exclusive_lock(first, length);
    if (::fcntl(file.get(), F_OFD_SETLK, &wanted) == 0) return Locked::kYes;
    return errno == EAGAIN || errno == EACCES ? Locked::kNo : Locked::kCannot;
}

/// Whether others hold a part of the range, and not all numbers: who holds those removes the file.
bool is_held(const Descriptor& file, std::int64_t first, std::int64_t length) {
    struct ::flock found = exclusive_lock(first, length);
    return ::fcntl(file.get(), F_OFD_GETLK, &found) == 0 && found.l_type != F_UNLCK && found.l_len != 0;
}

}  // namespace

RangeLock::RangeLock(std::string path, std::int64_t first, std::int64_t end, const std::string& what)
    : path_(std::move(path)) {
    constexpr int kMaxTries = 10'000;
    for (int tries = 0;; ++tries) {
        file_ = Descriptor(::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666));
        if (!file_) fail_file("write", path_, errno);
        const Locked locked = lock_range(file_, first, end - first);
        if (locked == Locked::kCannot || (locked == Locked::kYes && leads_to(path_, file_))) return;
        if (tries == kMaxTries || (locked == Locked::kNo && is_held(file_, first, end - first)))
            fail_busy(what);
        std::this_thread::sleep_for(std::chrono::microseconds(100));  // while the file is removed
    }
}

RangeLock::~RangeLock() {
    if (lock_range(file_, 0, 0) == Locked::kYes && leads_to(path_, file_)) ::unlink(path_.c_str());
}

}  // namespace corda
