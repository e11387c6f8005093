#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace corda::media {

struct FileCloser {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
/// An open C file. Whoever writes closes it by hand and checks: a destructor cannot report a full disk.
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

/// Throws corda::Error (kIo): "cannot ACTION 'PATH': <text of error_number>", with a hint that fits the
/// number.
[[noreturn]] void fail_file(std::string_view action, const std::string& path, int error_number);

/// What to do about an errno value; empty where there is nothing better to say than its text.
[[nodiscard]] std::string_view hint_for_errno(int error_number);

/// Opens a regular file for reading. Throws corda::Error (kIo), also for a folder.
[[nodiscard]] FileHandle open_for_reading(const std::string& path);

/// Flushes and closes a file that was written. Throws corda::Error (kIo).
void close_written(FileHandle file, const std::string& path);

/// Forces the bytes of a closed file onto the disk. Throws corda::Error (kIo).
void sync_file(const std::string& path);

/// Renames over whatever stands under `to`. Throws corda::Error (kIo).
void rename_file(const std::string& from, const std::string& to);

/// Forces the folder entry of `path` onto the disk, so that a rename survives a power cut. Throws
/// corda::Error (kIo).
void sync_folder_of(const std::string& path);

/// Removes a file where there is one; never throws.
void remove_quietly(const std::string& path) noexcept;

}  // namespace corda::media
