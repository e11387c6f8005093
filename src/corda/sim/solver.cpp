#include "corda/sim/solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/sim/events.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/exact.hpp"
#include "corda/sim/exact/implicit_part.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/phases.hpp"
#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/relaxation/relaxation.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

// The solver of each method. It states the facts about its method as static members, which with_solver()
// finds:
//
//   static const char* problem_of(const Def&);   the parameter that is out of range; nullptr: none
//   static std::string text_of(const Def&);      see method_text()
//   static constexpr bool kKnowsTensions;
template <class Def>
struct SolverOf;
template <>
struct SolverOf<ExactDef> : std::type_identity<Exact> {};
template <>
struct SolverOf<RattleDef> : std::type_identity<Rattle> {};
template <>
struct SolverOf<RelaxationDef> : std::type_identity<Relaxation> {};

/// Calls use.operator()<Solver>(def) for the method's definition and its solver.
template <class Use>
auto with_solver(const MethodDef& method, const Use& use) {
    return std::visit(
        [&use](const auto& def) {
            return use.template operator()<typename SolverOf<std::decay_t<decltype(def)>>::type>(def);
        },
        method);
}

/// A bar without length has no direction. Only `relaxation` ignores such bars.
void refuse_bars_without_length(const System& system) {
    for (const Bar& bar : system.bars) {
        if (bar.rest_m > 0.0) continue;
        throw Refusal(Refusal::Reason::kBarWithoutLength, "particles " + std::to_string(bar.a) + " and " +
                                                              std::to_string(bar.b) +
                                                              ", which a bar joins, coincide");
    }
}

/// Makes the one solver of a whole system.
std::unique_ptr<Solver> make_solver_of(const System& system, const Forces& forces, const MethodDef& method,
                                       double frame_interval_s) {
    if (system.has_events())
        return solve_in_phases(
            system, forces, method,
            [=](const System& part, const Forces& there, const MethodDef& by, std::span<const std::size_t>) {
                return make_solver_of(part, there, by, frame_interval_s);
            });
    if (!system.moves.empty() && common_displacement(system))
        return solve_in_frame_of_pins(system, forces, method, [&](const System& body, const Forces& there) {
            return make_solver_of(body, there, method, frame_interval_s);
        });
    if (!std::holds_alternative<RelaxationDef>(method)) refuse_bars_without_length(system);
    return with_solver(method, [&]<class S>(const auto& def) -> std::unique_ptr<Solver> {
        if constexpr (std::is_same_v<S, Exact>)
            return S::make(system, forces, def);
        else
            return std::make_unique<S>(system, forces, def, frame_interval_s);
    });
}

/// Cost of making a solver, in updates of count_work().
constexpr std::uint64_t kUpdatesPerBody = 20;

/// The solver of one body, and the body's place in the system.
struct Part {
    std::size_t first_particle = 0;
    std::size_t first_bar = 0;
    std::unique_ptr<Solver> solver;
    State state;  ///< of its particles and bars
};

double sum_of_scales_j(const std::vector<Part>& parts) {
    return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum_j, const Part& part) {
        return sum_j + part.solver->energy_scale_j();
    });
}

bool all_conserve_energy(const std::vector<Part>& parts) {
    return std::ranges::all_of(parts, [](const Part& part) { return part.solver->conserves_energy(); });
}

void put(const std::vector<double>& values, std::size_t first, std::vector<double>& all) {
    std::copy(values.begin(), values.end(), all.begin() + static_cast<std::ptrdiff_t>(first));
}

/// One solver per body: bodies do not act on each other.
class BodySolvers final : public Solver {
  public:
    /// `parts`: one per body, in order.
    explicit BodySolvers(std::vector<Part> parts);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] bool has_branched() const override;
    void velocities(State& state) override;
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override;
    /// The sum over all bodies.
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::vector<MethodDef> methods() const override;

  private:
    std::vector<Part> parts_;
};

std::span<const Bar> bars_of(const System& system, const Body& body) {
    return std::span(system.bars).subspan(body.first_bar, body.bar_count);
}

