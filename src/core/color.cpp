#include "corda/core/image.hpp"

#include <array>
#include <charconv>
#include <cstddef>

namespace corda {

std::optional<Color> Color::parse(std::string_view text) {
    if (text == "transparent") return Color{0, 0, 0, 0};
    if ((text.size() != 7 && text.size() != 9) || text.front() != '#') return std::nullopt;
    std::array<std::uint8_t, 4> channels{0, 0, 0, 255};
    for (std::size_t i = 0; 2 * i + 1 < text.size(); ++i) {
        const char* begin = text.data() + 1 + 2 * i;
        unsigned value = 0;
        const auto [stop, status] = std::from_chars(begin, begin + 2, value, 16);
        if (status != std::errc{} || stop != begin + 2) return std::nullopt;
        channels[i] = static_cast<std::uint8_t>(value);
    }
    return Color{channels[0], channels[1], channels[2], channels[3]};
}

std::string Color::text() const {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string result = "#";
    for (const std::uint8_t channel : {r, g, b, a}) {
        if (result.size() == 7 && channel == 255) break;
        result += kDigits[channel >> 4U];
        result += kDigits[channel & 15U];
    }
    return result;
}

}  // namespace corda
