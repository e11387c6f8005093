#include "corda/core/text.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace corda {
namespace {

/// Also what separates lines and what turns the direction of the text after it.
bool is_control(std::uint32_t character) {
    return character < 0x20 || (character >= 0x7f && character < 0xa0) ||
           (character >= 0x2028 && character <= 0x202e) || (character >= 0x2066 && character <= 0x2069);
}

std::string escaped(std::string_view bytes, bool control_characters) {
    std::string text;
    while (!bytes.empty()) {
        Character character = first_character(bytes);
        if ((character.number | 1U) == 0xffff) character = {};  // XML has neither U+FFFE nor U+FFFF
        const std::string_view taken = bytes.substr(0, character.bytes == 0 ? 1 : character.bytes);
        if (character.bytes == 0 || (control_characters && is_control(character.number))) {
            for (const char c : taken) text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        } else {
            text += taken;
        }
        bytes.remove_prefix(taken.size());
    }
    return text;
}

constexpr std::size_t kMaxWord = 64;  // longer than any candidate; bounds the work on hostile input
constexpr std::size_t kMinPrefix = 3;

/// Whether a word is the beginning of a candidate, or a candidate of which it has half and more.
bool is_prefix(std::string_view word, std::string_view candidate) {
    if (std::min(word.size(), candidate.size()) < kMinPrefix) return false;
    return candidate.starts_with(word) ||
           (word.starts_with(candidate) && 2 * candidate.size() >= word.size());
}

}  // namespace

std::string Place::text() const {
    std::string text = source;
    if (line > 0) text += fmt::format(":{}:{}", line, column);
    return text + (text.empty() || key.empty() ? "" : ": ") + key;
}

std::string Problem::text() const {
    const std::string begin = place.text();
    return begin + (begin.empty() ? "" : ": ") + what + (remedy.empty() ? "" : "; ") + remedy;
}

Error::Error(ExitCode code, std::vector<Problem> problems)
    : std::runtime_error([&] {
          std::string text;
          for (const Problem& problem : problems) text += (text.empty() ? "" : "\n") + problem.text();
          return text;
      }()),
      code_(code),
      problems_(std::make_shared<const std::vector<Problem>>(std::move(problems))) {}

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
    const bool is_character = (number < 0xd800 || number > 0xdfff) && number <= 0x10ffff;
    return is_too_long || !is_character ? Character{} : Character{bytes, number};
}

std::string utf8(std::string_view bytes) {
    return escaped(bytes, false);
}

std::string printable_lines(std::string_view text) {
    std::string lines;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        lines += (begin > 0 ? "\n" : "") + printable(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
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
    return fmt::format("{:016x}", hash);
}

std::string counted(std::int64_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before_last(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before_last.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            const bool swapped =
                i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
    }
    return row[b.size()];
}

std::optional<std::string_view> nearest(std::string_view word, std::span<const std::string_view> candidates) {
    if (word.empty() || word.size() > kMaxWord) return std::nullopt;
    std::optional<std::string_view> closest;
    std::size_t smallest = std::numeric_limits<std::size_t>::max();
    for (const std::string_view candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        const std::size_t least = std::max(word.size(), candidate.size()) < 3 ? 0 : 1;
        const std::size_t close = std::max(least, std::min(word.size(), candidate.size()) / 3);
        if (distance < smallest && (distance <= close || is_prefix(word, candidate))) {
            smallest = distance;
            closest = candidate;
        }
    }
    return closest;
}

std::string_view version() {
    return CORDA_VERSION;
}

}  // namespace corda
