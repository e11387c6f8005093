#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"
#include "corda/report/times.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::study {

/// True positions: writes those of all particles at frame `k` to `state`, which has room for them, and
/// returns true; returns false if it does not know this frame. Particles with NaN coordinates are not
/// compared.
using Reference = std::function<bool(std::int64_t k, State& state)>;

/// What the methods are measured on: a system, its world, the frames at which it is compared, and the truth.
struct Problem {
    std::string id;     ///< [a-z0-9_]+, part of the names of files
    std::string title;  ///< "The source report's swing, 40 particles"
    std::vector<RopeDef> ropes;
    std::vector<NetDef> nets;
    WorldDef world;
    FrameRate fps;
    double length_m = 1.0;  ///< errors are fractions of it
    Reference reference;    ///< empty: the truth is not known
    std::string truth;      ///< where the reference comes from

    [[nodiscard]] System system() const { return build_system(ropes, nets); }
    [[nodiscard]] std::int64_t last_frame() const { return fps.last_frame_within(world.duration_s); }
};

/// The problem with bars from each particle of its ropes to the next 1..`reach`.
[[nodiscard]] Problem with_reach(Problem problem, int reach);

/// What one run of a method showed.
struct Measurement {
    MethodDef method;
    std::string label;           ///< of the series that it belongs to: "rattle, order 4"
    double parameter = 0.0;      ///< step in s, or tolerance
    double largest_error = 0.0;  ///< largest distance of a particle from the truth over L; NaN: not compared
    double rms_error = 0.0;      ///< largest, over the frames, of the RMS distance of the particles over L
    double largest_strain = 0.0;
    std::optional<double> energy_error;  ///< over m g L
    report::Times ms_per_simulated_s;    ///< of the stepping alone; empty: not timed
    std::uint64_t steps = 0;
    std::string failure;  ///< why it failed; empty if it did not. A failed run is shown, never dropped.
};

/// How a run is timed.
struct Timing {
    int repeats = 5;           ///< 0: not timed
    double shortest_s = 0.05;  ///< a repeat consists of as many runs as take this time
};

/// Measurement::largest_error of a run by one method per body.
[[nodiscard]] double largest_error(const Problem& problem, std::span<const MethodDef> methods);

/// Runs a method on the problem, once for its errors and then again for its time.
[[nodiscard]] Measurement measure(const Problem& problem, const MethodDef& method, const std::string& label,
                                  double parameter, const Timing& timing);

}  // namespace corda::study
