#include "corda/scene/field.hpp"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace corda::scene {

std::string number_text(double value) {
    if (value == 0.0) return std::signbit(value) ? "-0.0" : "0";
    std::string plain = fmt::format("{}", value);
    constexpr double kMaxPlain = 1e5;
    constexpr double kMinPlain = 1e-3;
    const double size = std::abs(value);
    if (!std::isfinite(value) || (size < kMaxPlain && size >= kMinPlain)) return plain;
    // "1e-09" and "1e+06" become "1e-9" and "1e6".
    std::string scientific = fmt::format("{:g}", value);
    double read = 0.0;
    std::from_chars(scientific.data(), scientific.data() + scientific.size(), read);
    if (read != value) scientific = plain;
    const std::size_t e = scientific.find('e');
    if (e == std::string::npos) return plain;
    std::size_t digits = e + 1;
    if (scientific[digits] == '+') scientific.erase(digits, 1);
    if (scientific[digits] == '-') ++digits;
    while (scientific[digits] == '0') scientific.erase(digits, 1);
    return scientific.size() < plain.size() ? scientific : plain;
}

std::string toml_text(double value) {
    return number_text(value);
}

std::string toml_text(std::string_view value) {
    std::string text = "\"";
    for (const char c : value) {
        if (c == '"' || c == '\\') text += '\\';
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            text += c;
    }
    return text + '"';
}

std::string toml_text(Vec2 value) {
    return fmt::format("[{}, {}]", number_text(value.x), number_text(value.y));
}

std::string toml_text(Color value) {
    return toml_text(value.text());
}

std::string toml_text(const Ground& value) {
    if (value.top == value.bottom) return toml_text(value.top);
    return fmt::format("[{}, {}]", toml_text(value.top), toml_text(value.bottom));
}

std::string toml_text(const Interval& value) {
    return toml_text(Vec2{value.low, value.high});
}

std::string toml_text(const Rational& value) {
    return value.den == 1 ? toml_text(value.num) : toml_text(value.text());
}

std::string toml_text(const FrameRate& value) {
    return toml_text(value.rational());
}

std::string toml_text(const NetBar& value) {
    // No file can give an imaginary bar by itself; write_scene() refuses it.
    return fmt::format("[{}, {}{}]", value.a, value.b, value.is_real ? "" : ", \"imaginary\"");
}

std::string toml_text(const WaveDef& value) {
    return fmt::format("{{ amplitude = {}, frequency = {}, phase_deg = {} }}", toml_text(value.amplitude),
                       toml_text(value.frequency_hz), toml_text(value.phase_deg));
}

std::string toml_text(const PathKeyDef& value) {
    return fmt::format("{{ t = {}, by = {} }}", toml_text(value.time_s), toml_text(value.by_m));
}

std::string toml_text(const MoveDef& value) {
    std::string text = fmt::format("{{ pin = {}", value.pin);
    if (!value.waves.empty()) text += ", waves = " + toml_text(value.waves);
    if (!value.path.empty()) text += ", path = " + toml_text(value.path);
    return text + " }";
}

std::string toml_text(const ReleaseDef& value) {
    return fmt::format("{{ pin = {}, t = {} }}", value.pin, toml_text(value.time_s));
}

std::string toml_text(const CutDef& value) {
    return fmt::format("{{ link = {}, t = {} }}", value.link, toml_text(value.time_s));
}

}  // namespace corda::scene
