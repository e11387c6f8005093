#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>

#include "corda/core/basics.hpp"

namespace corda::scene {

/// Parts that a dotted key may have. The scene format needs 3; the TOML parser and its tree recurse once per
/// part.
inline constexpr int kKeyParts = 32;

/// Parses TOML text. Throws kInvalidScene with `source_name`:line:column and the parser's description, and
/// kInterrupted if `on_progress` asks to stop.
[[nodiscard]] toml::table parse_document(std::string_view text, const std::string& source_name,
                                         const OnProgress& on_progress = {});

/// A dotted key of too many parts, as an offset into the TOML text; npos if there is none.
[[nodiscard]] std::size_t find_deep_key(std::string_view text);

}  // namespace corda::scene
