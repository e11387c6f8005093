#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace corda {

/// An sRGB colour with straight alpha, 0..255 a channel.
struct Color {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    std::uint8_t a = 255;

    /// Reads "#rrggbb" or "#rrggbbaa"; nothing for any other text.
    static std::optional<Color> parse(std::string_view text);

    /// "#rrggbb", or "#rrggbbaa" where it is not opaque.
    [[nodiscard]] std::string text() const;

    friend bool operator==(const Color&, const Color&) = default;
};

}  // namespace corda
