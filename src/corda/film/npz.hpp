#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/file.hpp"

namespace corda {

/// An array of float64 or float32, the last index fastest.
struct NpyArray {
    std::vector<std::size_t> shape;
    std::string bytes;             ///< of the file NAME.npy
    std::size_t first = 0;         ///< the first byte of its numbers
    std::size_t number_bytes = 8;  ///< of one: 8 or 4

    /// `numbers`: room for all as double.
    void copy_to(void* numbers) const;
};

/// An .npz of NumPy, packed or not: a zip file of arrays. Untrusted: whatever its bytes say, it takes no more
/// memory than they do, and arrays no more than a limit.
class Npz {
  public:
    /// The file, which is at `path`, must outlive it. `most`: the bytes of an array. Throws corda::Error
    /// (kUsage) if it is damaged.
    Npz(const FileHandle& file, const std::string& path, std::size_t most);

    /// Throws corda::Error (kUsage) if there is no such array of float64 or float32 in C order, or it is
    /// damaged.
    [[nodiscard]] NpyArray read(const std::string& name) const;

  private:
    [[noreturn]] void fail(const std::string& what, const std::string& remedy,
                           const std::string& name = {}) const;
    [[noreturn]] void fail_damaged(const std::string& reason) const;
    void seek(std::size_t at, int from) const;
    [[nodiscard]] std::string bytes_at(std::size_t at, std::size_t count) const;
    [[nodiscard]] std::string file_of(const std::string& name) const;
    [[nodiscard]] std::string unpacked(std::size_t entry, const std::string& name) const;
    [[nodiscard]] std::string inflated(std::size_t packed, std::size_t size, bool is_deflated,
                                       const std::string& name) const;
    [[nodiscard]] std::vector<std::size_t> shape_of(std::string_view header, const std::string& name) const;

    const FileHandle& file_;
    const std::string& path_;
    std::size_t most_;
    std::string list_;  ///< the zip's list of its files
};

}  // namespace corda
