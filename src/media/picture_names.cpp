#include "corda/media/picture_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "corda/core/basics.hpp"

namespace corda::media {
namespace {

/// A number's place in a name.
struct Place {
    std::size_t begin = 0;
    std::size_t size = 0;
    int digits = 0;
};

/// The only one of a name; std::nullopt if there is none, or anything else with a percent sign.
std::optional<Place> place_in(std::string_view name) {
    const std::size_t begin = name.find('%');
    if (begin == std::string_view::npos || name.find('%', begin + 1) != std::string_view::npos)
        return std::nullopt;
    const std::string_view rest = name.substr(begin + 1);
    if (rest.starts_with('d')) return Place{begin, 2, 1};
    const bool has_digits =
        rest.size() >= 3 && rest[0] == '0' && rest[1] >= '1' && rest[1] <= '9' && rest[2] == 'd';
    return has_digits ? std::optional(Place{begin, 4, rest[1] - '0'}) : std::nullopt;
}

}  // namespace

void check_picture_names(std::string_view pattern) {
    const std::filesystem::path path(pattern);
    const bool is_in_name = path.parent_path().string().find('%') == std::string::npos;
    if (is_in_name && place_in(path.filename().string())) return;
    throw Error(
        ExitCode::kUsage,
        fmt::format(
            "'{}': a video as pictures needs the number of each in its name, once, as %d or %04d; use e.g. "
            "frames/%04d.png (`corda still` draws one picture)",
            pattern));
}

std::string picture_name(std::string_view pattern, std::int64_t frame) {
    const Place place = place_in(pattern).value();
    return fmt::format("{}{:0{}}{}", pattern.substr(0, place.begin), frame, place.digits,
                       pattern.substr(place.begin + place.size));
}

bool is_picture_name(std::string_view pattern, std::string_view name) {
    const std::string form = std::filesystem::path(pattern).filename().string();
    const Place place = *place_in(form);
    const std::string_view before = std::string_view(form).substr(0, place.begin);
    const std::string_view after = std::string_view(form).substr(place.begin + place.size);
    if (name.size() < before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after))
        return false;
    const std::string_view digits = name.substr(before.size(), name.size() - before.size() - after.size());
    return digits.size() >= static_cast<std::size_t>(place.digits) &&
           digits.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace corda::media
