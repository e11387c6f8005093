#include "corda/core/output_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "corda/core/text.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;
constexpr std::size_t kMaxStem = 230;  // file systems allow 255 bytes; ".12345678.tmp" needs 13
constexpr std::string_view kTemporaryEnding = ".tmp";

fs::path folder_of(const std::string& path) {
    const fs::path folder = fs::path(path).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

/// Prefix of the names of the temporary files of an output.
std::string temporary_stem(const std::string& path) {
    const fs::path whole(path);
    return (whole.parent_path() / whole.filename().string().substr(0, kMaxStem)).string() + ".";
}

/// The name of the output that a file is a temporary one of, cut to the longest stem; none for other files.
std::optional<std::string> output_of(std::string_view name) {
    if (!name.ends_with(kTemporaryEnding)) return std::nullopt;
    name.remove_suffix(kTemporaryEnding.size());
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos || dot + 1 == name.size()) return std::nullopt;
    const bool is_hexadecimal = name.find_first_not_of("0123456789abcdef", dot + 1) == std::string_view::npos;
    return is_hexadecimal ? std::optional<std::string>(name.substr(0, dot)) : std::nullopt;
}

/// Removes a temporary file unless a process holds it.
void remove_unheld(const std::string& path) {
    const Descriptor file(::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC));
    if (file && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
}

/// The file that `path` leads to through symbolic links; it may be missing.
std::string follow_links(std::string path) {
    constexpr int kMaxLinks = 40;  // the kernel's own limit
    for (int i = 0; i < kMaxLinks; ++i) {
        std::error_code ignored;
        if (!fs::is_symlink(fs::symlink_status(path, ignored))) return path;
        path = (fs::path(path).parent_path() / fs::read_symlink(path, ignored)).string();
    }
    fail_file("write", path, ELOOP);
}

[[noreturn]] void fail_exists(const std::string& path) {
    throw_error(ExitCode::kIo, "'{}' exists; it is replaced only with force (--force)", path);
}

/// The status of the file that `path` leads to; none if it is missing.
std::optional<struct stat> status_of(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) return status;
    if (errno != ENOENT) fail_file("write", path, errno);
    return std::nullopt;
}

bool is_taken(const std::string& path) {
    std::error_code ignored;
    return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

std::string random_text() {
    return fmt::format("{:x}", std::random_device{}());
}

/// Renames unless `to` exists. Returns 0 or an errno value.
int rename_if_free(const std::string& from, const std::string& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
    if (errno != EINVAL && errno != ENOSYS) return errno;
    // This file system does not know that call; most know links.
    if (::link(from.c_str(), to.c_str()) == 0) return ::unlink(from.c_str()) == 0 ? 0 : errno;
    if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS) return errno;
    // The shared folders of virtual machines know neither: take the name with an empty file, then replace
    // that.
    const Descriptor taken = create_new(to, 0600);
    if (!taken || std::rename(from.c_str(), to.c_str()) == 0) return taken ? 0 : errno;
    const int rename_errno = errno;
    ::unlink(to.c_str());
    return rename_errno;
}

}  // namespace

bool is_standard_output(const std::string& path) {
    return path == "-" || path == "/dev/stdout";
}

void check_output(const std::string& path, const std::string& input, bool force, OutputKind kind) {
    check_path(path);
    if (kind == OutputKind::kStream && is_standard_output(path)) return;
    if (fs::path(path).filename().empty()) throw_usage("the output '{}' names no file; give it a name", path);
    const std::string given_folder = folder_of(path).string();
    struct stat folder_status {};
    if (::stat(given_folder.c_str(), &folder_status) != 0) {
        if (errno != ENOENT) fail_file("write to the folder", given_folder, errno);
        throw_error(ExitCode::kIo, "cannot write '{}': the folder '{}' does not exist; make it first", path,
                    given_folder);
    }
    if (!S_ISDIR(folder_status.st_mode)) fail_file("write to the folder", given_folder, ENOTDIR);
    if (const auto status = status_of(path)) {
        if (S_ISDIR(status->st_mode)) fail_file("write", path, EISDIR);
        if (!S_ISREG(status->st_mode)) {
            if (kind == OutputKind::kStream) return;
            throw_error(ExitCode::kIo,
                        "cannot write '{}': it is a device or a pipe, and this format needs an ordinary "
                        "file; choose another name",
                        path);
        }
        std::error_code ignored;
        if (!input.empty() && fs::equivalent(path, input, ignored))
            throw_usage("the output '{}' would replace the input; choose another name", path);
    }
    if (!force && is_taken(path)) fail_exists(path);
    const std::string folder = folder_of(force ? follow_links(path) : path).string();
    if (const int status = try_to_write_in(folder); status != 0)
        fail_file("write to the folder", folder, status);
}

