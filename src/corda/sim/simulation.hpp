#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
class LoadMeter;
class Solver;
}  // namespace corda::sim

#pragma GCC visibility push(default)
namespace corda {

/// In m: a run with a coordinate of this size or more has diverged.
inline constexpr double kMaxCoordinateMetres = 1e12;

/// Quality figures of one state.
struct Figures {
    /// Largest | length / rest length - 1 | of a real bar; a slack link of a string counts as 0.
    double strain = 0.0;
    /// | E(t) - E(0) | over the sum of weight times length of all bodies, or over E(0) without a force.
    /// std::nullopt if damping takes energy on purpose.
    std::optional<double> energy_error;
    std::optional<Loads> loads;    ///< std::nullopt if the method does not know them
    double energy_change_j = 0.0;  ///< E(t) - E(0), kinetic plus potential, of all bodies, in J
};

/// The mechanical energy of free particles and of what joins them, in J.
struct Energy {
    double kinetic_j = 0.0;
    double weight_j = 0.0;   ///< potential of gravity or of its replacement
    double elastic_j = 0.0;  ///< of bars that stretch and ropes that resist bending

    [[nodiscard]] double potential_j() const { return weight_j + elastic_j; }
};

/// The steps of a run, and its largest figures over all requested times.
struct Diagnostics {
    std::uint64_t steps = 0;
    Figures largest;
    /// The first time after a branching point, where rigid bars of a net lie in line and the equations allow
    /// several motions; the run follows one of them. std::nullopt if there was none.
    std::optional<double> branched_s;
};

/// A running simulation: the system, its solvers, the current state and its figures. Bodies do not interact,
/// so each has its own solver.
class Simulation {
  public:
    /// `frame_interval_s`: default from which a method with a fixed step derives its step. Throws
    /// corda::Error (kInvalidScene) if the method cannot run the system, or for a field outside the range of
    /// its declaration. Preparing a large system can be cancelled.
    Simulation(System system, const WorldDef& world, const MethodDef& method,
               double frame_interval_s = 1.0 / 60.0);
    /// `methods`: one per body, or one for all. Throws corda::Error (kUsage) for another number of them.
    Simulation(System system, const WorldDef& world, std::span<const MethodDef> methods,
               double frame_interval_s = 1.0 / 60.0);

    Simulation(Simulation&&) noexcept;
    Simulation& operator=(Simulation&&) noexcept;
    ~Simulation();

    /// Advances to exactly `time_s` seconds; the state has the same bits whatever times were requested on the
    /// way. A run that diverges keeps its last good state. Calls check_cancelled() about every millisecond;
    /// if that throws, the last state stays and this simulation cannot be advanced further. Throws
    /// corda::Error: kUsage if `time_s` is before the state's time or not finite, or after a cancellation.
    Status advance_to(double time_s);

    /// Advances to `time_s` as well, and writes the positions there to `at`, which has room for all
    /// particles. state(), its figures and the largest ones remain those of the last advance_to(), which
    /// moves on from here. Throws as advance_to().
    Status pass(double time_s, State& at);

    /// Sets the fields of all states from now on. Throws corda::Error (kInvalidScene) if tensions are
    /// requested that a method does not know (`relaxation`, or `rattle` if bars depend on each other), unless
    /// unknown tensions are allowed.
    void set_outputs(const StateFields& fields);

    /// Positions relative to `system().origin_m`, at the last time that was reached.
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] const System& system() const { return system_; }
    /// Figures of the current state.
    [[nodiscard]] const Figures& figures() const { return figures_; }
    /// Up to the last advance_to() that returned Status::kOk; the next one changes what the reference shows.
    [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }
    /// Steps taken so far, also during an advance_to() or pass().
    [[nodiscard]] std::uint64_t steps() const;
    /// The method of each body with every default filled in: given again, they run with the same bits.
    [[nodiscard]] std::vector<MethodDef> methods() const;

    /// E(t) - E(0) of the state, in J; NaN if damping takes energy on purpose.
    [[nodiscard]] double energy_change_j() const;
    /// Denominator of Figures::energy_error, in J.
    [[nodiscard]] double energy_scale_j() const { return energy_scale_j_; }

  private:
    Status move_to(double time_s, State& to);
    void observe();
    void read();
    void find_tensions();

    System system_;
    std::unique_ptr<sim::Solver> solver_;
    std::unique_ptr<sim::LoadMeter> load_meter_;
    State state_;
    State next_;                     ///< kept for its memory
    std::vector<double> tension_n_;  ///< of state_
    bool knows_tensions_ = false;    ///< false if a method does not know them
    StateFields fields_;
    double passed_s_ = 0.0;  ///< the last time that was requested
    bool has_diverged_ = false;
    bool is_stepping_ = false;  ///< stays true if an exception ended the steps
    bool conserves_energy_ = true;
    double initial_energy_j_ = 0.0;
    double energy_scale_j_ = 0.0;
    Figures figures_;
    Diagnostics diagnostics_;
};

/// Positions of all particles at some times, from another simulation or a measurement. At these times the
/// positions are those that were given, bit for bit. Between two of them each particle follows the cubic
/// polynomial through both positions with the velocity at both. The velocity at a time is that of the
/// parabola through this time and its two neighbours; at the first and the last time, of the parabola through
/// the outermost three. After the last time, all rest. Never changes once it is made.
class GivenMotion {
  public:
    static constexpr double kMinIntervalSeconds = 1e-9;

