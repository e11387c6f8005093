#include "corda/sim/relaxation/relaxation.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

void refuse_materials(const System& system) {
    const bool plain =
        system.bends.empty() && std::all_of(system.bodies.begin(), system.bodies.end(), [](const Body& body) {
            return body.material.compliance_1_n == 0.0 && !body.material.is_string;
        });
    if (plain) return;
    throw Refusal(Refusal::Reason::kMaterial, "method relaxation knows no compliance, strings or bending");
}

/// Successive bodies are scheduled together until they have this many particles: several short ropes fill
/// lanes that one would leave empty. A long rope fills them alone, and 256 particles and their bars fit into
/// a level 2 cache.
constexpr std::size_t kParticlesTogether = 256;

/// Sweeps run in pieces of this many bars and particles, a few milliseconds, which are counted
/// as work. With smaller pieces the kernel would wait more often for the last sweep to end.
constexpr std::uint64_t kMaxAtOnce = 1'000'000;
/// Minimum number of sweeps of a piece, so that the memory reads of a large rope are still shared.
constexpr std::uint64_t kMinSweeps = 12;
/// Bars or particles per update of count_work().
constexpr std::uint64_t kBarsPerUpdate = 8;

/// The bars among these that can move a particle.
std::vector<RelaxationBar> movable_bars(const System& system, std::size_t first, std::size_t count) {
    std::vector<RelaxationBar> bars;
    bars.reserve(count);
    for (std::size_t k = first; k < first + count; ++k) {
        const Bar& bar = system.bars[k];
        const bool a_is_pinned = system.is_pinned(bar.a);
        const bool b_is_pinned = system.is_pinned(bar.b);
        if (a_is_pinned && b_is_pinned) continue;
        const double share_a = a_is_pinned ? 0.0 : (b_is_pinned ? 1.0 : 0.5);
        bars.push_back({bar.a, bar.b, bar.rest_m, share_a});
    }
    return bars;
}

std::vector<RelaxationSchedule> schedule_bodies(const System& system) {
    std::vector<RelaxationSchedule> schedules;
    for (std::size_t i = 0; i < system.bodies.size();) {
        Body together = system.bodies[i];
        for (++i; i < system.bodies.size() && together.particle_count < kParticlesTogether; ++i) {
            together.particle_count += system.bodies[i].particle_count;
            together.bar_count += system.bodies[i].bar_count;
        }
        schedules.push_back(schedule_bars(movable_bars(system, together.first_bar, together.bar_count),
                                          static_cast<std::uint32_t>(together.first_particle),
                                          static_cast<std::uint32_t>(together.particle_count)));
    }
    return schedules;
}

/// The weight of each particle, or the force that a scene gives in its place.
std::vector<Vec2> forces_on_particles(const System& system, const Forces& forces, const RelaxationDef& def) {
    std::vector<Vec2> force_n = forces.on_particles(system);
    if (!def.force_n) return force_n;
    for (std::size_t i = 0; i < force_n.size(); ++i) force_n[i] = system.is_pinned(i) ? Vec2{} : *def.force_n;
    return force_n;
}

/// Runs sweeps over `size` bars and particles, and counts each piece of them as work.
template <class Run>
void run_in_pieces(RelaxationSweeps sweeps, std::size_t size, const Run& run) {
    const std::uint64_t at_once = std::max<std::uint64_t>(kMinSweeps, kMaxAtOnce / (1 + size));
    const std::uint64_t end = sweeps.end;
    for (; sweeps.begin < end; sweeps.begin = sweeps.end) {
        sweeps.end = sweeps.begin + std::min(at_once, end - sweeps.begin);
        run(sweeps);
        count_work(1 + (sweeps.end - sweeps.begin) * size / kBarsPerUpdate);
    }
}

}  // namespace

