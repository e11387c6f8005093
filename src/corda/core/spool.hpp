#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "corda/core/file.hpp"

namespace corda {

/// An array of doubles that may exceed the memory. A large one is in a temporary file without a name, in the
/// folder TMPDIR or /var/tmp (/tmp often is memory). It is read and written by calls, because the pages of a
/// mapped file would count as memory of the process. Several threads may read at once.
class Spool {
  public:
    /// Arrays of more bytes are in a file.
    static constexpr std::size_t kMaxMemory = std::size_t{1} << 30;

    /// `capacity`: the largest size. Space on the disk is allocated here. Throws corda::Error (kIo) without
    /// enough of it.
    explicit Spool(std::size_t capacity, std::size_t max_memory = kMaxMemory);

    /// Writes values from index `first` on, at most up to the capacity.
    void write(std::size_t first, std::span<const double> values);
    /// Reads values that were written.
    void read(std::size_t first, std::span<double> values) const;

    [[nodiscard]] bool is_in_file() const { return static_cast<bool>(file_); }

  private:
    std::vector<double> values_;
    Descriptor file_;
};

}  // namespace corda
