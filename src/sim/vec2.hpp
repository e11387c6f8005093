#pragma once

namespace corda::sim {

/// A point or a vector of the plane: x to the right, y up.
struct Vec2 {
    double x = 0;
    double y = 0;

    friend bool operator==(const Vec2&, const Vec2&) = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) {
    return {a.x + b.x, a.y + b.y};
}
inline Vec2 operator-(Vec2 a, Vec2 b) {
    return {a.x - b.x, a.y - b.y};
}
inline Vec2 operator*(double s, Vec2 v) {
    return {s * v.x, s * v.y};
}
inline double dot(Vec2 a, Vec2 b) {
    return a.x * b.x + a.y * b.y;
}
/// The vector at a right angle to the left of it, of the same length.
inline Vec2 left_of(Vec2 a) {
    return {-a.y, a.x};
}

}  // namespace corda::sim