Relaxation::Relaxation(const System& system, const Forces& forces, const RelaxationDef& def,
                       double default_step_s, RelaxationKernel kernel)
    : Solver(sim::energy_scale_j(system, forces_on_particles(system, forces, def)),
             forces.conserve_energy() && def.delta == 0.0),
      def_(def),
      step_s_(def.step_s.value_or(default_step_s)),
      sweeps_(static_cast<std::uint64_t>(def.sweeps)),
      kernel_(kernel),
      mass_kg_(system.mass_kg),
      force_n_(forces_on_particles(system, forces, def)),
      forces_(forces),
      goes_on_(system.start_s > 0.0),
      pins_(moving_pins(system)) {
    assert(step_s_ > 0.0 && def.sweeps >= 1);
    def_.step_s = step_s_;
    refuse_materials(system);
    motion_.keep = (1.0 - def.delta) * forces.decay(step_s_);
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        is_free_.push_back(!system.is_pinned(i));
        motion_.position_m.insert(motion_.position_m.end(), {system.x_m[i], system.y_m[i]});
        const std::array move_m{step_s_ * system.vx_m_s[i], step_s_ * system.vy_m_s[i]};
        motion_.moves.push_back({move_m, {system.x_m[i], system.y_m[i]}, move_m, {}});
    }
    for (const MovingPin& pin : pins_) {
        const Vec2 move_m = pin.displacement(step_s_);
        RelaxationMove& move = motion_.moves[pin.particle];
        move.move_m = move.last_move_m = {move_m.x, move_m.y};
    }
    set_pushes();
    if (kernel_ == RelaxationKernel::kScalar) {
        bars_ = movable_bars(system, 0, system.bars.size());
    } else {
        schedules_ = schedule_bodies(system);
    }
}

const char* Relaxation::problem_of(const RelaxationDef& def) {
    if (def.step_s && !(*def.step_s > 0.0 && std::isfinite(*def.step_s))) return "step_s is not > 0";
    if (def.sweeps < 1) return "sweeps is not >= 1";
    if (!(def.delta >= 0.0 && def.delta < 1.0)) return "delta is not within 0 .. 1";
    const bool is_finite = !def.force_n || (std::isfinite(def.force_n->x) && std::isfinite(def.force_n->y));
    return is_finite ? nullptr : "force_n is not finite";
}

std::string Relaxation::text_of(const RelaxationDef& def) {
    return fmt::format("relaxation with {} sweep{}", def.sweeps, def.sweeps == 1 ? "" : "s") +
           (def.step_s ? fmt::format(", step {:.6g} s", *def.step_s) : "");
}

Status Relaxation::advance_to(double time_s, State& state) {
    const FlushDenormals flush;
    const GridTime at = locate(time_s, step_s_);
    const std::uint64_t target = at.is_on_grid ? at.step : at.step + 1;  // interpolation looks back
    assert(step_ <= target);
    while (step_ < target) {
        const bool varies = forces_.depend_on_time() || !pins_.empty();
        advance(varies ? 1 : target - step_);
        if (varies) set_pushes();
    }
    state.time_s = time_s;
    if (at.is_on_grid) {
        for (std::size_t i = 0; i < state.x_m.size(); ++i) {
            state.x_m[i] = motion_.position_m[2 * i];
            state.y_m[i] = motion_.position_m[2 * i + 1];
        }
    } else {
        interpolate(at.fraction, state);
    }
    return Status::kOk;
}

void Relaxation::set_pushes() {
    const double square_s2 = step_s_ * step_s_;
    forces_.set_time(static_cast<double>(step_) * step_s_);
    const Vec2 air_m_s2 = forces_.uniform_m_s2() - forces_.weight_m_s2();
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        Vec2 push_m = (square_s2 / mass_kg_[i]) * force_n_[i];
        if (is_free_[i] && air_m_s2 != Vec2{}) push_m = push_m + square_s2 * air_m_s2;
        motion_.moves[i].push_m = {push_m.x, push_m.y};
    }
    for (const MovingPin& pin : pins_) {  // to where the pin will be
        const Vec2 next_m = pin.place_m(static_cast<double>(step_ + 1) * step_s_);
        RelaxationMove& move = motion_.moves[pin.particle];
        const double* const here_m = &motion_.position_m[std::size_t{2} * pin.particle];
        move.push_m = {(next_m.x - here_m[0]) - motion_.keep * move.move_m[0],
                       (next_m.y - here_m[1]) - motion_.keep * move.move_m[1]};
    }
}

