#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#pragma GCC visibility push(default)
namespace corda {

/// A point or a vector in the plane: x to the right, y up.
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
/// The vector turned left by a right angle.
inline Vec2 left_of(Vec2 a) {
    return {-a.y, a.x};
}

/// amplitude * sin(2 pi frequency t + phase).
struct WaveDef {
    static constexpr double kMaxFrequencyHz = 1000.0;

    Vec2 amplitude;             ///< finite
    double frequency_hz = 1.0;  ///< > 0, <= kMaxFrequencyHz
    double phase_deg = 0.0;     ///< finite

    friend bool operator==(const WaveDef&, const WaveDef&) = default;
};

/// A place on the way of a pin, at which it rests for a moment.
struct PathKeyDef {
    double time_s = 0.0;  ///< >= 0
    Vec2 by_m;            ///< displacement from the place at the start

    friend bool operator==(const PathKeyDef&, const PathKeyDef&) = default;
};

/// How a pinned particle moves: displacements from its place at the start. No two of a body are for one pin.
struct MoveDef {
    std::uint32_t pin = 0;       ///< index of the particle, one of `pinned`
    std::vector<WaveDef> waves;  ///< in metres, each less its value at t = 0
    /// The way of least jerk from key to key, at rest at each. Times increase; the first key is at the
    /// start's place.
    std::vector<PathKeyDef> path;

    friend bool operator==(const MoveDef&, const MoveDef&) = default;
};

/// A pinned particle that is free from a time on. No two of a body are for one pin.
struct ReleaseDef {
    std::uint32_t pin = 0;  ///< index of the particle, one of `pinned`
    double time_s = 0.0;    ///< >= 0

    friend bool operator==(const ReleaseDef&, const ReleaseDef&) = default;
};

/// A link that is gone from a time on. No two of a body are for one link.
struct CutDef {
    std::uint32_t link = 0;  ///< link k of a rope joins particles k and k + 1; of a net, the index of the bar
    double time_s = 0.0;     ///< >= 0

    friend bool operator==(const CutDef&, const CutDef&) = default;
};

/// The forces on all bodies of a scene, and its duration.
struct WorldDef {
    Vec2 gravity_m_s2{0.0, -9.81};  ///< acceleration of every free particle; finite
    double duration_s = 10.0;       ///< > 0
    double drag_1_s = 0.0;          ///< linear drag: acceleration -drag (v - wind - gusts); >= 0
    Vec2 wind_m_s = {};             ///< velocity of the air; finite
    WaveDef gusts = {};             ///< added to the wind, in m/s
};

/// Material of a body's bars. Rigid by default.
struct MaterialDef {
    /// Strain of a bar per newton of tension, 1 / (E A), in 1/N: the bars stretch by Hooke's law; 0: rigid
    /// bars.
    double compliance_1_n = 0.0;
    /// Bars pull and never push. When a rigid bar comes taut, the snap is plastic: momentum is kept, and the
    /// relative velocity along the bar vanishes (a string). A bar with compliance exerts no force while it is
    /// shorter than its rest length (a bungee).
    bool is_string = false;
};

/// A chain of particles, each joined to the next by a bar.
struct RopeDef {
    /// Origin of `points_m`, in metres. Kept separate so that a rope far from (0, 0) has the same bits as one
    /// at (0, 0).
    Vec2 origin_m;
    std::vector<Vec2> points_m;   ///< initial positions relative to `origin_m`; at least 2, neighbours apart
    std::vector<double> mass_kg;  ///< one per particle, > 0 (pinned ones too); empty: 1 kg each
    std::vector<Vec2> velocity_m_s;  ///< one per particle at t = 0; empty: 0. Ignored for pinned particles
    /// Indices of the particles that never move or as `moves` say, each < points_m.size().
    std::vector<std::uint32_t> pinned{0};
    std::vector<MoveDef> moves = {};
    std::vector<ReleaseDef> releases = {};
    std::vector<CutDef> cuts = {};  ///< of a closed rope at most one
    double payload_kg = 0.0;        ///< added to the mass of the last particle; >= 0
    /// Each particle is joined to the next 1 .. reach particles; >= 1. Bars of reach 1 are the rope's links.
    /// Longer ones are imaginary: they stiffen the rope, and only method `relaxation` can move them.
    int reach = 1;
    bool closed = false;  ///< the last particle is joined to the first one too; needs at least 3
    /// Rest lengths, one per link (the closing link last), > 0; empty: the initial distances. Other lengths
    /// suit materials that stretch, and strings: see pulled_in().
    std::vector<double> rest_m;
    MaterialDef material;
    /// Bending stiffness E I in N m^2, >= 0: every inner particle has the energy E I / a (1 - cos(angle)),
    /// where a is the mean of the two links' rest lengths; 0: perfectly flexible. A link between two pins
    /// clamps its neighbours.
    double bending_n_m2 = 0.0;
};

/// A bar of a net between particles `a` and `b`.
struct NetBar {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    bool is_real = true;  ///< false: it stiffens the net and is not part of it (a diagonal)

