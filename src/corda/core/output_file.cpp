#include "corda/core/output_file.hpp"

#include <fcntl.h>
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
constexpr std::size_t kMaxStem = 240;  // file systems allow 255 bytes; ".12345678.tmp" needs 13

fs::path folder_of(const std::string& path) {
    const fs::path folder = fs::path(path).parent_path();
    return folder.empty() ? fs::path(".") : folder;
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

}  // namespace

bool is_standard_output(const std::string& path) {
    return path == "-" || path == "/dev/stdout";
}

void check_output(const std::string& path, const std::string& input, bool force, OutputKind kind) {
    check_path(path);
    if (kind == OutputKind::kStream && is_standard_output(path)) return;
    if (fs::path(path).filename().empty()) throw_usage("the output '{}' names no file; give it a name", path);
    const std::string folder = folder_of(path).string();
    struct stat folder_status {};
    if (::stat(folder.c_str(), &folder_status) != 0) {
        if (errno != ENOENT) fail_file("write to the folder", folder, errno);
        throw_error(ExitCode::kIo, "cannot write '{}': the folder '{}' does not exist; make it first", path,
                    folder);
    }
    if (!S_ISDIR(folder_status.st_mode)) fail_file("write to the folder", folder, ENOTDIR);
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
    if (const int status = try_to_write_in(folder); status != 0)
        fail_file("write to the folder", folder, status);
}

OutputFile::OutputFile(std::string path, const OutputOptions& options)
    : path_(std::move(path)), options_(options) {
    check_path(path_);
    if (is_standard_output(path_)) {
        descriptor_ = Descriptor(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
        if (!descriptor_) fail_write(errno);
        return;
    }
    const auto status = status_of(path_);
    if (status && !S_ISREG(status->st_mode)) {
        open_directly();
        return;
    }
    if (!options_.force && is_taken(path_)) fail_exists(path_);
    open_temporary();
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
    const fs::path whole(path_);
    const std::string stem = (whole.parent_path() / whole.filename().string().substr(0, kMaxStem)).string();
    do {
        temporary_ = fmt::format("{}.{:x}.tmp", stem, std::random_device{}());
        descriptor_ = create_new(temporary_, 0666);
    } while (!descriptor_ && errno == EEXIST);
    if (descriptor_) return;
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
    if (!is_standard_output(path_)) fail_file("write", path_, error_number);
    if (error_number == EPIPE) throw ReaderLeft();
    fail_file("write to", "standard output", error_number);
}

void OutputFile::close() {
    flush();
    if (!temporary_.empty()) sync_file(descriptor_, path_);
    if (const int status = descriptor_.close(); status != 0) fail_write(status);
}

int OutputFile::rename_to(const std::string& name) const {
    if (!options_.force) {
        if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, name.c_str(), RENAME_NOREPLACE) == 0)
            return 0;
        if (errno != EINVAL && errno != ENOSYS) return errno;
        if (is_taken(name)) return EEXIST;  // this file system does not know that call
    }
    return std::rename(temporary_.c_str(), name.c_str()) == 0 ? 0 : errno;
}

void OutputFile::commit() {
    close();
    if (temporary_.empty()) return;
    const int status = rename_to(path_);
    if (status == EEXIST)
        throw_error(ExitCode::kIo,
                    "'{}' appeared while it was being written and is not replaced without --force; the new "
                    "file is '{}'",
                    path_, keep());
    if (status != 0) fail_file("rename '" + temporary_ + "' to", path_, status);
    temporary_.clear();
    sync_folder_of(path_);
}

std::string OutputFile::keep() {
    if (descriptor_) close();
    if (temporary_.empty()) return path_;
    const std::string part = path_ + ".part";
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
