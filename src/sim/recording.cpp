#include "corda/sim/recording.hpp"

#include <algorithm>

#include "corda/sim/figures.hpp"

namespace corda::sim {

Recording::Recording(std::size_t particle_count, std::size_t state_count, std::size_t budget_bytes)
    : particle_count_(particle_count),
      most_states_(std::min(state_count, budget_bytes / (state_size() * sizeof(double) + sizeof(Figures)))) {
    particle_bounds_.resize(particle_count);
    values_.reserve(most_states_ * state_size());
    figures_.reserve(most_states_);
    energy_change_j_.reserve(state_count);
}

Recording Recording::for_part(std::size_t particle_count) const {
    Recording part(particle_count, 0, 0);
    part.most_states_ = most_states_;
    return part;
}

void Recording::clear() {
    values_.clear();
    figures_.clear();
    energy_change_j_.clear();
    energy_scale_j_ = 0.0;
    bounds_ = {};
    particle_bounds_.assign(particle_count_, {});
    diagnostics_ = {};
    wall_s_ = 0.0;
    bodies_ = 0;
}

Status Recording::advance(Simulation& run, const Timeline& timeline, const std::function<double()>& clock_s,
                          const GoesOn& goes_on) {
    const double start_s = clock_s ? clock_s() : 0.0;
    const Status status = run.advance_to(timeline.time_s(size()), goes_on);
    if (clock_s) wall_s_ += clock_s() - start_s;
    if (status == Status::kDiverged) return status;
    const State& state = run.state();
    if (timeline.is_frame(size())) {
        bounds_.include(state);
        for (std::size_t i = 0; i < particle_count_; ++i)
            particle_bounds_[i].include(state.x_m[i], state.y_m[i]);
    }
    diagnostics_ = run.diagnostics();
    energy_change_j_.push_back(run.energy_change_j());
    energy_scale_j_ = run.energy_scale_j();
    if (size() > most_states_) return status;
    figures_.push_back(run.figures());
    values_.push_back(state.time_s);
    values_.insert(values_.end(), state.x_m.begin(), state.x_m.end());
    values_.insert(values_.end(), state.y_m.begin(), state.y_m.end());
    return status;
}

void Recording::add_body(const Recording& body, std::size_t first_particle) {
    if (bodies_++ == 0) {
        energy_change_j_.assign(body.size(), 0.0);
        figures_.assign(body.figures_.size(), Figures{0.0, std::nullopt, Loads{}});
        values_.resize(body.figures_.size() * state_size());
        diagnostics_.largest.loads = Loads{};
    }
    energy_change_j_.resize(std::min(size(), body.size()));
    figures_.resize(std::min(figures_.size(), body.figures_.size()));
    values_.resize(figures_.size() * state_size());
    bounds_.include(body.bounds_);
    std::copy(body.particle_bounds_.begin(), body.particle_bounds_.end(),
              particle_bounds_.begin() + static_cast<std::ptrdiff_t>(first_particle));
    wall_s_ += body.wall_s_;
    add_figures(body);
    for (std::size_t i = 0; i < figures_.size(); ++i) {
        const double* const from = &body.values_[i * body.state_size()];
        double* const to = &values_[i * state_size()];
        *to = *from;
        std::copy_n(from + 1, body.particle_count_, to + 1 + first_particle);
        std::copy_n(from + 1 + body.particle_count_, body.particle_count_,
                    to + 1 + particle_count_ + first_particle);
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
        if (!holds(i)) continue;
        Figures& figures = figures_[i];
        figures.strain = std::max(figures.strain, body.figures_[i].strain);
        figures.loads = loads_of_both(figures.loads, body.figures_[i].loads);
        figures.energy_error = error;
    }
}

void Recording::read(std::size_t i, State& state) const {
    const auto values = values_.begin() + static_cast<std::ptrdiff_t>(i * state_size());
    const auto middle = values + 1 + static_cast<std::ptrdiff_t>(particle_count_);
    state.time_s = *values;
    state.x_m.assign(values + 1, middle);
    state.y_m.assign(middle, middle + static_cast<std::ptrdiff_t>(particle_count_));
}

}  // namespace corda::sim