    friend bool operator==(const NetBar&, const NetBar&) = default;
};

/// Particles and bars in any graph, e.g. a cloth.
struct NetDef {
    Vec2 origin_m;                   ///< see RopeDef
    std::vector<Vec2> points_m;      ///< relative to `origin_m`; at least 2
    std::vector<double> mass_kg;     ///< one per particle, > 0; empty: 1 kg each
    std::vector<Vec2> velocity_m_s;  ///< one per particle; empty: 0
    std::vector<NetBar> bars;        ///< in the order of relaxation, real ones first; a != b, no pair twice
    std::vector<std::uint32_t> pinned;
    MaterialDef material;
    std::vector<MoveDef> moves = {};
    std::vector<ReleaseDef> releases = {};
    std::vector<CutDef> cuts = {};  ///< of real bars
};

/// Method `exact`: adaptive and of high order.
struct ExactDef {
    static constexpr std::string_view kName = "exact";
    static constexpr double kMinTolerance = 1e-15;
    static constexpr double kMaxTolerance = 1e-2;

    /// Error of the positions after some seconds, relative to the rope's length; kMinTolerance ..
    /// kMaxTolerance.
    double tolerance = 1e-9;
    /// Implicit steps, for long or stiff ropes that hang from pins: their number follows from the tolerance
    /// and not from the number of links.
    bool implicit = false;

    friend bool operator==(const ExactDef&, const ExactDef&) = default;
};

/// Method `rattle`: RATTLE at a fixed step, composed to a higher order.
struct RattleDef {
    static constexpr std::string_view kName = "rattle";
    static constexpr std::array<int, 4> kOrders{2, 4, 6, 8};

    int order = 4;                      ///< one of kOrders
    std::optional<double> step_s = {};  ///< > 0; default: a stable step that divides the frame interval
    /// Limit of the largest frequency times the step, as a share of the stability limit; 0 < guard <= 1.
    /// Steps are divided to stay below it. Energy drifts long before 1 when a free end whips: 50 links from
    /// the horizontal, 60 s, order 8 give an energy error over m g L of 7e-2 at 0.9, 2e-3 at 0.5, 6e-5 at
    /// 0.3, 3e-6 at 0.2, 1e-8 at 0.1.
    double guard = 0.2;

    friend bool operator==(const RattleDef&, const RattleDef&) = default;
};

/// Method `relaxation` of the source report.
struct RelaxationDef {
    static constexpr std::string_view kName = "relaxation";

    std::optional<double> step_s = {};  ///< > 0; default: the frame interval
    int sweeps = 1;                     ///< passes over all bars per step; >= 1
    double delta = 0.0;                 ///< share of the velocity lost per step; 0 <= delta < 1
    std::optional<Vec2> force_n = {};   ///< force per particle in place of gravity; finite

    friend bool operator==(const RelaxationDef&, const RelaxationDef&) = default;
};

/// A method with its parameters.
using MethodDef = std::variant<ExactDef, RattleDef, RelaxationDef>;

/// The name a scene file uses for a method.
[[nodiscard]] inline std::string_view method_name(const MethodDef& method) {
    return std::visit([](const auto& def) { return std::decay_t<decltype(def)>::kName; }, method);
}

}  // namespace corda
#pragma GCC visibility pop

namespace corda::sim {

/// The length of (dx, dy). One definition for rest lengths and for distances on the way, so that a bar of
/// unchanged ends has no strain to the last bit. Not std::hypot, whose rounding differs between C libraries.
[[nodiscard]] inline double length(double dx, double dy) {
    return std::sqrt(dx * dx + dy * dy);
}

}  // namespace corda::sim
