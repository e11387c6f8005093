#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace corda::scene {

/// Number of single edits (a character added, lost, changed, or two neighbours swapped) that turn `a` into
/// `b`; upper and lower case count as the same. This is the optimal string alignment distance.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate that someone who wrote `word` most likely meant; nothing where none is close. Close is a
/// third of the letters wrong, or a word that the candidate begins with or that begins with the candidate.
[[nodiscard]] std::optional<std::string_view> nearest_key(std::string_view word,
                                                          std::span<const std::string_view> candidates);

}  // namespace corda::scene
