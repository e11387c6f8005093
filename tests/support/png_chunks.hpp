#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace corda::test {

/// A PNG with one more chunk, before the first one of type `before`.
[[nodiscard]] std::string with_chunk(const std::string& png, std::string_view type, std::string_view data,
                                     std::string_view before = "IEND");

/// A PNG without its chunks of these types.
[[nodiscard]] std::string without_chunks(const std::string& png, const std::vector<std::string>& types);

}  // namespace corda::test
