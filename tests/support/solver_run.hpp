#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/exact/exact.hpp"
#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/solver.hpp"

namespace corda::test {

/// Loads of a state that a solver has just reached; std::nullopt if it does not know the tensions.
inline std::optional<Loads> loads_of(const System& system, const State& state, sim::Solver& solver) {
    std::vector<double> tension_n(system.bars.size(), 0.0);
    if (!solver.tensions(tension_n)) return std::nullopt;
    return sim::LoadMeter(system).of(system, state, tension_n);
}

/// Bodies driven without a Simulation, with their observed maxima. `S` is the class of the solver; the
/// default is chosen by the definition.
template <class S = sim::Solver>
class SolverRun {
  public:
    SolverRun(System system, const WorldDef& world, const MethodDef& def)
        : system_(std::move(system)),
          solver_(start(system_, world, def)),
          state_{0.0, system_.x_m, system_.y_m},
          start_energy_j_(solver_->energy_j()) {}
    SolverRun(const RopeDef& rope, const WorldDef& world, const MethodDef& def)
        : SolverRun(build_system({&rope, 1}), world, def) {}
    SolverRun(const NetDef& net, const WorldDef& world, const MethodDef& def)
        : SolverRun(build_system({}, {&net, 1}), world, def) {}
    SolverRun(const SolverRun&) = delete;  // the solver refers to the system
    SolverRun& operator=(const SolverRun&) = delete;
    ~SolverRun() = default;

    /// Advances to a time and observes the state; false if the solver gives up.
    [[nodiscard]] bool go(double time_s) {
        if (solver_->advance_to(time_s, state_) != Status::kOk) return false;
        keep_largest(largest_change_j_, solver_->energy_j() - start_energy_j_);
        keep_largest(largest_move_m_, largest_distance_m(system_.x_m, system_.y_m));
        for (const Bar& bar : system_.bars) {
            const double length_m =
                sim::length(state_.x_m[bar.b] - state_.x_m[bar.a], state_.y_m[bar.b] - state_.y_m[bar.a]);
            keep_largest(largest_strain_, length_m / bar.rest_m - 1.0);
        }
        return true;
    }
    /// The same with `looks` observations at equal intervals.
    [[nodiscard]] bool go(double time_s, int looks) {
        const double start_s = state_.time_s;
        for (int k = 1; k <= looks; ++k) {
            if (!go(start_s + (time_s - start_s) * k / looks)) return false;
        }
        return true;
    }

    [[nodiscard]] double tip_x() const { return state_.x_m.back(); }
    [[nodiscard]] double tip_y() const { return state_.y_m.back(); }
    [[nodiscard]] double tip_error_m(Vec2 expected_m) const {
        return sim::length(tip_x() - expected_m.x, tip_y() - expected_m.y);
    }
    /// Largest distance of a particle from its position in another state.
    [[nodiscard]] double distance_m(const State& other) const {
        return largest_distance_m(other.x_m, other.y_m);
    }
    /// Largest observed distance of a particle from its start.
    [[nodiscard]] double moved_m() const { return largest_move_m_; }
    /// Largest observed | length / rest length - 1 | of a bar.
    [[nodiscard]] double strain() const { return largest_strain_; }
    /// Largest observed change of the energy, relative to weight times length or, without a force, to the
    /// initial energy.
    [[nodiscard]] double energy_error() const {
        const double scale_j = solver_->energy_scale_j();
        return largest_change_j_ / (scale_j > 0.0 ? scale_j : std::abs(start_energy_j_));
    }
    [[nodiscard]] double largest_energy_change_j() const { return largest_change_j_; }
    [[nodiscard]] const State& state() const { return state_; }
    /// The same with velocities.
    [[nodiscard]] State state_with_velocities() {
        State state = state_;
        state.vx_m_s.assign(state.x_m.size(), 0.0);
        state.vy_m_s.assign(state.x_m.size(), 0.0);
        solver_->velocities(state);
        return state;
    }
    [[nodiscard]] const System& system() const { return system_; }
    [[nodiscard]] S& solver() { return *solver_; }
    [[nodiscard]] std::optional<Loads> loads() { return loads_of(system_, state_, *solver_); }

  private:
    static std::unique_ptr<S> start(const System& system, const WorldDef& world, const MethodDef& def) {
        constexpr double kFrameSeconds = 1.0 / 60.0;
        if constexpr (std::is_same_v<S, sim::Solver>) {
            return sim::make_solver(system, world, {&def, 1}, kFrameSeconds);
        } else if constexpr (std::is_same_v<S, sim::Exact>) {
            return S::make(system, world, std::get<ExactDef>(def));
        } else {
            return std::make_unique<S>(system, world, std::get<RattleDef>(def), kFrameSeconds);
        }
    }
    /// Written so that NaN is kept.
    static void keep_largest(double& largest, double change) {
        if (!(std::abs(change) <= largest)) largest = std::abs(change);
    }
    [[nodiscard]] double largest_distance_m(const std::vector<double>& x_m,
                                            const std::vector<double>& y_m) const {
        double largest_m = 0.0;
        for (std::size_t i = 0; i < x_m.size(); ++i)
            keep_largest(largest_m, sim::length(state_.x_m[i] - x_m[i], state_.y_m[i] - y_m[i]));
        return largest_m;
    }

    System system_;
    std::unique_ptr<S> solver_;
    State state_;
    double start_energy_j_;
    double largest_change_j_ = 0.0;
    double largest_move_m_ = 0.0;
    double largest_strain_ = 0.0;
};

/// Largest distance of a particle between two runs of the same bodies at `looks` times, a tenth of a second
/// apart; NaN if one of them gives up.
template <class A, class B>
double largest_distance_m(SolverRun<A>& one, SolverRun<B>& other, int looks) {
    double largest_m = 0.0;
    for (int k = 1; k <= looks; ++k) {
        if (!one.go(0.1 * k) || !other.go(0.1 * k)) return std::numeric_limits<double>::quiet_NaN();
        const double apart_m = one.distance_m(other.state());
        if (!(apart_m <= largest_m)) largest_m = apart_m;
    }
    return largest_m;
}

/// One rope with method `rattle`.
class RattleRun : public SolverRun<sim::Rattle> {
  public:
    RattleRun(const RopeDef& rope, const WorldDef& world, int order,
              std::optional<double> step_s = std::nullopt)
        : SolverRun(rope, world, RattleDef{order, step_s}) {}
};

/// One rope with method `exact`.
class ExactRun : public SolverRun<sim::Exact> {
  public:
    explicit ExactRun(const RopeDef& rope, double tolerance = 1e-9, const WorldDef& world = {})
        : SolverRun(rope, world, ExactDef{tolerance}) {}
};

}  // namespace corda::test
