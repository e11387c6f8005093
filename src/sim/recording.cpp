#include "corda/sim/recording.hpp"

#include <algorithm>

namespace corda::sim {

Recording::Recording(std::size_t particle_count, std::size_t state_count, std::size_t budget_bytes)
    : particle_count_(particle_count),
      most_states_(std::min(state_count,
                            budget_bytes / ((2 * particle_count + 1) * sizeof(double) + sizeof(Figures)))) {
    values_.reserve(most_states_ * (2 * particle_count + 1));
    figures_.reserve(most_states_);
}

void Recording::clear() {
    size_ = 0;
    values_.clear();
    figures_.clear();
    bounds_ = {};
    diagnostics_ = {};
    wall_s_ = 0.0;
}

Status Recording::advance(Simulation& run, double time_s, const std::function<double()>& clock_s,
                          const GoesOn& goes_on) {
    const double start_s = clock_s ? clock_s() : 0.0;
    const Status status = run.advance_to(time_s, goes_on);
    if (clock_s) wall_s_ += clock_s() - start_s;
    if (status == Status::kDiverged) return status;
    const State& state = run.state();
    ++size_;
    bounds_.include(state);
    diagnostics_ = run.diagnostics();
    if (size_ > most_states_) return status;
    values_.push_back(state.time_s);
    values_.insert(values_.end(), state.x_m.begin(), state.x_m.end());
    values_.insert(values_.end(), state.y_m.begin(), state.y_m.end());
    figures_.push_back(run.figures());
    return status;
}

void Recording::read(std::size_t i, State& state) const {
    const auto values = values_.begin() + static_cast<std::ptrdiff_t>(i * (2 * particle_count_ + 1));
    const auto middle = values + 1 + static_cast<std::ptrdiff_t>(particle_count_);
    state.time_s = *values;
    state.x_m.assign(values + 1, middle);
    state.y_m.assign(middle, middle + static_cast<std::ptrdiff_t>(particle_count_));
}

}  // namespace corda::sim
