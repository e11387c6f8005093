#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::study {

/// Positions that a run is measured against: writes those of all particles at frame `k` to `state` (sized for
/// them) and returns true, or returns false where the reference has no such frame. `skip` lets a reference
/// know only some particles: those with NaN coordinates are not compared.
using Reference = std::function<bool(std::int64_t k, sim::State& state)>;

/// What a study runs: a system, its world, the times at which it is looked at, and the truth.
struct Problem {
    std::string id;     ///< [a-z0-9_]+
    std::string title;  ///< "The source report's swing, 40 particles"
    std::string truth;  ///< in words: where the reference comes from
    std::vector<sim::RopeDef> ropes;
    std::vector<sim::NetDef> nets;
    sim::WorldDef world;
    double frame_interval_s = 1.0 / 60.0;
    std::int64_t last_frame = 0;
    Reference reference;
    double length_m = 1.0;  ///< errors are given in parts of it
};

/// One run of a method and what it showed.
struct Measurement {
    sim::SolverDef solver;
    std::string label;           ///< of the series it belongs to: "rope, order 4"
    double parameter = 0.0;      ///< step in s, or tolerance
    double largest_error = 0.0;  ///< largest distance of a particle from the truth / length, over all frames
    double rms_error = 0.0;      ///< largest over the frames of the RMS distance over particles / length
    double largest_strain = 0.0;
    std::optional<double> energy_error;  ///< over m g L
    double ms_per_simulated_s = 0.0;     ///< stepping alone, minimum of the repeats
    std::uint64_t steps = 0;
    std::string failure;  ///< why it failed; empty where it did not. A failed run is shown, never dropped
};

/// How a run is timed.
struct Timing {
    int repeats = 5;           ///< at least; the minimum counts
    double shortest_s = 0.05;  ///< of a repeat: short runs are repeated inside one
};

/// Runs `solver` on the problem, once watched for its errors and then again for its time.
[[nodiscard]] Measurement measure(const Problem& problem, const sim::SolverDef& solver,
                                  const std::string& label, double parameter, const Timing& timing);

}  // namespace corda::study