void remove_leftovers(const std::string& folder,
                      const std::function<bool(const std::string& name)>& is_output) noexcept {
    try {
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
            const auto output = output_of(entry.path().filename().string());
            if (output && is_output(*output)) remove_unheld(entry.path().string());
        }
    } catch (const std::exception&) {
        return;
    }
}

void remove_leftovers(const std::string& path) noexcept {
    try {
        const std::string target = follow_links(path);
        const std::string stem = fs::path(target).filename().string().substr(0, kMaxStem);
        remove_leftovers(folder_of(target).string(), [&](const std::string& name) { return name == stem; });
    } catch (const std::exception&) {
        return;
    }
}

OutputFile::OutputFile(std::string path, const OutputOptions& options)
    : path_(std::move(path)), target_(path_), options_(options) {
    check_path(path_);
    if (is_standard_output(path_)) {
        descriptor_ = Descriptor(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
        if (!descriptor_) fail_file("write", path_, errno);
        return;
    }
    const auto status = status_of(path_);
    if (status && !S_ISREG(status->st_mode)) {
        open_directly();
        return;
    }
    if (!options_.force && is_taken(path_)) fail_exists(path_);
    if (options_.force) find_target();
    open_temporary();
}

void OutputFile::find_target() {
    target_ = follow_links(path_);
    if (const auto status = status_of(target_))
        replaced_ = Owner{status->st_mode & 0777U, status->st_uid, status->st_gid};
}

OutputFile::OutputFile(InMemory) : descriptor_(::memfd_create("output", MFD_CLOEXEC)) {
    if (!descriptor_)
        throw_error(ExitCode::kTemporary, "cannot make a file in memory: {}",
                    std::generic_category().message(errno));
    temporary_ = "/proc/self/fd/" + std::to_string(descriptor_.get());
}

std::string OutputFile::bytes() {
    flush();
    struct stat status {};
    if (::fstat(descriptor_.get(), &status) != 0) fail_file("read", temporary_, errno);
    std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
    for (std::size_t begin = 0; begin < bytes.size();) {
        const ssize_t count =
            ::pread(descriptor_.get(), bytes.data() + begin, bytes.size() - begin, static_cast<off_t>(begin));
        if (count <= 0) fail_file("read", temporary_, errno);
        begin += static_cast<std::size_t>(count);
    }
    return bytes;
}

OutputFile::~OutputFile() {
    if (!temporary_.empty() && !path_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::open_directly() {
    descriptor_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC));
    struct stat status {};
    if (!descriptor_ || ::fstat(descriptor_.get(), &status) != 0) fail_file("write", path_, errno);
    // An ordinary file has taken the place of the device since we looked.
    if (S_ISREG(status.st_mode)) fail_exists(path_);
}

void OutputFile::open_temporary() {
    // Nobody may read a new version of a private file before it has the old one's permissions.
    const mode_t mode = replaced_ ? 0600 : 0666;
    const std::string stem = temporary_stem(target_);
    constexpr int kMaxAttempts = 100;
    for (int i = 0; i < kMaxAttempts; ++i) {
        temporary_ = stem + random_text() + std::string(kTemporaryEnding);
        descriptor_ = create_new(temporary_, mode);
        if (!descriptor_ && errno == EEXIST) continue;
        if (!descriptor_) break;
        // A process that locked the file first is about to remove it: wait, then create another. On a file
        // system without locks, no process removes it.
        while (::flock(descriptor_.get(), LOCK_EX) != 0 && errno == EINTR) {
        }
        if (leads_to(temporary_, descriptor_)) return;
        errno = ENOENT;
    }
    temporary_.clear();
    fail_file("write", path_, errno);
}

void OutputFile::write(std::string_view bytes) {
    if (buffer_.size() + bytes.size() > kBufferBytes) flush();
    if (bytes.size() < kBufferBytes) {
        buffer_ += bytes;
    } else if (const int status = write_all(descriptor_.get(), bytes); status != 0) {
        fail_write(status);
    }
}

void OutputFile::flush() {
    // Not kept: if this is cancelled, a part of it is written, which must not be repeated.
    const int status = write_all(descriptor_.get(), std::exchange(buffer_, {}));
    if (status != 0) fail_write(status);
}

void OutputFile::fail_write(int error_number) const {
    if (error_number == EPIPE && is_standard_output(path_)) throw ReaderLeft();
    fail_file("write", path_, error_number);
}

void OutputFile::restore_permissions() {
    const int file = descriptor_.get();
    unsigned mode = replaced_->mode;
    constexpr auto kSameUser = static_cast<uid_t>(-1);
    // Only root may give a file to another user, and others only to a group of theirs.
    const bool has_group = ::fchown(file, replaced_->user, replaced_->group) == 0 ||
                           ::fchown(file, kSameUser, replaced_->group) == 0;
    // The old group's rights are not for the members of the new one.
    if (!has_group) mode = (mode & 0707U) | (mode & 07U) << 3U;
    if (::fchmod(file, mode) != 0) fail_file("set the permissions of", path_, errno);
}

void OutputFile::close() {
    flush();
    if (!temporary_.empty()) {
        if (replaced_) restore_permissions();
        sync_file(descriptor_, path_);
    }
    if (const int status = descriptor_.close(); status != 0) fail_file("close", path_, status);
}

Descriptor OutputFile::second_lock() const {
    return Descriptor(temporary_.empty() || !descriptor_ ? -1
                                                         : ::fcntl(descriptor_.get(), F_DUPFD_CLOEXEC, 0));
}

int OutputFile::rename_to(const std::string& name) const {
    if (!options_.force) return rename_if_free(temporary_, name);
    return std::rename(temporary_.c_str(), name.c_str()) == 0 ? 0 : errno;
}

void OutputFile::commit() {
    const Saving saving;
    const Descriptor lock = second_lock();
    bool is_blocked = false;
    if (options_.force && !temporary_.empty()) {
        // It may have changed since the constructor looked.
        const auto found = status_of(path_);
        is_blocked = found && !S_ISREG(found->st_mode);
        if (!is_blocked) find_target();
    }
    close();
    if (temporary_.empty()) return;
    const int status = is_blocked ? EEXIST : rename_to(target_);
    if (status == EEXIST)
        throw_error(ExitCode::kIo,
                    "'{}' appeared while it was being written and is not replaced{}; the new file is '{}'",
                    path_, options_.force ? ", because it is no ordinary file" : " without --force", keep());
    if (status != 0) fail_file("rename '" + temporary_ + "' to", path_, status);
    temporary_.clear();
    sync_folder_of(target_);
}

std::string OutputFile::keep() {
    const Saving saving;
    const Descriptor lock = second_lock();
    if (descriptor_) close();
    if (temporary_.empty()) return path_;
    const std::string part = target_ + ".part";
    const bool is_renamed = rename_to(part) == 0;
    std::string kept = std::exchange(temporary_, {});
    return is_renamed ? part : kept;
}

void save_file(const std::string& path, std::string_view bytes, const OutputOptions& options) {
    OutputFile file(path, options);
    file.write(bytes);
    file.commit();
}

}  // namespace corda
