#include "corda/media/file_ops.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "corda/core/error.hpp"

namespace corda::media {
namespace {

void sync_path(const std::string& path, int flags) {
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
    if (descriptor < 0) fail_file("open for syncing", path, errno);
    const int status = ::fsync(descriptor);
    const int sync_errno = errno;
    ::close(descriptor);
    // Some file systems have nothing to sync on a folder and say EINVAL.
    if (status != 0 && sync_errno != EINVAL) fail_file("sync to disk", path, sync_errno);
}

}  // namespace

std::string_view hint_for_errno(int error_number) {
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
            return "free some space on that disk, or write to another one";
        case ENOENT:
            return "check the path; the folder must exist";
        case EACCES:
        case EPERM:
        case EROFS:
            return "choose a place you may write to, or change the permissions";
        case EISDIR:
            return "give the name of a file, not of a folder";
        case EFBIG:
            return "this file system or a ulimit forbids files of that size";
        default:
            return "";
    }
}

void fail_file(std::string_view action, const std::string& path, int error_number) {
    const std::string_view hint = hint_for_errno(error_number);
    const std::string reason = std::generic_category().message(error_number);
    throw Error(ExitCode::kIo,
                fmt::format("cannot {} '{}': {}{}{}", action, path, reason, hint.empty() ? "" : "; ", hint));
}

FileHandle open_for_reading(const std::string& path) {
    FileHandle file(std::fopen(path.c_str(), "rbe"));
    if (!file) fail_file("read", path, errno);
    struct stat status {};
    if (::fstat(::fileno(file.get()), &status) != 0) fail_file("read", path, errno);
    // A folder opens without complaint and fails only at the first read.
    if (S_ISDIR(status.st_mode)) fail_file("read", path, EISDIR);
    return file;
}

void close_written(FileHandle file, const std::string& path) {
    if (std::fflush(file.get()) != 0) fail_file("write", path, errno);
    if (std::fclose(file.release()) != 0) fail_file("close", path, errno);
}

void sync_file(const std::string& path) {
    sync_path(path, O_RDONLY);
}

void rename_file(const std::string& from, const std::string& to) {
    if (std::rename(from.c_str(), to.c_str()) != 0) fail_file("rename '" + from + "' to", to, errno);
}

void sync_folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    sync_path(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
}

void remove_quietly(const std::string& path) noexcept {
    ::unlink(path.c_str());
}

}  // namespace corda::media
