#include "corda/core/image.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "corda/core/css_colors.hpp"
#include "corda/core/text.hpp"

namespace corda {

namespace {

std::optional<Color> css_color(std::string_view text) {
    const std::string name = lower(text);
    if (name == "transparent") return Color{0, 0, 0, 0};
    const auto* const found =
        std::lower_bound(kCssColors.begin(), kCssColors.end(), name,
                         [](const CssColor& color, std::string_view wanted) { return color.name < wanted; });
    if (found == kCssColors.end() || found->name != name) return std::nullopt;
    const auto channel = [&](unsigned shift) {
        return static_cast<std::uint8_t>(found->rgb >> shift & 0xffU);
    };
    return Color{channel(16), channel(8), channel(0), 255};
}

}  // namespace

std::optional<Color> Color::parse(std::string_view text) {
    if (!text.starts_with('#')) return css_color(text);
    if (text.size() != 7 && text.size() != 9) return std::nullopt;
    std::array<std::uint8_t, 4> channels{0, 0, 0, 255};
    for (std::size_t i = 0; 2 * i + 1 < text.size(); ++i) {
        const auto value = whole_number<std::uint8_t>(text.substr(1 + 2 * i, 2), 16);
        if (!value) return std::nullopt;
        channels[i] = *value;
    }
    return Color{channels[0], channels[1], channels[2], channels[3]};
}

std::string Color::text() const {
    return fmt::format("#{:02x}{:02x}{:02x}{}", r, g, b, a == 255 ? "" : fmt::format("{:02x}", a));
}

}  // namespace corda
