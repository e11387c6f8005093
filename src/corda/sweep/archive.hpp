#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "corda/sweep/sample.hpp"

namespace corda::sweep {

/// An ordinary file in a tar (POSIX.1-1988, ustar), of user 0, mode 0644 and time 0, so that the same file
/// gives the same bytes. `name` has at most 100 bytes, `bytes` at most 8 GiB - 1.
[[nodiscard]] std::string tar_entry(const std::string& name, std::string_view bytes);

/// Two empty blocks, with which a tar ends.
[[nodiscard]] std::string tar_end();

inline constexpr std::string_view kFewerLabels =
    "leave out some of output.labels, or the frames (output.pictures)";

/// Arrays as numpy.load() reads them from an .npz file. Those of bytes are compressed. Throws corda::Error:
/// kUsage with `remedy` if they are over 4 GiB, kTemporary.
[[nodiscard]] std::string npz_bytes(const std::vector<Array>& arrays, std::string_view remedy = kFewerLabels);

}  // namespace corda::sweep
