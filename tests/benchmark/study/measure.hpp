#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/study/times.hpp"
#include "corda/core/rational.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::study {

/// True positions: writes those of all particles at frame `k` to `state`, which has room for them, and
/// returns true; returns false if it does not know this frame. Particles with NaN coordinates are not
/// compared.
using Reference = std::function<bool(std::int64_t k, State& state)>;

/// A problem for the methods: a system, its world, the frames at which it is compared, and the truth.
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

/// Result of one run of a method.
struct Measurement {
    MethodDef method;
    std::string label;           ///< of the series that it belongs to: "rattle, order 4"
    double parameter = 0.0;      ///< step in s, or tolerance
    double largest_error = 0.0;  ///< largest distance of a particle from the truth over L; NaN: not compared
    double rms_error = 0.0;      ///< largest, over the frames, of the RMS distance of the particles over L
    double largest_strain = 0.0;
    std::optional<double> energy_error;  ///< over m g L
    Times ms_per_simulated_s;            ///< of the stepping alone; empty: not timed
    std::uint64_t steps = 0;
    std::string failure;  ///< why it failed; empty if it did not. A failed run is shown, never dropped.
};

/// RMS distance of the particles of two states, in metres.
[[nodiscard]] double rms_m(const State& a, const State& b);

/// How a run is timed.
struct Timing {
    int repeats = 5;           ///< 0: not timed
    double shortest_s = 0.05;  ///< a repeat consists of as many runs as take this time
};

/// Runs a method on the problem, once for its errors and then again for its time.
[[nodiscard]] Measurement measure(const Problem& problem, const MethodDef& method, const std::string& label,
                                  double parameter, const Timing& timing);

/// A run of one rope that can be inspected at any time, and the time that its steps take.
class Probe {
  public:
    /// Throws corda::Error if the method cannot run the rope. `frame_interval_s`: see Simulation.
    Probe(const RopeDef& rope, const WorldDef& world, const MethodDef& method,
          double frame_interval_s = 1.0 / 60.0);

    /// Advances to a time. Throws corda::Error (kDiverged) if the run diverges.
    void go(double time_s);
    /// Advances to a time frame by frame, so that the largest figures are those of every frame.
    void go_by_frames(double time_s, double frames_per_second = 60.0);

    [[nodiscard]] const State& state() const { return simulation_.state(); }
    [[nodiscard]] const Figures& figures() const { return simulation_.figures(); }
    [[nodiscard]] Diagnostics diagnostics() const { return simulation_.diagnostics(); }
    [[nodiscard]] Vec2 tip_m() const { return {state().x_m.back(), state().y_m.back()}; }
    /// Seconds that go() has taken so far.
    [[nodiscard]] double wall_s() const { return wall_s_; }

  private:
    Simulation simulation_;
    double wall_s_ = 0.0;
};

}  // namespace corda::study