void Relaxation::advance(std::uint64_t steps) {
    const std::size_t size = motion_.position_m.size();
    // The first step is Euler's: its move, h v(0), is known from the start. Later phases start with the
    // last move of the one before.
    const bool starts_updated = step_ == 0 && !goes_on_;
    if (starts_updated) {
        for (std::size_t k = 0; k < size; ++k) {
            RelaxationMove& verlet = motion_.moves[k / 2];
            motion_.position_m[k] += verlet.move_m[k % 2];
            verlet.unrelaxed_m[k % 2] = motion_.position_m[k];
        }
    }
    const RelaxationSweeps sweeps{0, steps * sweeps_, sweeps_, starts_updated};
    if (kernel_ == RelaxationKernel::kScalar) {
        run_in_pieces(sweeps, bars_.size() + size / 2,
                      [this](const RelaxationSweeps& piece) { run_sweeps(bars_, piece, motion_); });
    }
    for (const RelaxationSchedule& schedule : schedules_) {
        const std::size_t bars = RelaxationPacket::kLanes * schedule.packets.size();
        run_in_pieces(sweeps, bars + schedule.updates.size(),
                      [&](const RelaxationSweeps& piece) { run_sweeps(schedule, piece, motion_); });
    }
    // Add what the bars moved to the move, as the next update would.
    for (std::size_t k = 0; k < size; ++k) {
        RelaxationMove& verlet = motion_.moves[k / 2];
        verlet.move_m[k % 2] += motion_.position_m[k] - verlet.unrelaxed_m[k % 2];
        verlet.unrelaxed_m[k % 2] = motion_.position_m[k];
    }
    step_ += steps;
}

void Relaxation::interpolate(double fraction, State& state) const {
    // Newton's form through the states at step_ - 2, step_ - 1 and step_; a straight line in the first step.
    const double second = step_ >= 2 ? 0.5 * fraction * (fraction - 1.0) : 0.0;
    const auto at = [&](std::size_t k) {
        const RelaxationMove& verlet = motion_.moves[k / 2];
        const double move = verlet.move_m[k % 2];
        return motion_.position_m[k] - (1.0 - fraction) * move + second * (move - verlet.last_move_m[k % 2]);
    };
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        state.x_m[i] = at(2 * i);
        state.y_m[i] = at(2 * i + 1);
    }
}

void Relaxation::velocities(State& state) {
    for (std::size_t i = 0; i < state.vx_m_s.size(); ++i) {
        state.vx_m_s[i] = motion_.moves[i].move_m[0] / step_s_;
        state.vy_m_s[i] = motion_.moves[i].move_m[1] / step_s_;
    }
}

double Relaxation::energy_j() const {
    // At the middle of the last step, where move / h is the velocity to second order; before the first step,
    // at t = 0.
    const double back = step_ == 0 ? 0.0 : 0.5;
    double energy_j = 0.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        const auto [move_x, move_y] = motion_.moves[i].move_m;
        const double vx = move_x / step_s_;
        const double vy = move_y / step_s_;
        energy_j += 0.5 * mass_kg_[i] * (vx * vx + vy * vy);
        energy_j -= dot(force_n_[i], {motion_.position_m[2 * i] - back * move_x,
                                      motion_.position_m[2 * i + 1] - back * move_y});
    }
    return energy_j;
}

}  // namespace corda::sim
