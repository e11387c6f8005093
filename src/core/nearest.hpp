#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace corda {

/// Number of single edits (a character added, removed or changed, or two neighbours swapped) that turn `a`
/// into `b`, ignoring case: the optimal string alignment distance.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate that someone who wrote `word` most likely meant; std::nullopt if none is close. Close is at
/// most a third of the letters wrong, the word being the beginning of the candidate, or the candidate that of
/// the word and half of it.
[[nodiscard]] std::optional<std::string_view> nearest(std::string_view word,
                                                      std::span<const std::string_view> candidates);

}  // namespace corda
