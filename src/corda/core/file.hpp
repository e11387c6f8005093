#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"

namespace corda {

struct FileCloser {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
/// A C file. What is to stay is written by OutputFile, which also checks the close.
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

/// Throws corda::Error (kUsage) if the path holds a NUL character, where the system would end it.
void check_path(const std::string& path);

/// Opens a file for reading. Throws corda::Error: kIo, also for a folder; kInterrupted if a signal comes
/// while it waits for the writer of a pipe.
[[nodiscard]] FileHandle open_for_reading(const std::string& path);

/// Standard input, which stays open when the handle is closed: its number would go to the next file. Null,
/// with a reason in errno, if there is none.
[[nodiscard]] FileHandle open_standard_input();

/// Reads up to `count` bytes into `bytes`; fewer only at the end of the file. Throws corda::Error (kIo).
[[nodiscard]] std::size_t read_bytes(const FileHandle& file, const std::string& path, char* bytes,
                                     std::size_t count);

/// The first `count` bytes of a file, or all that it has. Throws corda::Error (kIo).
[[nodiscard]] std::string first_bytes(const std::string& path, std::size_t count);

/// Whether a file or folder is there; false as well if the system does not tell.
[[nodiscard]] bool is_there(const std::string& path);

/// The size in bytes of an ordinary file. Throws corda::Error (kIo).
[[nodiscard]] std::uintmax_t file_size(const std::string& path);
/// All its bytes. Throws corda::Error (kIo).
[[nodiscard]] std::string file_bytes(const std::string& path);

/// Owns an open file descriptor.
class Descriptor {
  public:
    Descriptor() = default;
    explicit Descriptor(int number) noexcept : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~Descriptor() { static_cast<void>(close()); }

    explicit operator bool() const { return number_ >= 0; }
    [[nodiscard]] int get() const { return number_; }

    /// Closes the descriptor if it is open. Returns 0 or the errno value of a failure: the last chance to
    /// learn that written data is lost.
    [[nodiscard]] int close() noexcept;

  private:
    int number_ = -1;
};

/// Creates and opens a file for reading and writing; nothing may stand under its name, not even a link that
/// leads nowhere. Sets errno if it fails.
[[nodiscard]] Descriptor create_new(const std::string& path, unsigned mode) noexcept;

/// Writes all of `bytes` to an open descriptor. Calls check_cancelled() if a signal interrupts the wait
/// for the reader of a pipe. Returns 0 or an errno value.
[[nodiscard]] int write_all(int descriptor, std::string_view bytes);

/// Throws corda::Error (exit_code_of_errno(); kInterrupted for EINTR): "cannot ACTION 'PATH': REASON; HINT",
/// with the reason and the hint for `error_number`. The hint assumes that the file was to be written, unless
/// ACTION is "read".
[[noreturn]] void fail_file(std::string_view action, const std::string& path, int error_number);

/// Purpose of using a file.
enum class FileUse { kRead, kWrite };

/// Remedy for an errno value; empty if its text is enough.
[[nodiscard]] std::string_view hint_for_errno(int error_number, FileUse use = FileUse::kWrite);

/// Makes a folder and its missing parents. Throws corda::Error (kIo).
void make_folder(const std::string& path);

/// Tries to create a file in a folder, which leaves nothing there. Returns 0 or an errno value. Asking
/// instead (faccessat2) fails under container runtimes that do not know the call.
[[nodiscard]] int try_to_write_in(const std::string& folder);

/// Checks that a folder can be made or, if it exists, written to. Throws corda::Error (kIo).
void check_folder(const std::string& path);

/// Flushes an open file to disk. Throws corda::Error (kIo).
void sync_file(const Descriptor& file, const std::string& path);

/// Flushes the entry of `path` in its folder to disk, so that a rename survives a power cut. A folder
/// that cannot be read or synced is no failure, because the entry is there: its file system is synced
/// instead, as far as it can be. Throws corda::Error (kIo) if there is no such folder.
void sync_folder_of(const std::string& path);

/// A folder in the system's directory for temporary files, removed with its contents.
class TemporaryFolder : NonCopyable {
  public:
    /// Throws corda::Error (kIo) if there is no place for it.
    TemporaryFolder();
    ~TemporaryFolder();

    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

}  // namespace corda
