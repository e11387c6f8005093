#pragma once

#include <cstddef>

namespace corda::view {

/// The file of the font, which is part of the program.
[[nodiscard]] const unsigned char* font_begin();
[[nodiscard]] std::size_t font_bytes();

}  // namespace corda::view