/// Estimates of the tensions of a rigid chain with one pin: they pull what hangs on the link, of all free
/// mass unless the first particle is the pin, as fast as gravity and the link that turns fastest together.
/// Empty if a link leans up from the pin and might be compressed.
std::vector<double> hanging_tensions_n(const System& system, const Body& body, const Forces& forces) {
    const std::span<const Bar> bars = bars_of(system, body);
    double fastest_m_s2 = 0.0;
    bool is_after_pin = false;
    for (const Bar& bar : bars) {
        is_after_pin = is_after_pin || system.is_pinned(bar.a);
        const Vec2 along{system.x_m[bar.b] - system.x_m[bar.a], system.y_m[bar.b] - system.y_m[bar.a]};
        const double down = dot(along, forces.uniform_m_s2());
        if (is_after_pin ? down < 0.0 : down > 0.0) return {};
        const double speed_m_s =
            length(system.vx_m_s[bar.b] - system.vx_m_s[bar.a], system.vy_m_s[bar.b] - system.vy_m_s[bar.a]);
        fastest_m_s2 = std::max(fastest_m_s2, speed_m_s * (speed_m_s / bar.rest_m));
    }
    const bool hangs_from_first = system.is_pinned(body.first_particle);
    double all_kg = 0.0;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
        if (!system.is_pinned(i)) all_kg += system.mass_kg[i];
    std::vector<double> tension_n(bars.size());
    double beyond_kg = 0.0;
    for (std::size_t k = bars.size(); k-- > 0;) {
        beyond_kg += system.mass_kg[body.first_particle + k + 1];
        tension_n[k] = (hangs_from_first ? beyond_kg : all_kg) * (forces.strength_m_s2() + fastest_m_s2);
    }
    return tension_n;
}

/// Estimates of the tensions of links that stretch between pins: they carry all that hangs there.
std::vector<double> slung_tensions_n(const System& system, const Body& body, const Forces& forces) {
    double weight_n = 0.0;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
        if (!system.is_pinned(i)) weight_n += system.mass_kg[i] * forces.strength_m_s2();
    return std::vector<double>(body.bar_count, weight_n);
}

/// Bound on the angular frequency in 1/s at which the tensions at t = 0, or soon after it if links stretch,
/// make particles of a chain swing across its links: Gershgorin's, the largest over all particles of 2 w sum
/// of T / l. 0 if links lean up from their only pin, or rigid ones between pins are compressed.
double tension_frequency_1_s(const System& system, const Body& body, const Forces& forces) {
    const std::span<const Bar> bars = bars_of(system, body);
    std::vector<double> tension_n;
    if (pin_count(system, body) == 1 && body.is_chain) {
        tension_n = hanging_tensions_n(system, body, forces);
    } else if (body.material.compliance_1_n > 0.0) {
        tension_n = slung_tensions_n(system, body, forces);
    } else if (system.bodies.size() == 1) {
        ChainDynamics dynamics(system, {&body, 1}, forces);
        dynamics.tensions(dynamics.initial_state().data(), tension_n);
        if (std::ranges::any_of(tension_n, [](double n) { return !(n >= 0.0); })) return 0.0;
    }
    std::vector<double> load_n_m(system.particle_count(), 0.0);
    double largest = 0.0;
    for (std::size_t k = 0; k < tension_n.size(); ++k) {
        for (const std::size_t end : {bars[k].a, bars[k].b}) {
            load_n_m[end] += tension_n[k] / bars[k].rest_m;
            largest = std::max(largest, 2.0 * system.inverse_mass_1_kg[end] * load_n_m[end]);
        }
    }
    return std::sqrt(largest);
}

Loads larger_loads(const Loads& a, const Loads& b) {
    return {std::max(a.pin_force_n, b.pin_force_n), std::max(a.largest_tension_n, b.largest_tension_n)};
}

}  // namespace

BodySolvers::BodySolvers(std::vector<Part> parts)
    : Solver(sum_of_scales_j(parts), all_conserve_energy(parts)), parts_(std::move(parts)) {}

Status BodySolvers::advance_to(double time_s, State& state) {
    for (Part& part : parts_) {
        if (part.solver->advance_to(time_s, part.state) == Status::kDiverged) return Status::kDiverged;
        put(part.state.x_m, part.first_particle, state.x_m);
        put(part.state.y_m, part.first_particle, state.y_m);
    }
    state.time_s = time_s;
    return Status::kOk;
}

double BodySolvers::energy_j() const {
    double energy_j = 0.0;
    for (const Part& part : parts_) energy_j += part.solver->energy_j();
    return energy_j;
}

