#include "corda/sim/phases.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "corda/sim/events.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/loose_particles.hpp"
#include "corda/sim/parts.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// The parts of a body at its start that a method moves each for itself.
std::vector<PartOfBody> parts_for(const System& body, const MethodDef& method) {
    // In `relaxation`, the order of the bars is that of the body.
    if (std::holds_alternative<RelaxationDef>(method)) return {whole_of(body)};
    return connected_parts(body);
}

/// The solver of a part of a later phase.
std::unique_ptr<Solver> make_part(const System& body, const Forces& forces, const MethodDef& method,
                                  const MakePart& make, PartOfBody& part) {
    if (part.is_loose) return std::make_unique<LooseParticles>(system_of(body, part), forces, method);
    const auto made = [&](const MethodDef& by) { return make(system_of(body, part), forces, by, part.bars); };
    try {
        return made(method);
    } catch (const Refusal& refused) {
        const auto* exact = std::get_if<ExactDef>(&method);
        if (refused.reason() == Refusal::Reason::kImplicit) return made(ExactDef{exact->tolerance});
        // A path of bars of a net that is straight between two pins holds as a net's row does.
        const bool was_chain = body.bodies.front().is_chain;
        if (refused.reason() != Refusal::Reason::kTautBetweenPins || was_chain || !part.is_chain) throw;
        part.is_chain = false;
        return made(method);
    }
}

/// The method, with the shortest of the steps that it would choose in the phases, all at the places of the
/// start. `own`: its settings in the first phase.
MethodDef with_step_for_all(const System& body, const Forces& forces, const MethodDef& method, MethodDef own,
                            const MakePart& make) {
    if (std::holds_alternative<ExactDef>(method) || fixed_step_s(method)) return own;
    std::optional<double> least_s = fixed_step_s(own);
    // A step that is too long in others is divided there.
    constexpr std::size_t kMost = 16;
    const std::vector<double> times_s = event_times_s(body);
    const std::size_t stride = (times_s.size() + kMost - 1) / kMost;
    for (std::size_t k = times_s.size(); k > 0; k -= std::min(k, stride)) {
        const double time_s = times_s[k - 1];
        const System later = from_event_on(body, time_s);
        for (PartOfBody& part : parts_for(later, method)) {
            try {
                const auto solver = make_part(later, forces.from(time_s), method, make, part);
                const auto step_s = fixed_step_s(solver->methods().front());
                if (step_s) least_s = std::min(*step_s, least_s.value_or(*step_s));
            } catch (const Refusal&) {
                // It may move the part from other places.
            }
        }
    }
    std::visit(
        [&](auto& def) {
            if constexpr (requires { def.step_s; }) def.step_s = least_s;
        },
        own);
    return own;
}

class Phases final : public Solver {
  public:
    Phases(const System& body, const Forces& forces, const MethodDef& method, MakePart make);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] bool has_branched() const override;
    void velocities(State& state) override { read_velocities(state); }
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override;
    /// The sum over all parts of all phases so far.
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::vector<MethodDef> methods() const override { return {method_}; }
    [[nodiscard]] double margin_m() const override { return margin_m_; }

  private:
    struct Part {
        PartOfBody of;
        std::unique_ptr<Solver> solver;
        State state;
    };

    /// In the present phase.
    [[nodiscard]] Forces forces_until_event() const;
    /// Starts the phase at the time of now_.
    void enter_phase();
    /// Ends the present phase at the next event, and starts another.
    [[nodiscard]] bool pass_event();
    /// Moves all parts to a time within the present phase, and writes their positions to place_.
    [[nodiscard]] bool move_parts(double time_s);
    /// Writes the velocities at the last positions, of pins too.
    void read_velocities(State& state) const;
    void add_part(PartOfBody of, std::unique_ptr<Solver> solver);

    System now_;  ///< the body at the start of the present phase
    Forces forces_;
    MethodDef method_;
    MakePart make_;
    EnergyMeter meter_;
    std::vector<double> times_s_;  ///< of the events that are left, the next one last
    std::vector<Part> parts_;
    State place_;  ///< the last positions
    double margin_m_ = std::numeric_limits<double>::infinity();
    bool has_branched_ = false;       ///< in a former phase
    std::uint64_t steps_before_ = 0;  ///< of former phases
};

Phases::Phases(const System& body, const Forces& forces, const MethodDef& method, MakePart make)
    : Solver(sim::energy_scale_j(body, forces.on_particles(body)), false),
      now_(body),
      forces_(forces),
      method_(method),
      make_(std::move(make)),
      meter_(now_, forces, {&method, 1}),
      times_s_(event_times_s(body)),
      place_{0.0, body.x_m, body.y_m} {
    std::ranges::reverse(times_s_);
    PartOfBody whole = whole_of(body);
    std::unique_ptr<Solver> first;
    const auto make_first = [&](const MethodDef& by) {
        first = make_(system_of(body, whole), forces_until_event(), by, whole.bars);
        return first->methods().front();
    };
    const bool starts_whole = times_s_.back() > 0.0;
    const MethodDef own = starts_whole ? make_first(method) : method;
    method_ = with_step_for_all(body, forces, method, own, make_);
    if (!starts_whole) {
        times_s_.pop_back();
        now_ = from_event_on(std::move(now_), 0.0);
        enter_phase();
        return;
    }
    if (method_ != own) make_first(method_);
    add_part(std::move(whole), std::move(first));
}

