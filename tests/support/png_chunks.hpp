#pragma once

#include <string>
#include <string_view>

namespace corda::test {

/// A PNG with one more chunk, before its end.
[[nodiscard]] std::string with_chunk(const std::string& png, std::string_view type, std::string_view data);

}  // namespace corda::test
