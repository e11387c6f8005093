#include "corda/sim/recording.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include "corda/core/cancel.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// Work of writing a state of a body into a file, in updates of a particle (see count_work()).
constexpr std::size_t kWritesOfState = 20;

constexpr unsigned kDropped = 48;  // low bits of a double that a bin ignores
constexpr std::size_t kBins = std::size_t{1} << (63U - kDropped);

double tension_of_link(const System& /*system*/, const Body& /*body*/, std::size_t k, const State& state) {
    return state.tension_n[k];
}

/// Mean speed of the ends.
double speed_of_link(const System& system, const Body& /*body*/, std::size_t k, const State& state) {
    const auto [a, b, reach, rest_m] = system.bars[k];
    return 0.5 * (length(state.vx_m_s[a], state.vy_m_s[a]) + length(state.vx_m_s[b], state.vy_m_s[b]));
}

double strain_of_link(const System& system, const Body& body, std::size_t k, const State& state) {
    if (!system.has_bar_at(k, state.time_s)) return 0.0;
    const auto [a, b, reach, rest_m] = system.bars[k];
    const double strain = length(state.x_m[b] - state.x_m[a], state.y_m[b] - state.y_m[a]) / rest_m - 1.0;
    return body.material.is_string ? std::max(0.0, strain) : strain;
}

/// One row per Quantity, in its order.
constexpr std::array<QuantityKind, 3> kQuantities{{{"tension", "N", {.tensions = true}, tension_of_link},
                                                   {"speed", "m/s", {.velocities = true}, speed_of_link},
                                                   {"strain", "", {}, strain_of_link}}};

}  // namespace

const QuantityKind& kind_of(Quantity quantity) {
    return kQuantities[static_cast<std::size_t>(quantity)];
}

double max_strain(const System& system, const State& state) {
    double largest = 0.0;
    for (const Body& body : system.bodies) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
            largest = std::max(largest, std::abs(strain_of_link(system, body, k, state)));
        }
    }
    return largest;
}

void Histogram::add(double value) {
    if (std::isnan(value)) return;
    ++count_;
    least_ = std::min(least_, value);
    largest_ = std::max(largest_, value);
    counts_.resize(kBins);
    ++counts_[std::bit_cast<std::uint64_t>(std::abs(value)) >> kDropped];
}

void Histogram::add(const Histogram& other) {
    count_ += other.count_;
    least_ = std::min(least_, other.least_);
    largest_ = std::max(largest_, other.largest_);
    if (other.empty()) return;
    counts_.resize(kBins);
    std::transform(counts_.begin(), counts_.end(), other.counts_.begin(), counts_.begin(), std::plus<>());
}

double Histogram::size_exceeded_by(double share) const {
    const double all = std::max(std::abs(least_), std::abs(largest_));
    std::uint64_t larger = 0;
    for (std::size_t bin = counts_.size(); bin-- > 0;) {
        larger += counts_[bin];
        if (static_cast<double>(larger) > share * static_cast<double>(count_))
            return std::min(all, std::bit_cast<double>(std::uint64_t{bin + 1} << kDropped));
    }
    return 0.0;
}

Recording::Recording(std::size_t particle_count, std::size_t state_count, std::size_t bar_count,
                     std::optional<Quantity> quantity, const StateFields& fields)
    : particle_count_(particle_count),
      quantity_(quantity),
      fields_(quantity ? fields.with(kind_of(*quantity).fields) : fields),
      parts_{{{&State::x_m, particle_count},
              {&State::y_m, particle_count},
              {&State::vx_m_s, fields_.velocities ? particle_count : 0},
              {&State::vy_m_s, fields_.velocities ? particle_count : 0},
              {&State::tension_n, fields_.tensions ? bar_count : 0, true}}},
      state_size_(std::accumulate(parts_.begin(), parts_.end(), std::size_t{1},
                                  [](std::size_t sum, const Part& part) { return sum + part.count; })),
      most_states_(state_count),
      values_(state_count * state_size_) {
    particle_bounds_.resize(particle_count);
    row_.reserve(state_size_);
    figures_.reserve(state_count);
    energy_change_j_.reserve(state_count);
}

Recording Recording::for_part(std::size_t particle_count, std::size_t bar_count) const {
    return {particle_count, most_states_, bar_count, quantity_, fields_};
}

bool Recording::fits(std::size_t particle_count, std::size_t bar_count) const {
    return particle_count_ == particle_count && (!fields_.tensions || parts_.back().count == bar_count);
}

void Recording::clear() {
    figures_.clear();
    energy_change_j_.clear();
    energy_scale_j_ = 0.0;
    bounds_ = {};
    particle_bounds_.assign(particle_count_, {});
    histogram_ = {};
    diagnostics_ = {};
    wall_s_ = 0.0;
    bodies_ = 0;
}

