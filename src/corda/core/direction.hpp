#pragma once

namespace corda {

/// The direction of an angle.
struct Direction {
    double sine = 0.0;
    double cosine = 1.0;
};

/// The direction of an angle in degrees, of any finite size; exactly 0 and 1 at multiples of 90. Otherwise
/// sine and cosine of the angle in radians, rounded once. They are computed from +, -, * and fused
/// multiply-add, whose results IEEE 754 fixes: std::sin and std::cos of the C library have other last bits on
/// a CPU without FMA.
[[nodiscard]] Direction direction_of(double angle_deg);

/// The angle of (x, y) from +x in radians, -pi .. pi, to within 4e-16 of a turn; 0 for (0, 0). Like
/// std::atan2, but computed from +, -, *, / and square roots alone, for the same reason.
[[nodiscard]] double angle_rad(double y, double x);

}  // namespace corda
