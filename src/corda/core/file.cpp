#include "corda/core/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/exit_code.hpp"
#include "corda/core/text.hpp"

namespace corda {

void check_path(const std::string& path) {
    if (path.find('\0') == std::string::npos) return;
    throw_usage("'{}' holds a NUL character, which no file name can; leave it out", printable(path));
}

FileHandle open_for_reading(const std::string& path) {
    check_path(path);
    FileHandle file(std::fopen(path.c_str(), "rbe"));
    if (!file) fail_file("read", path, errno);
    struct stat status {};
    if (::fstat(::fileno(file.get()), &status) != 0) fail_file("read", path, errno);
    // A folder opens without complaint and fails only at the first read.
    if (S_ISDIR(status.st_mode)) fail_file("read", path, EISDIR);
    return file;
}

FileHandle open_standard_input() {
    return FileHandle(::fdopen(::dup(STDIN_FILENO), "rb"));
}

std::size_t read_bytes(const FileHandle& file, const std::string& path, char* bytes, std::size_t count) {
    errno = 0;
    const std::size_t read = std::fread(bytes, 1, count, file.get());
    if (read < count && std::ferror(file.get()) != 0) fail_file("read", path, errno);
    return read;
}

std::string first_bytes(const std::string& path, std::size_t count) {
    std::string bytes(count, '\0');
    bytes.resize(read_bytes(open_for_reading(path), path, bytes.data(), count));
    return bytes;
}

bool is_there(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

std::uintmax_t file_size(const std::string& path) {
    std::error_code failure;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failure);
    if (failure) fail_file("read", path, failure.value());
    return bytes;
}

std::string file_bytes(const std::string& path) {
    return first_bytes(path, file_size(path));
}

int Descriptor::close() noexcept {
    if (number_ < 0) return 0;
    const int status = ::close(std::exchange(number_, -1));
    // Linux has closed the descriptor even if a signal interrupted the call.
    return status == 0 || errno == EINTR ? 0 : errno;
}

Descriptor create_new(const std::string& path, unsigned mode) noexcept {
    return Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
}

int write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR) return errno;
        if (count < 0) check_cancelled();
        if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return 0;
}

std::string_view hint_for_errno(int error_number, FileUse use) {
    const bool is_read = use == FileUse::kRead;
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
            return "free some space on that disk, or write to another one";
        case ENOENT:
            return is_read ? "check the path" : "check the path; the folder must exist";
        case EACCES:
        case EPERM:
        case EROFS:
            return is_read ? "change its permissions, or run corda as a user who may read it"
                           : "choose a place you may write to, or change the permissions";
        case EISDIR:
            return "give the name of a file, not of a folder";
        case ENAMETOOLONG:
            return is_read ? "check the path" : "choose a shorter name";
        case EFBIG:
            return "this file system or a ulimit forbids files of that size";
        case EMFILE:
        case ENFILE:
            return "close some files, or raise the limit (ulimit -n)";
        default:
            return "";
    }
}

void fail_file(std::string_view action, const std::string& path, int error_number) {
    // Only a pipe or a device makes a call wait for so long that a signal breaks it off.
    if (error_number == EINTR)
        throw_error(ExitCode::kInterrupted, "interrupted while waiting to {} '{}'", action, path);
    const std::string_view hint =
        hint_for_errno(error_number, action == "read" ? FileUse::kRead : FileUse::kWrite);
    throw_error(exit_code_of_errno(error_number), "cannot {} '{}': {}{}{}", action, path,
                std::generic_category().message(error_number), hint.empty() ? "" : "; ", hint);
}

void make_folder(const std::string& path) {
    check_path(path);
    std::error_code reason;
    std::filesystem::create_directories(path, reason);
    if (reason) fail_file("make the folder", path, reason.value());
}

int try_to_write_in(const std::string& folder) {
    Descriptor file(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
    if (file) return 0;
    // The file system, or what filters system calls, does not know O_TMPFILE.
    if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL && errno != ENOSYS) return errno;
    std::string path = folder + "/.corda-XXXXXX";
    file = Descriptor(::mkostemp(path.data(), O_CLOEXEC));
    if (!file) return errno;
    ::unlink(path.c_str());
    return 0;
}

void check_folder(const std::string& path) {
    namespace fs = std::filesystem;
    for (fs::path at = path;; at = at.parent_path()) {
        if (at.empty()) at = ".";
        std::error_code failure;
        const fs::file_type type = fs::status(at, failure).type();
        if (type == fs::file_type::not_found && at != ".") continue;
        if (type != fs::file_type::directory)
            fail_file("make the folder", path, failure ? failure.value() : ENOTDIR);
        if (const int status = try_to_write_in(at.string()); status != 0)
            fail_file(at == path ? "write to the folder" : "make the folder", path, status);
        return;
    }
}

void sync_file(const Descriptor& file, const std::string& path) {
    int status = 0;
    do status = ::fsync(file.get());
    while (status != 0 && errno == EINTR);
    // Pipes, and folders on some file systems, cannot be synced and say EINVAL.
    if (status != 0 && errno != EINVAL) fail_file("sync to disk", path, errno);
}

void sync_folder_of(const std::string& path) {
    std::string folder = std::filesystem::path(path).parent_path().string();
    if (folder.empty()) folder = ".";
    const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!opened && errno != EACCES && errno != EPERM) fail_file("open for syncing", folder, errno);
    int status = -1;
    if (opened) {
        do status = ::fsync(opened.get());
        while (status != 0 && errno == EINTR);
        if (status == 0 || errno == EINVAL) return;
    }
    // A folder may be writable and not readable (mode 1733). Its file system is synced through the file.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file) static_cast<void>(::syncfs(file.get()));
}

TemporaryFolder::TemporaryFolder() {
    std::error_code failure;
    path_ = (std::filesystem::temp_directory_path(failure) / "corda-XXXXXX").string();
    if (!failure && mkdtemp(path_.data()) == nullptr) failure.assign(errno, std::generic_category());
    if (failure)
        throw_error(exit_code_of_errno(failure.value()),
                    "cannot make a folder for temporary files, '{}': {}; set TMPDIR to a folder that can be "
                    "written to",
                    path_, failure.message());
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace corda
