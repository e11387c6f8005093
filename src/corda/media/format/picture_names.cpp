#include "corda/core/text.hpp"
#include "corda/media/format/format.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace corda::media {
namespace {

/// A name of pictures, split at the number.
struct Names {
    std::string before;
    std::string after;
    int digits = 0;
};

/// Returns the size of the number that `text` begins with, "%d" or "%0Nd", and its digits; 0 for other text.
std::pair<std::size_t, int> number_at(std::string_view text) {
    if (text.starts_with("%d")) return {2, 1};
    const bool has_digits =
        text.size() >= 4 && text[1] == '0' && text[2] >= '1' && text[2] <= '9' && text[3] == 'd';
    return has_digits ? std::pair<std::size_t, int>{4, text[2] - '0'} : std::pair<std::size_t, int>{0, 0};
}

/// Reads the last part of a path, in which "%%" is a per cent sign; std::nullopt if it does not have exactly
/// one number, or has another per cent sign.
std::optional<Names> names_of(std::string_view form) {
    Names names;
    for (std::size_t i = 0; i < form.size();) {
        std::string& text = names.digits == 0 ? names.before : names.after;
        if (form[i] != '%') {
            text.push_back(form[i++]);
        } else if (form.substr(i).starts_with("%%")) {
            text.push_back('%');
            i += 2;
        } else {
            const auto [size, digits] = number_at(form.substr(i));
            if (size == 0 || names.digits != 0) return std::nullopt;
            names.digits = digits;
            i += size;
        }
    }
    return names.digits == 0 ? std::nullopt : std::optional(std::move(names));
}

/// The folder of a path, with its slash, in which a per cent sign is one; and the name.
std::pair<std::string_view, std::string_view> split(std::string_view pattern) {
    const std::size_t slash = pattern.rfind('/');
    const std::size_t begin = slash == std::string_view::npos ? 0 : slash + 1;
    return {pattern.substr(0, begin), pattern.substr(begin)};
}

}  // namespace

void check_picture_names(std::string_view pattern) {
    if (names_of(split(pattern).second)) return;
    throw_usage(
        "'{}': a video as pictures needs the number of each in its name, once, as %d or %04d, and %% for a "
        "per cent sign; use e.g. frames/%04d.png (`corda still` draws one picture)",
        pattern);
}

std::string picture_name(std::string_view pattern, std::int64_t frame) {
    const auto [folder, form] = split(pattern);
    const Names names = names_of(form).value();
    return fmt::format("{}{}{:0{}}{}", folder, names.before, frame, names.digits, names.after);
}

bool is_picture_name(std::string_view pattern, std::string_view name) {
    const Names names = names_of(split(pattern).second).value();
    const std::size_t around = names.before.size() + names.after.size();
    if (name.size() < around || !name.starts_with(names.before) || !name.ends_with(names.after)) return false;
    const std::string_view digits = name.substr(names.before.size(), name.size() - around);
    return digits.size() >= static_cast<std::size_t>(names.digits) &&
           digits.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace corda::media
