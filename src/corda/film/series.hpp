#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::film {

struct Motion;

/// Maximum number of bodies whose curves one figure shows.
inline constexpr std::size_t kMaxBodies = 6;

/// A particle that represents the motion of its body: the free end of an open rope (the last one if both are
/// free), the middle one of the free particles of another rope, or the free particle of a net that is closest
/// to the mean of their positions at the start.
struct TrackedParticle {
    std::size_t body = 0;
    std::size_t particle = 0;  ///< of the system
    bool is_free_end = true;
    std::optional<std::size_t> pin = {};  ///< the only pinned particle of the body, of the system
};

/// The tracked particles of the first `most` bodies that have free particles.
[[nodiscard]] std::vector<TrackedParticle> tracked_particles(const System& system,
                                                             std::size_t most = kMaxBodies);

/// Within this share of its body's length from its pin, a tracked particle has no angle worth showing.
inline constexpr double kNearPin = 0.1;

/// Angle of the way from the pin of a tracked particle, which must have one, in rad from straight down,
/// positive towards +x, and its rate in rad/s, as x and y. Turns are counted on from the point of an earlier
/// state, if there is one, by the rate: between two states, a fast rope may turn by more than half a turn.
[[nodiscard]] view::CurvePoint turning_of(const TrackedParticle& tracked, const State& state,
                                          const view::CurvePoint* last);

/// The first free end of a rope; without one, the first tracked particle.
[[nodiscard]] std::size_t tip_of(const System& system);

/// A motion and the particles whose positions are series.
struct SeriesSource {
    explicit SeriesSource(const Motion& of);

    const Motion& motion;
    std::size_t tip;                  ///< see tip_of()
    std::array<std::size_t, 2> tips;  ///< tracked particles of bodies 0 and 1
};

/// A state of a motion, and all that series are read from.
struct Instant {
    Instant(const SeriesSource& of, const State& at, const Figures& its);

    [[nodiscard]] Vec2 tip_m() const;  ///< in world coordinates
    [[nodiscard]] double tip_distance_m() const;

    const SeriesSource& source;
    const State& state;
    const Figures& figures;
    Energy energy;                  ///< NaN without velocities
    view::CurvePoint turning = {};  ///< of the body whose angle is read, see turning_of()
};

/// A number over the time of a motion, as plots, tables and arrays have it.
struct Series {
    const char* key;                     ///< the name of a column, which ends with the unit
    const char* word;                    ///< English
    const char* unit;                    ///< takes a prefix, as in "kJ"; empty: a bare number
    StateFields fields;                  ///< of a state, from which the value is computed
    double (*value)(const Instant& at);  ///< NaN if unknown
};

/// The table of all series. The angle is that of Instant::turning; weight and potential are 0 J at the start.
struct SeriesTable {
    using At = const Instant&;
    static constexpr StateFields kVelocities{.velocities = true};
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    static constexpr Loads kUnknown{kNone, kNone};

    Series time{"t", "t", "s", {}, [](At at) { return at.state.time_s; }};
    Series angle{"angle_rad", "angle", "rad", kVelocities, [](At at) { return at.turning.x; }};
    Series angular_velocity{"angular_velocity_rad_s", "angular velocity", "rad/s", kVelocities,
                            [](At at) { return at.turning.y; }};
    Series kinetic{"kinetic_j", "kinetic", "J", kVelocities, [](At at) { return at.energy.kinetic_j; }};
    Series potential{"potential_j", "potential", "J", kVelocities,
                     [](At at) { return at.energy.potential_j(); }};
    Series weight{"weight_since_start_j", "weight", "J", kVelocities,
                  [](At at) { return at.energy.weight_j; }};
    Series elastic{"elastic_j", "elastic", "J", kVelocities, [](At at) { return at.energy.elastic_j; }};
    Series total{"total_j", "total", "J", kVelocities,
                 [](At at) { return at.energy.kinetic_j + at.energy.potential_j(); }};
    Series energy_change{
        "energy_change_j", "energy change", "J", {}, [](At at) { return at.figures.energy_change_j; }};
    Series energy_error{"energy_error", "energy error", "", {}, [](At at) {
                            return at.figures.energy_error.value_or(kNone);
                        }};
    Series strain{"strain", "strain", "", {}, [](At at) { return at.figures.strain; }};
    Series pin_force{"pin_force_n", "pin force", "N", {}, [](At at) {
                         return at.figures.loads.value_or(kUnknown).pin_force_n;
                     }};
    Series largest_tension{"largest_tension_n", "largest tension", "N", {}, [](At at) {
                               return at.figures.loads.value_or(kUnknown).largest_tension_n;
                           }};
    Series tip_x{"x_m", "x", "m", {}, [](At at) { return at.tip_m().x; }};
    Series tip_y{"y_m", "y", "m", {}, [](At at) { return at.tip_m().y; }};
    Series tip_distance{
        "tip_distance_m", "distance of the tips", "m", {}, [](At at) { return at.tip_distance_m(); }};
};
inline constexpr SeriesTable kSeries;

}  // namespace corda::film