    /// `times_s`: at least two, each later than the one before by kMinIntervalSeconds or more, the first at
    /// most 0 and the last after 0. `positions_m`: in world coordinates, all particles of the first time,
    /// ropes before nets, then those of the next; no coordinate beyond kMaxCoordinateMetres. `source` names
    /// them in messages. Throws corda::Error (kUsage) for others.
    GivenMotion(std::vector<double> times_s, std::vector<Vec2> positions_m, std::string source = "positions");

    [[nodiscard]] std::size_t particle_count() const { return particle_count_; }
    /// The last time.
    [[nodiscard]] double end_s() const { return times_s_.back(); }
    [[nodiscard]] const std::string& source() const { return source_; }
    /// A hash of all numbers, 16 hexadecimal digits.
    [[nodiscard]] const std::string& hash() const { return hash_; }

    /// Whether the positions of a particle at times before `until_s` differ.
    [[nodiscard]] bool moves_before(double until_s, std::size_t particle) const;

    /// Positions relative to (0, 0), and velocities. Throws corda::Error (kUsage) before the first time.
    [[nodiscard]] State at(double time_s) const;

  private:
    [[nodiscard]] const Vec2& position_m(std::size_t k, std::size_t i) const {
        return positions_m_[k * particle_count_ + i];
    }
    [[nodiscard]] Vec2 mean_velocity_m_s(std::size_t k, std::size_t i) const;
    [[nodiscard]] Vec2 velocity_m_s(std::size_t k, std::size_t i) const;

    std::vector<double> times_s_;
    std::vector<Vec2> positions_m_;
    std::size_t particle_count_ = 0;
    std::string source_;
    std::string hash_;
};

/// One trial of a method: its run compared with checks.
struct Trial {
    MethodDef method;
    MethodDef check;  ///< method of the first check, a tighter run
    std::uint64_t steps = 0;
    std::uint64_t check_steps = 0;      ///< of the first check
    double updates = 0.0;               ///< work of all runs up to their comparison, in updates of a particle
    double largest_difference_m = 0.0;  ///< up to `reached_s`
    double error_estimate_m = 0.0;      ///< up to `reached_s`
    double reached_s = 0.0;             ///< last frame time up to which the error is within the tolerance
    double hundredth_s = 0.0;           ///< the same for a hundredth of the tolerance
    bool to_the_end = false;            ///< within the tolerance at all times
    bool diverged = false;              ///< the run or a check diverged or branched after `reached_s`
    bool undecided = false;             ///< rounding decides on a snap of a string after `reached_s`
    bool unchecked = false;             ///< later comparisons would take too much work
    bool too_long = false;              ///< the run was ended because it took too many steps or too much work
    int passes = 0;                     ///< runs and checks that began to move
};

/// Reason for the method of a body.
enum class PlanReason {
    kNamed,      ///< the scene names the method
    kExact,      ///< `exact` can move it
    kGraph,      ///< rigid bars of closed ropes or nets, for which `rattle` is made
    kDependent,  ///< the bars depend on each other at the start, in a way that no method can follow
    kCheapest,   ///< `exact` can move it, and another method with less work is good enough
    kManySteps,  ///< every method with an estimate would take too many steps
    kGiven,      ///< no method moves it: its positions are given (see GivenMotion)
};

/// The reason why a net of rigid bars never moves.
enum class StandsStill {
    kNo,     ///< it moves, or the scene names the method
    kPlate,  ///< its bars make it rigid, and its pins hold it
    kRow,    ///< a straight row of bars between pins holds it
};

/// The method that moves a body and, if `auto` chose it, what shows that it is good enough.
struct BodyPlan {
    MethodDef method;  ///< with every default filled in: given again, it runs with the same bits
    PlanReason reason = PlanReason::kNamed;
    /// Estimate of the largest error of a position at any time up to the horizon. std::nullopt if no method
    /// can determine the true motion, or if the scene names the method.
    std::optional<double> error_estimate_m;
    /// The last frame time at which a run and a much tighter one agree within the tolerance: later positions
    /// are those of one possible motion. std::nullopt if the scene ends before.
    std::optional<double> horizon_s;
    bool diverges = false;  ///< the run ends before the scene does
    StandsStill stands_still = StandsStill::kNo;
    bool undecided = false;     ///< rounding decides on a snap of a string after the horizon
    bool unchecked = false;     ///< estimates after the horizon would take too much work
    std::vector<Trial> trials;  ///< all that were run, the chosen one last
    int passes = 0;             ///< number of integrations of the motion, including checks and failed trials
};

/// The methods that run a scene.
struct Plan {
    std::vector<BodyPlan> bodies;  ///< one per body of the System
    /// The largest estimate of a body; std::nullopt if one has none.
    std::optional<double> error_estimate_m;
    std::optional<double> horizon_s;  ///< the earliest of a body
    /// Number of integrations of the whole scene: each body is weighted by its particles, and the sum is
    /// rounded up.
    int simulation_passes = 0;
    /// One sentence for each part of the scene that the motion changes or ignores, such as a velocity along
    /// bars of fixed length. Filled in by Film.
    std::vector<std::string> notes;
};

}  // namespace corda
#pragma GCC visibility pop
