#include "corda/core/image.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "corda/core/text.hpp"

namespace corda {

namespace {

/// The basic colours of CSS, and the absence of one.
constexpr std::array<std::pair<std::string_view, std::string_view>, 17> kNames{{{"aqua", "#00ffff"},
                                                                                {"black", "#000000"},
                                                                                {"blue", "#0000ff"},
                                                                                {"fuchsia", "#ff00ff"},
                                                                                {"gray", "#808080"},
                                                                                {"green", "#008000"},
                                                                                {"lime", "#00ff00"},
                                                                                {"maroon", "#800000"},
                                                                                {"navy", "#000080"},
                                                                                {"olive", "#808000"},
                                                                                {"purple", "#800080"},
                                                                                {"red", "#ff0000"},
                                                                                {"silver", "#c0c0c0"},
                                                                                {"teal", "#008080"},
                                                                                {"transparent", "#00000000"},
                                                                                {"white", "#ffffff"},
                                                                                {"yellow", "#ffff00"}}};

}  // namespace

std::optional<Color> Color::parse(std::string_view text) {
    const auto* const named =
        std::ranges::find(kNames, lower(text), [](const auto& row) { return row.first; });
    if (named != kNames.end()) text = named->second;
    const std::size_t digits = text.size() < 6 ? 1 : 2;  // of a channel
    if (!text.starts_with('#') || (text.size() != 3 * digits + 1 && text.size() != 4 * digits + 1))
        return std::nullopt;
    std::array<std::uint8_t, 4> channels{0, 0, 0, 255};
    for (std::size_t i = 0; digits * i + 1 < text.size(); ++i) {
        const auto value = whole_number<std::uint8_t>(text.substr(1 + digits * i, digits), 16);
        if (!value) return std::nullopt;
        channels[i] = digits == 1 ? static_cast<std::uint8_t>(17 * *value) : *value;
    }
    return Color{channels[0], channels[1], channels[2], channels[3]};
}

std::string Color::text() const {
    return fmt::format("#{:02x}{:02x}{:02x}{}", r, g, b, a == 255 ? "" : fmt::format("{:02x}", a));
}

}  // namespace corda