Status Recording::advance(Simulation& run, const Timeline& timeline, const std::function<double()>& clock_s) {
    run.set_outputs(fields_);
    const double start_s = clock_s ? clock_s() : 0.0;
    const Status status = run.advance_to(timeline.time_s(size()));
    if (clock_s) wall_s_ += clock_s() - start_s;
    if (status == Status::kDiverged) return status;
    diagnostics_ = run.diagnostics();
    energy_scale_j_ = run.energy_scale_j();
    add_state(run.system(), run.state(), run.figures(), timeline.is_frame(size()));
    energy_change_j_.push_back(run.energy_change_j());
    return status;
}

void Recording::add(const System& system, const State& state, const Figures& figures, bool is_frame) {
    diagnostics_.largest = larger_figures(diagnostics_.largest, figures);
    add_state(system, state, figures, is_frame);
    energy_change_j_.push_back(figures.energy_change_j);
}

void Recording::add_state(const System& system, const State& state, const Figures& figures, bool is_frame) {
    if (is_frame) {
        bounds_.include(state);
        for (std::size_t i = 0; i < particle_count_; ++i)
            particle_bounds_[i].include(state.x_m[i], state.y_m[i]);
        if (quantity_) add_to_histogram(system, state);
    }
    row_.clear();
    row_.push_back(state.time_s);
    for (const Part& part : parts_) {
        const auto first = (state.*part.array).begin();
        row_.insert(row_.end(), first, first + static_cast<std::ptrdiff_t>(part.count));
    }
    values_.write(figures_.size() * state_size_, row_);
    figures_.push_back(figures);
}

void Recording::add_to_histogram(const System& system, const State& state) {
    for (const Body& body : system.bodies) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k)
            if (system.has_bar_at(k, state.time_s))
                histogram_.add(kind_of(*quantity_).value(system, body, k, state));
    }
}

void Recording::add_body(const Recording& body, std::size_t first_particle, std::size_t first_bar) {
    if (bodies_++ == 0) {
        energy_change_j_.assign(body.size(), 0.0);
        figures_.assign(body.figures_.size(), Figures{0.0, std::nullopt, Loads{}});
        diagnostics_.largest.loads = Loads{};
    }
    energy_change_j_.resize(std::min(size(), body.size()));
    figures_.resize(std::min(figures_.size(), body.figures_.size()));
    bounds_.include(body.bounds_);
    histogram_.add(body.histogram_);
    std::copy(body.particle_bounds_.begin(), body.particle_bounds_.end(),
              particle_bounds_.begin() + static_cast<std::ptrdiff_t>(first_particle));
    wall_s_ += body.wall_s_;
    add_figures(body);
    for (std::size_t i = 0; i < size(); ++i) {
        count_work(body.particle_count_ + kWritesOfState);
        row_.resize(body.state_size_);
        body.values_.read(i * body.state_size_, row_);
        std::span<const double> from = row_;
        std::size_t to = i * state_size_;
        values_.write(to++, from.first(1));
        from = from.subspan(1);
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            const std::size_t count = body.parts_[p].count;
            values_.write(to + (parts_[p].is_of_bars ? first_bar : first_particle), from.first(count));
            from = from.subspan(count);
            to += parts_[p].count;
        }
    }
}

void Recording::add_figures(const Recording& body) {
    energy_scale_j_ += body.energy_scale_j_;
    diagnostics_.steps += body.diagnostics_.steps;
    Figures& largest = diagnostics_.largest;
    largest.strain = std::max(largest.strain, body.diagnostics_.largest.strain);
    largest.loads = loads_of_both(largest.loads, body.diagnostics_.largest.loads);
    if (body.diagnostics_.branched_s) {
        diagnostics_.branched_s =
            std::min(*body.diagnostics_.branched_s, diagnostics_.branched_s.value_or(HUGE_VAL));
    }
    largest.energy_error = std::nullopt;
    for (std::size_t i = 0; i < size(); ++i) {
        energy_change_j_[i] += body.energy_change_j_[i];
        const auto error = energy_error(energy_change_j_[i], energy_scale_j_);
        if (error) largest.energy_error = std::max(largest.energy_error.value_or(0.0), *error);
        Figures& figures = figures_[i];
        figures.strain = std::max(figures.strain, body.figures_[i].strain);
        figures.loads = loads_of_both(figures.loads, body.figures_[i].loads);
        figures.energy_error = error;
        figures.energy_change_j += body.figures_[i].energy_change_j;
    }
}

void Recording::read(std::size_t i, State& state) const {
    std::size_t at = i * state_size_;
    values_.read(at++, {&state.time_s, 1});
    for (const Part& part : parts_) {
        (state.*part.array).resize(part.count);
        values_.read(at, state.*part.array);
        at += part.count;
    }
}

}  // namespace corda::sim
