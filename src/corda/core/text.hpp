#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "corda/core/basics.hpp"

namespace corda {

/// Throws corda::Error with a message that is formatted as by fmt::format().
template <class... Values>
[[noreturn]] void throw_error(ExitCode code, fmt::format_string<Values...> text, Values&&... values) {
    throw Error(code, fmt::format(text, std::forward<Values>(values)...));
}
/// The same with kUsage.
template <class... Values>
[[noreturn]] void throw_usage(fmt::format_string<Values...> text, Values&&... values) {
    throw_error(ExitCode::kUsage, text, std::forward<Values>(values)...);
}

/// `bytes`, which may be anything, as UTF-8: each byte that is not part of a character becomes its number in
/// hexadecimal, e.g. "\xe9".
[[nodiscard]] std::string utf8(std::string_view bytes);

/// The same with each byte of a control character as its number, e.g. "\x1b": one line that a terminal, a
/// title and XML can show. Line separators and what turns the direction of text (U+202E) count as such.
/// Printable text stays as it is.
[[nodiscard]] std::string printable(std::string_view bytes);
/// The same for each line of a text.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// The character at the start of a text.
struct Character {
    std::size_t bytes = 0;  ///< 0 if there is none: the first byte is not UTF-8
    std::uint32_t number = 0;
};
/// Requires a text that is not empty.
[[nodiscard]] Character first_character(std::string_view text);

/// True for a byte of UTF-8 within a character.
[[nodiscard]] constexpr bool is_continuation(char byte) {
    return (static_cast<unsigned char>(byte) & 0xc0U) == 0x80U;
}

/// A letter of ASCII in lower case; any other byte as it is.
[[nodiscard]] constexpr char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
/// All letters of ASCII in lower case.
[[nodiscard]] std::string lower(std::string_view text);

/// The 64-bit FNV-1a hash of some bytes (by Fowler, Noll and Vo), as 16 hexadecimal digits.
[[nodiscard]] std::string hash_text(std::string_view bytes);

/// The whole number that all of a text is; std::nullopt for any other text.
template <class Number>
[[nodiscard]] std::optional<Number> whole_number(std::string_view text, int base = 10) {
    Number number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, status] = std::from_chars(text.data(), end, number, base);
    return status == std::errc{} && stop == end ? std::optional(number) : std::nullopt;
}

/// "1 bar", "2 bars".
[[nodiscard]] std::string counted(std::int64_t count, const std::string& what);

/// Number of single edits (a character added, removed or changed, or two neighbours swapped) that turn `a`
/// into `b`, ignoring case: the optimal string alignment distance.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate that someone who wrote `word` most likely meant; std::nullopt if none is close. Close is at
/// most a third of the letters wrong, the word being the beginning of the candidate, or the candidate that of
/// the word and half of it.
[[nodiscard]] std::optional<std::string_view> nearest(std::string_view word,
                                                      std::span<const std::string_view> candidates);

/// The version of Corda, "1.2.3".
[[nodiscard]] std::string_view version();

}  // namespace corda
