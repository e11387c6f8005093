#pragma once

#include <string_view>

namespace corda {

/// The version of Corda, "1.2.3".
[[nodiscard]] std::string_view version();

}  // namespace corda
