#include "corda/core/text.hpp"

#include <cstddef>
#include <cstdint>

namespace corda {
namespace {

/// The character at the start of a text.
struct Character {
    std::size_t bytes = 0;  ///< 0 if there is none: the first byte is not UTF-8
    std::uint32_t number = 0;

    /// Also what separates lines and what turns the direction of the text after it.
    [[nodiscard]] bool is_control() const {
        return number < 0x20 || (number >= 0x7f && number < 0xa0) || (number >= 0x2028 && number <= 0x202e) ||
               (number >= 0x2066 && number <= 0x2069);
    }
};

Character first_character(std::string_view text) {
    const auto byte = [text](std::size_t i) { return static_cast<std::uint32_t>(text[i]) & 0xffU; };
    const std::uint32_t lead = byte(0);
    if (lead < 0x80) return {1, lead};
    const std::size_t bytes = lead < 0xe0 ? 2 : (lead < 0xf0 ? 3 : 4);
    if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
    std::uint32_t number = lead & (0x7fU >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0U) != 0x80U) return {};
        number = number << 6U | (byte(i) & 0x3fU);
    }
    const bool is_too_long = (bytes == 3 && number < 0x800) || (bytes == 4 && number < 0x10000);
    const bool is_character =
        (number < 0xd800 || number > 0xdfff) && number <= 0x10ffff && number != 0xfffe && number != 0xffff;
    return is_too_long || !is_character ? Character{} : Character{bytes, number};
}

void add_escaped(std::string_view bytes, std::string& text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        text += "\\x";
        text += kDigits[byte >> 4U];
        text += kDigits[byte & 15U];
    }
}

std::string escaped(std::string_view bytes, bool control_characters) {
    std::string text;
    while (!bytes.empty()) {
        const Character character = first_character(bytes);
        const std::string_view taken = bytes.substr(0, character.bytes == 0 ? 1 : character.bytes);
        if (character.bytes == 0 || (control_characters && character.is_control())) {
            add_escaped(taken, text);
        } else {
            text += taken;
        }
        bytes.remove_prefix(taken.size());
    }
    return text;
}

}  // namespace

std::string utf8(std::string_view bytes) {
    return escaped(bytes, false);
}

std::string printable(std::string_view bytes) {
    return escaped(bytes, true);
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = lower(c);
    return result;
}

std::string hash_text(std::string_view bytes) {
    std::uint64_t hash = 14695981039346656037U;
    for (const char byte : bytes) {
        hash ^= static_cast<unsigned char>(byte);
        hash *= 1099511628211U;
    }
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (int shift = 60; shift >= 0; shift -= 4) text += kDigits[hash >> static_cast<unsigned>(shift) & 15U];
    return text;
}

std::string counted(std::int64_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace corda