void Phases::add_part(PartOfBody of, std::unique_ptr<Solver> solver) {
    const System part = system_of(now_, of);
    State state{0.0, part.x_m, part.y_m};
    state.tension_n.resize(part.bars.size());
    parts_.push_back({std::move(of), std::move(solver), std::move(state)});
}

Forces Phases::forces_until_event() const {
    // Steps need not end at an event that comes at once: states within their first parts are exact.
    constexpr double kSoonSeconds = 1e-12;
    const Forces forces = forces_.from(now_.start_s);
    const double left_s = times_s_.empty() ? 0.0 : times_s_.back() - now_.start_s;
    return left_s > kSoonSeconds ? forces.until(left_s) : forces;
}

void Phases::enter_phase() {
    const double start_s = now_.start_s;
    const Forces forces = forces_until_event();
    parts_.clear();
    for (PartOfBody& part : parts_for(now_, method_)) {
        try {
            std::unique_ptr<Solver> solver = make_part(now_, forces, method_, make_, part);
            add_part(std::move(part), std::move(solver));
        } catch (const Refusal& refused) {
            throw Refusal(refused.reason(), fmt::format("from {} s on: {}", start_s, refused.what()));
        }
    }
}

bool Phases::pass_event() {
    const double time_s = times_s_.back();
    if (!move_parts(time_s)) return false;
    State place{time_s, place_.x_m, place_.y_m, now_.vx_m_s, now_.vy_m_s};
    read_velocities(place);
    now_.x_m = std::move(place.x_m);
    now_.y_m = std::move(place.y_m);
    now_.vx_m_s = std::move(place.vx_m_s);
    now_.vy_m_s = std::move(place.vy_m_s);
    for (const Part& part : parts_) {
        std::vector<Bar> bars;
        for (const std::size_t k : part.of.bars) bars.push_back(now_.bars[k]);
        part.solver->read_rest_lengths(bars);
        for (std::size_t j = 0; j < bars.size(); ++j) now_.bars[part.of.bars[j]].rest_m = bars[j].rest_m;
    }
    has_branched_ = has_branched();
    steps_before_ = steps();
    times_s_.pop_back();
    now_ = from_event_on(std::move(now_), time_s);
    enter_phase();
    return true;
}

bool Phases::move_parts(double time_s) {
    for (Part& part : parts_) {
        if (part.solver->advance_to(time_s - now_.start_s, part.state) == Status::kDiverged) return false;
        margin_m_ = std::min(margin_m_, part.solver->margin_m());
        for (std::size_t i = 0; i < part.of.particles.size(); ++i) {
            place_.x_m[part.of.particles[i]] = part.state.x_m[i];
            place_.y_m[part.of.particles[i]] = part.state.y_m[i];
        }
    }
    place_.time_s = time_s;
    return true;
}

Status Phases::advance_to(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    margin_m_ = std::numeric_limits<double>::infinity();
    while (!times_s_.empty() && times_s_.back() <= time_s) {
        if (!pass_event()) return Status::kDiverged;
    }
    if (!move_parts(time_s)) return Status::kDiverged;
    state.time_s = time_s;
    state.x_m = place_.x_m;
    state.y_m = place_.y_m;
    return Status::kOk;
}

void Phases::read_velocities(State& state) const {
    for (const Part& part : parts_) {
        State own = part.state;
        own.vx_m_s.assign(own.x_m.size(), 0.0);
        own.vy_m_s.assign(own.x_m.size(), 0.0);
        part.solver->velocities(own);
        for (std::size_t i = 0; i < part.of.particles.size(); ++i) {
            state.vx_m_s[part.of.particles[i]] = own.vx_m_s[i];
            state.vy_m_s[part.of.particles[i]] = own.vy_m_s[i];
        }
    }
}

double Phases::energy_j() const {
    State place = place_;
    place.vx_m_s.resize(place.x_m.size());
    place.vy_m_s.resize(place.x_m.size());
    read_velocities(place);
    const Energy energy = meter_.of(place);
    return energy.kinetic_j + energy.potential_j();
}

bool Phases::has_branched() const {
    return has_branched_ ||
           std::ranges::any_of(parts_, [](const Part& part) { return part.solver->has_branched(); });
}

bool Phases::tensions(std::vector<double>& tension_n) {
    std::ranges::fill(tension_n, 0.0);
    bool are_known = true;
    for (Part& part : parts_) {
        are_known = part.solver->tensions(part.state.tension_n) && are_known;
        for (std::size_t j = 0; j < part.of.bars.size(); ++j)
            tension_n[part.of.bars[j]] = part.state.tension_n[j];
    }
    return are_known;
}

std::uint64_t Phases::steps() const {
    std::uint64_t steps = steps_before_;
    for (const Part& part : parts_) steps += part.solver->steps();
    return steps;
}

}  // namespace

std::unique_ptr<Solver> solve_in_phases(const System& body, const Forces& forces, const MethodDef& method,
                                        MakePart make) {
    return std::make_unique<Phases>(body, forces, method, std::move(make));
}

}  // namespace corda::sim
