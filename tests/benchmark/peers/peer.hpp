#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::peers {

/// A problem that all peers solve. Particle 0, or the first row of a net, is pinned.
struct Problem {
    std::string id;
    System system;
    WorldDef world;
    double stiffness_n_m = 0.0;  ///< of a bar that stretches; 0: rigid bars
    double bend_n_m = 0.0;       ///< stiffness k of a bend: its energy is k (1 - cos(angle))
    bool is_string = false;      ///< the only bar pulls and never pushes
    int frames = 0;              ///< output times
    double length_m = 0.0;       ///< scale of the errors
    std::vector<State> truth;    ///< frames 1, 2, ..., with velocities; read by run_peer()

    static constexpr double kFps = 60.0;
    [[nodiscard]] std::size_t count() const { return system.particle_count(); }
    [[nodiscard]] double gravity() const { return -world.gravity_m_s2.y; }
    /// Particle k + 1 hangs from particle k by bar k.
    [[nodiscard]] bool is_chain() const { return stiffness_n_m == 0.0 && !is_string; }
    /// Length of the links of a chain.
    [[nodiscard]] double link_m() const { return system.bars[0].rest_m; }
    /// Angle of a chain at the start, from +x.
    [[nodiscard]] double start_angle() const;
};

/// The state at t = 0.
[[nodiscard]] State start_of(const Problem& problem);

/// All problems.
[[nodiscard]] std::vector<Problem> problems();

/// File of a problem's truth: x, y, vx, vy of all particles at the frames 1, 2, ..., as doubles.
[[nodiscard]] std::string truth_path(const std::string& folder, const Problem& problem);

/// Thrown by a run that has failed.
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A simulation by a peer. Set-up belongs into its constructor, which is not timed.
class Run {
  public:
    Run() = default;
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;
    virtual ~Run() = default;

    /// Goes to the next frame, which is at `time_s`. Throws Failure.
    virtual void advance(double time_s) = 0;
    /// Writes positions and velocities. `state` has room for all particles and the start's values.
    virtual void read(State& state) = 0;
};

/// A run by fixed steps that divide the frame interval or span several frames. Frames within a step are read
/// from the cubic polynomials through its ends with their velocities, as a user of the peer would.
class SteppedRun : public Run {
  public:
    /// `steps_per_frame`: a whole number, or the inverse of one.
    SteppedRun(const Problem& problem, double steps_per_frame);
    void advance(double time_s) final;
    void read(State& state) final;

  protected:
    virtual void step() = 0;
    /// As read(), at the end of the last step.
    virtual void read_step(State& state) = 0;
    double step_s_;

  private:
    int steps_;        ///< in a frame; 0: a step spans frames
    State from_, to_;  ///< ends of a step that spans frames
    double time_s_ = 0.0;
};

/// A peer's method and the values of its parameter, from cheap to expensive.
struct Series {
    std::string method;
    std::string parameter;  ///< its name
    std::vector<double> values;
    std::function<std::unique_ptr<Run>(const Problem&, double value)> make;
    /// True for the problems that the method can express.
    std::function<bool(const Problem&)> can_run;
};

inline constexpr const char* kStepsPerFrame = "steps per frame";
/// 1/4, 1/2, 1, 2, 4, 8, 16, 64, 256, ...: run_peer() stops where a run takes too long.
[[nodiscard]] std::vector<double> step_counts();
/// 10^-first, ..., 10^-last.
[[nodiscard]] std::vector<double> powers_of_ten(int first, int last);

[[nodiscard]] inline bool is_chain(const Problem& problem) {
    return problem.is_chain();
}
[[nodiscard]] inline bool is_flexible_chain(const Problem& problem) {
    return problem.is_chain() && problem.bend_n_m == 0.0;
}
[[nodiscard]] inline bool is_flexible(const Problem& problem) {
    return problem.bend_n_m == 0.0;
}
[[nodiscard]] inline bool is_net(const Problem& problem) {
    return problem.stiffness_n_m > 0.0;
}
[[nodiscard]] inline bool is_any(const Problem& /*problem*/) {
    return true;
}

/// The main function of a peer: runs its series on the problems named by the arguments, TRUTH_FOLDER
/// [PROBLEM ...], and prints a row of CSV per run. Times are CPU time of the process, the minimum of several
/// repeats, without set-up.
int run_peer(int argc, char** argv, const std::string& name, const std::string& version,
             const std::vector<Series>& all_series);

}  // namespace corda::peers