bool BodySolvers::has_branched() const {
    return std::ranges::any_of(parts_, [](const Part& part) { return part.solver->has_branched(); });
}

void BodySolvers::velocities(State& state) {
    for (Part& part : parts_) {
        part.state.vx_m_s.assign(part.state.x_m.size(), 0.0);
        part.state.vy_m_s.assign(part.state.x_m.size(), 0.0);
        part.solver->velocities(part.state);
        put(part.state.vx_m_s, part.first_particle, state.vx_m_s);
        put(part.state.vy_m_s, part.first_particle, state.vy_m_s);
    }
}

bool BodySolvers::tensions(std::vector<double>& tension_n) {
    bool are_known = true;
    for (Part& part : parts_) {
        are_known = part.solver->tensions(part.state.tension_n) && are_known;
        put(part.state.tension_n, part.first_bar, tension_n);
    }
    return are_known;
}

std::uint64_t BodySolvers::steps() const {
    std::uint64_t steps = 0;
    for (const Part& part : parts_) steps += part.solver->steps();
    return steps;
}

std::vector<MethodDef> BodySolvers::methods() const {
    std::vector<MethodDef> methods;
    for (const Part& part : parts_) methods.push_back(part.solver->methods().front());
    return methods;
}

std::unique_ptr<Solver> make_solver(const System& system, const Forces& forces,
                                    std::span<const MethodDef> methods, double frame_interval_s) {
    const std::size_t count = system.bodies.size();
    if (methods.size() != 1 && methods.size() != count) {
        throw Error(ExitCode::kUsage, std::to_string(methods.size()) + " methods for the " +
                                          std::to_string(count) +
                                          " bodies of the system; give one each, or one for all");
    }
    // `relaxation` fills the lanes of a processor with several small bodies.
    const bool relaxes_all =
        system.moves.empty() && !system.has_events() &&
        std::ranges::all_of(methods, [&](const MethodDef& method) {
            return std::holds_alternative<RelaxationDef>(method) && method == methods.front();
        });
    if (count == 1 || relaxes_all) return make_solver_of(system, forces, methods.front(), frame_interval_s);
    std::vector<Part> parts;
    for_each_body(system, [&](const System& body, std::size_t i) {
        count_work(kUpdatesPerBody + body.particle_count());
        const MethodDef& method = methods.size() == 1 ? methods.front() : methods[i];
        parts.push_back({system.bodies[i].first_particle,
                         system.bodies[i].first_bar,
                         make_solver_of(body, forces, method, frame_interval_s),
                         {0.0, body.x_m, body.y_m}});
        parts.back().state.tension_n.resize(body.bars.size());
    });
    return std::make_unique<BodySolvers>(std::move(parts));
}

void validate(const MethodDef& method) {
    const char* const problem =
        with_solver(method, []<class S>(const auto& def) { return S::problem_of(def); });
    if (problem != nullptr)
        throw Refusal(Refusal::Reason::kDefinition, std::string(method_name(method)) + ": " + problem);
}

std::string method_text(const MethodDef& method) {
    return with_solver(method, []<class S>(const auto& def) { return S::text_of(def); });
}

std::optional<double> fixed_step_s(const MethodDef& method) {
    return std::visit(
        [](const auto& def) -> std::optional<double> {
            if constexpr (requires { def.step_s; })
                return def.step_s;
            else
                return std::nullopt;
        },
        method);
}

bool knows_tensions(const MethodDef& method) {
    return with_solver(method, []<class S>(const auto&) { return S::kKnowsTensions; });
}

double most_implicit_steps_1_s(const System& system, const Body& body, const Forces& forces) {
    if (!ImplicitPart::can_move(system, body)) return 0.0;
    // Of explicit steps, which take as long as implicit ones: 80 to 120 ns per link.
    constexpr double kFrequencyTimesStep = 2.5;  // of swings of 400 and 1000 links in 3 s
    constexpr double kIfStretching = 5.0;        // at the limit of stability
    const double across_1_s = tension_frequency_1_s(system, body, forces);
    if (body.material.compliance_1_n == 0.0 || across_1_s == 0.0) return across_1_s / kFrequencyTimesStep;
    const ElasticForces elastic(system, body.first_particle, body.particle_count);
    return std::sqrt(elastic.common_square_frequency()) / kIfStretching;
}

