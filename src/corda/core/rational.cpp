#include "corda/core/rational.hpp"

#include <cmath>
#include <numeric>

#include "corda/core/text.hpp"

namespace corda {
namespace {

constexpr double kFrameTolerance = 1e-9;  // relative to the frame number, at least to one frame

std::optional<std::int64_t> parse_part(std::string_view text) {
    const auto value = whole_number<std::int64_t>(text);
    return value && *value >= 0 && *value <= Rational::kMaxPart ? value : std::nullopt;
}

double tolerance_at(double frames) {
    return kFrameTolerance * std::max(1.0, std::abs(frames));
}

}  // namespace

std::optional<Rational> Rational::parse(std::string_view text) {
    const auto slash = text.find('/');
    const auto num = parse_part(text.substr(0, slash));
    const auto den =
        slash == std::string_view::npos ? std::optional<std::int64_t>{1} : parse_part(text.substr(slash + 1));
    if (!num || !den || *den == 0) return std::nullopt;
    return reduced(*num, *den);
}

Rational Rational::reduced(std::int64_t num, std::int64_t den) {
    const std::int64_t divisor = std::gcd(num, den) * (den < 0 ? -1 : 1);
    return {num / divisor, den / divisor};
}

std::string Rational::text() const {
    return den == 1 ? std::to_string(num) : std::to_string(num) + "/" + std::to_string(den);
}

std::int64_t FrameRate::frame_count(double duration_s) const {
    const double frames = duration_s * per_second();
    return static_cast<std::int64_t>(std::ceil(frames - tolerance_at(frames)));
}

std::int64_t FrameRate::last_frame_within(double duration_s) const {
    const double frames = duration_s * per_second();
    return static_cast<std::int64_t>(std::floor(frames + tolerance_at(frames)));
}

}  // namespace corda
