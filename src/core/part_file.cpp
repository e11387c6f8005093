#include "corda/core/part_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "corda/core/basics.hpp"

namespace corda {
namespace {

/// Locks an open file by flock(2). False if another process holds the lock and `operation` does not wait for
/// it, or if the name leads to another file by now.
bool lock(const Descriptor& file, const std::string& path, int operation) {
    int status = 0;
    do status = ::flock(file.get(), operation);
    while (status != 0 && errno == EINTR);
    // Every other failure means a file system without locks, where the exclusive creation must do.
    if (status != 0 && errno == EWOULDBLOCK) return false;
    return leads_to(path, file);
}

/// Opens the file under the name of a part. O_NONBLOCK: a pipe there must not stop us.
Descriptor open_existing(const std::string& path) {
    return Descriptor(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC));
}

/// True for what a process leaves that is killed before its first chunk is whole: an empty file.
bool is_leftover(const Descriptor& part) {
    struct stat status {};
    return part && ::fstat(part.get(), &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0;
}

/// Refuses a folder, a pipe, a device or a symbolic link under the name of a part: no render made it.
void refuse_other_kinds(const std::string& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return;
    const char* const kind = S_ISDIR(status.st_mode)    ? "a folder"
                             : S_ISLNK(status.st_mode)  ? "a symbolic link"
                             : S_ISFIFO(status.st_mode) ? "a pipe"
                                                        : "a device or a socket";
    throw Error(ExitCode::kIo, "'" + path + "' is " + kind +
                                   ", and the unfinished video needs this name; move it away, or choose "
                                   "another name for the output");
}

void remove_old(const std::string& path) {
    refuse_other_kinds(path);
    const Descriptor old = open_existing(path);
    if (!old && errno == ENOENT) return;
    if (!old) fail_file("replace", path, errno);
    if (!lock(old, path, LOCK_EX | LOCK_NB)) fail_busy("'" + path + "'");
    if (::unlink(path.c_str()) != 0) fail_file("remove", path, errno);
}

}  // namespace

PartFile::PartFile(std::string path, Descriptor descriptor)
    : path_(std::move(path)), descriptor_(std::move(descriptor)) {}

void PartFile::check(const std::string& path, const OutputOptions& options) {
    refuse_other_kinds(path);
    const Descriptor old = open_existing(path);
    if (!old && errno == ENOENT) return;
    if (!old && errno == ENAMETOOLONG) fail_file("write", path, errno);
    if (old && !lock(old, path, LOCK_SH | LOCK_NB)) fail_busy("'" + path + "'");
    if (options.force || is_leftover(old)) return;
    throw Error(ExitCode::kIo,
                "'" + path +
                    "' holds an interrupted render; resume it (--resume), make it a video (corda recover), "
                    "move it away, or start anew with force (--force)");
}

PartFile PartFile::create(std::string path, const OutputOptions& options) {
    if (options.force) remove_old(path);
    Descriptor file = create_new(path, 0666);
    if (!file && errno == EEXIST && is_leftover(open_existing(path))) {
        remove_unheld(path);
        file = create_new(path, 0666);
    }
    if (!file) {
        const int open_errno = errno;
        if (open_errno == EEXIST) check(path, {});
        fail_file("write", path, open_errno);
    }
    // Another process can hold a file this new only for the moment it takes to look at it, or to remove it.
    if (!lock(file, path, LOCK_EX)) fail_busy("'" + path + "'");
    return {std::move(path), std::move(file)};
}

void PartFile::remove_unheld(const std::string& path) noexcept {
    const Descriptor old = open_existing(path);
    if (old && ::flock(old.get(), LOCK_EX | LOCK_NB) == 0 && leads_to(path, old)) ::unlink(path.c_str());
}

PartFile PartFile::open(std::string path) {
    check_path(path);
    refuse_other_kinds(path);
    Descriptor file = open_existing(path);
    if (!file) fail_file("read", path, errno);
    if (!lock(file, path, LOCK_EX | LOCK_NB)) fail_busy("'" + path + "'");
    return {std::move(path), std::move(file)};
}

void PartFile::take_place_of(PartFile& other) {
    if (::rename(path_.c_str(), other.path_.c_str()) != 0) fail_file("replace", other.path_, errno);
    path_ = other.path_;
    static_cast<void>(other.descriptor_.close());
    sync_folder_of(path_);
}

bool PartFile::is_empty() const {
    struct stat status {};
    return ::fstat(descriptor_.get(), &status) == 0 && status.st_size == 0;
}

bool PartFile::is_named() const {
    return leads_to(path_, descriptor_);
}

void PartFile::sync() {
    sync_file(descriptor_, path_);
    if (!std::exchange(has_durable_name_, true)) sync_folder_of(path_);
}

void PartFile::remove() noexcept {
    if (leads_to(path_, descriptor_)) ::unlink(path_.c_str());
    static_cast<void>(descriptor_.close());
}

}  // namespace corda