double implicit_steps_1_s(const System& system, const Body& body, const Forces& forces, double tolerance) {
    // The frequency of the shortest wave over twice the number of links is that of the whole rope.
    const double swing_1_s =
        tension_frequency_1_s(system, body, forces) / (2.0 * static_cast<double>(body.link_count));
    // At a tolerance of 1.
    constexpr double kStepsOfSwing = 12.0;      // they grow with its inverse fourth root
    constexpr double kStepsIfStretching = 3.6;  // with vibrations along the rope, with its root
    const double root = std::sqrt(tolerance);
    return swing_1_s *
           (body.material.compliance_1_n > 0.0 ? kStepsIfStretching / root : kStepsOfSwing / std::sqrt(root));
}

LoadMeter::LoadMeter(const System& system) : fx_n_(system.particle_count()), fy_n_(system.particle_count()) {
    if (system.bends.empty()) return;
    event_s_ = event_times_s(system);
    bends_.emplace(system, 0, system.particle_count());
}

void LoadMeter::find_forces(const System& system, const State& state, std::span<const double> tension_n) {
    std::ranges::fill(fx_n_, 0.0);
    std::ranges::fill(fy_n_, 0.0);
    for (std::size_t k = 0; k < tension_n.size(); ++k) {
        if (tension_n[k] == 0.0) continue;
        const auto [a, b, reach, rest_m] = system.bars[k];
        const Vec2 along{state.x_m[b] - state.x_m[a], state.y_m[b] - state.y_m[a]};
        const Vec2 pull_n = (tension_n[k] / length(along.x, along.y)) * along;
        fx_n_[a] += pull_n.x;
        fy_n_[a] += pull_n.y;
        fx_n_[b] -= pull_n.x;
        fy_n_[b] -= pull_n.y;
    }
    const auto next = std::ranges::upper_bound(event_s_, state.time_s);
    if (const auto phase = static_cast<std::size_t>(next - event_s_.begin()); phase != phase_) {
        phase_ = phase;
        bends_.emplace(phase == 0 ? system : from_event_on(system, *(next - 1)), 0, system.particle_count());
    }
    if (bends_) bends_->add_bend_forces({state.x_m.data(), state.y_m.data()}, {fx_n_.data(), fy_n_.data()});
}

std::optional<Loads> LoadMeter::of(const System& system, const State& state,
                                   std::span<const double> tension_n) {
    Loads loads;
    for (const double tension : tension_n) {
        if (std::isnan(tension)) return std::nullopt;
        loads.largest_tension_n = std::max(loads.largest_tension_n, std::abs(tension));
    }
    find_forces(system, state, tension_n);
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (system.is_pinned_at(i, state.time_s))
            loads.pin_force_n = std::max(loads.pin_force_n, length(fx_n_[i], fy_n_[i]));
    }
    return loads;
}

double LoadMeter::support_power_w(const System& system, const State& state,
                                  std::span<const double> tension_n) {
    find_forces(system, state, tension_n);
    double power_w = 0.0;
    for (const MoveDef& move : system.moves) {
        if (!system.is_pinned_at(move.pin, state.time_s)) continue;
        power_w -= dot({fx_n_[move.pin], fy_n_[move.pin]}, {state.vx_m_s[move.pin], state.vy_m_s[move.pin]});
    }
    return power_w;
}

Figures larger_figures(const Figures& a, const Figures& b) {
    Figures larger;
    larger.strain = std::max(a.strain, b.strain);
    if (a.energy_error || b.energy_error)
        larger.energy_error = std::max(a.energy_error.value_or(0.0), b.energy_error.value_or(0.0));
    if (a.loads || b.loads) larger.loads = larger_loads(a.loads.value_or(Loads{}), b.loads.value_or(Loads{}));
    return larger;
}

std::optional<Loads> loads_of_both(const std::optional<Loads>& a, const std::optional<Loads>& b) {
    if (!a || !b) return std::nullopt;
    return larger_loads(*a, *b);
}

std::optional<double> energy_error(double change_j, double scale_j) {
    if (std::isnan(change_j) || !(scale_j > 0.0)) return std::nullopt;
    return std::abs(change_j) / scale_j;
}

}  // namespace corda::sim
