#include "corda/sim/exact/chain_closing.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace corda::sim {
namespace {

/// A chain between two pins whose length exceeds their distance by less than this share is taut: its tensions
/// are not determined.
constexpr double kTaut = 1e-12;

/// Newton steps that close a chain between two pins, all with the matrix of the first. Each step multiplies
/// the gap by about its size relative to the chain, at most 1e-4.
constexpr int kClosingSteps = 4;

/// The symmetric 2 x 2 matrix for closing a chain, the sum of a_i p_i p_i^T, plus a small multiple of the
/// identity: links in one line cannot move their end along it and must stay unchanged.
struct ClosingMatrix {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;

    void add(double length_m, Vec2 across) {
        xx += length_m * across.x * across.x;
        xy += length_m * across.x * across.y;
        yy += length_m * across.y * across.y;
    }
    /// The determinant in parts of the squared trace.
    [[nodiscard]] double regularity() const { return (xx * yy - xy * xy) / ((xx + yy) * (xx + yy)); }
    [[nodiscard]] Vec2 solve(Vec2 right) const {
        const double extra = 1e-14 * (xx + yy);
        const double x1 = xx + extra;
        const double y1 = yy + extra;
        const double determinant = x1 * y1 - xy * xy;
        return {(y1 * right.x - xy * right.y) / determinant, (x1 * right.y - xy * right.x) / determinant};
    }
};

}  // namespace

void refuse_taut_between_pins(double length_m, Vec2 span_m, std::size_t from, std::size_t to) {
    if (length_m - length(span_m.x, span_m.y) > kTaut * length_m) return;
    throw Refusal(Refusal::Reason::kTautBetweenPins,
                  "method exact cannot work out the tensions of a rope that is taut between two pins "
                  "(particles " +
                      std::to_string(from) + " and " + std::to_string(to) + ", " + std::to_string(length_m) +
                      " m apart)");
}

Span span_at(const Chains& chains, const Chain& chain, double time_s) {
    const Chains::Pin& from = chains.pins[chain.start_pin];
    const Chains::Pin& to = chains.pins[chain.end_pin];
    return {chain.span_m + (to.displacement(time_s) - from.displacement(time_s)),
            to.velocity(time_s) - from.velocity(time_s)};
}

void close_between_pins(const Chains& chains, const Chain& chain, double time_s, double* y) {
    const std::size_t links = chains.link_count();
    const std::size_t end = chain.first_link + chain.link_count;
    const auto direction = [&](std::size_t i) { return Vec2{y[i], y[links + i]}; };
    const auto [span_m, velocity_m_s] = span_at(chains, chain, time_s);
    if (dot(span_m, span_m) > chain.length_m * chain.length_m) {
        y[chain.first_link] = std::numeric_limits<double>::quiet_NaN();
        return;
    }
    ClosingMatrix matrix;
    for (std::size_t i = chain.first_link; i < end; ++i)
        matrix.add(chains.length_m[i], left_of(direction(i)));
    for (int k = 0; k < kClosingSteps; ++k) {
        Vec2 open = span_m;
        for (std::size_t i = chain.first_link; i < end; ++i) open = open - chains.length_m[i] * direction(i);
        const Vec2 multiplier = matrix.solve(open);
        for (std::size_t i = chain.first_link; i < end; ++i) {
            const Vec2 across = left_of(direction(i));
            const Vec2 turned = direction(i) + dot(across, multiplier) * across;
            const double inverse = 1.0 / length(turned.x, turned.y);
            y[i] = inverse * turned.x;
            y[links + i] = inverse * turned.y;
        }
    }
    Vec2 open = velocity_m_s;
    for (std::size_t i = chain.first_link; i < end; ++i) {
        open = open - (chains.length_m[i] * y[2 * links + i]) * left_of(direction(i));
    }
    const Vec2 multiplier = matrix.solve(open);
    for (std::size_t i = chain.first_link; i < end; ++i)
        y[2 * links + i] += dot(left_of(direction(i)), multiplier);
}

double spread(const Chains& chains, const Chain& chain, const double* y) {
    ClosingMatrix matrix;
    for (std::size_t i = chain.first_link; i < chain.first_link + chain.link_count; ++i)
        matrix.add(chains.length_m[i], {y[i], y[chains.link_count() + i]});
    return matrix.regularity();
}

}  // namespace corda::sim
