#include "corda/sim/exact/string/part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/exact/chain_closing.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// A link that is shorter than its rest length by more than this share, and by more than this number of units
/// in the last place of the farthest coordinate, starts slack.
constexpr double kAtRest = 1e-12;
constexpr double kUlpsAtRest = 8.0;

/// A link that is longer than its rest length by more than this share is an error in the scene; less is
/// rounding.
constexpr double kTooLong = 1e-9;

/// More events per link than this within kBurst of the string's time scale would never end. A snap that runs
/// along the string takes a few events per link.
constexpr std::uint64_t kMaxEventsALink = 1000;
constexpr double kBurst = 1e-6;

double distance_m(const System& string, const Bar& link) {
    return length(string.x_m[link.b] - string.x_m[link.a], string.y_m[link.b] - string.y_m[link.a]);
}

/// A copy of the system relative to its first particle.
System relative_to_first(System string) {
    const Vec2 offset{string.x_m[0], string.y_m[0]};
    for (double& x : string.x_m) x -= offset.x;
    for (double& y : string.y_m) y -= offset.y;
    return string;
}

/// One entry per link. These links count as taut if their tensions do not decide, as in a rope that falls
/// straight.
std::vector<std::uint8_t> links_at_rest_length(const System& string, Vec2 offset_m) {
    double farthest_m = 0.0;
    for (std::size_t i = 0; i < string.particle_count(); ++i)
        farthest_m = std::max({farthest_m, std::abs(string.x_m[i]), std::abs(string.y_m[i])});
    // A later phase has its places from the system's origin.
    if (string.start_s > 0.0) farthest_m += std::max(std::abs(offset_m.x), std::abs(offset_m.y));
    const double rounding_m = kUlpsAtRest * std::numeric_limits<double>::epsilon() * farthest_m;
    std::vector<std::uint8_t> is_taut;
    for (const Bar& link : string.bars) {
        const double missing_m = std::max(kAtRest * link.rest_m, rounding_m);
        is_taut.push_back(distance_m(string, link) >= link.rest_m - missing_m ? 1 : 0);
    }
    return is_taut;
}

void refuse_bends(const System& system) {
    if (system.bends.empty()) return;
    throw Refusal(Refusal::Reason::kRigidBendingString,
                  "method exact moves a string of rigid links only if it does not resist bending");
}

void refuse_long_links(const System& string) {
    for (std::size_t k = 0; k < string.bars.size(); ++k) {
        const double now_m = distance_m(string, string.bars[k]);
        if (now_m <= (1.0 + kTooLong) * string.bars[k].rest_m) continue;
        throw Refusal(Refusal::Reason::kStretchedString,
                      "link " + std::to_string(k) + " of a string is longer than its rest length (" +
                          std::to_string(now_m) + " m for " + std::to_string(string.bars[k].rest_m) +
                          " m), and rigid links do not stretch");
    }
}

/// Refuses a string whose rest length is the distance between two of its pins: it is straight there.
void refuse_taut(const System& string) {
    std::optional<std::size_t> last;
    double rest_m = 0.0;
    for (std::size_t i = 0; i < string.particle_count(); ++i) {
        if (string.is_pinned(i)) {
            if (last && i > *last + 1) {
                refuse_taut_between_pins(
                    rest_m, {string.x_m[i] - string.x_m[*last], string.y_m[i] - string.y_m[*last]}, *last, i);
            }
            last = i;
            rest_m = 0.0;
        }
        if (i < string.bars.size()) rest_m += string.bars[i].rest_m;
    }
}

}  // namespace

StringPart::StringPart(const System& system, const Forces& forces, double tolerance,
                       std::vector<double> longer_m)
    : Exact(system, forces, {tolerance}),
      forces_(forces),
      tolerance_(tolerance),
      offset_m_{system.x_m.front(), system.y_m.front()},
      string_(relative_to_first(system)),
      is_taut_(links_at_rest_length(string_, offset_m_)),
      longer_m_(std::move(longer_m)),
      contacts_(string_, forces, tolerance),
      finder_(string_.particle_count()) {
    count_work(1 + string_.particle_count());
    refuse_bends(system);
    refuse_long_links(string_);
    refuse_taut(string_);
    if (!start(0.0)) {
        throw Refusal(Refusal::Reason::kUndecidedString,
                      "the start does not determine which links of a string are taut");
    }
    output_ = dynamics_->initial_state();
    local_ = {0.0, string_.x_m, string_.y_m, string_.vx_m_s, string_.vy_m_s};
}

Status StringPart::reach(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    while (known_s_ < time_s) {
        if (!(event_s_ ? pass_event() : take_step())) return Status::kDiverged;
    }
    margin_m_ = std::numeric_limits<double>::infinity();
    std::erase_if(decisions_, [&](const Decision& decision) {
        if (decision.time_s > time_s) return false;
        margin_m_ = std::min(margin_m_, decision.margin_m);
        return true;
    });
    output_.resize(integrator_->size());
    integrator_->interpolate(std::clamp(time_s - start_s_, integrator_->old_time_s(), integrator_->time_s()),
                             output_.data());
    dynamics_->set_time(time_s - start_s_);
    dynamics_->project(output_.data());
    dynamics_->positions(output_.data(), local_);
    for (std::size_t i = 0; i < string_.particle_count(); ++i) {
        if (string_.is_pinned(i)) continue;
        state.x_m[i] = offset_m_.x + local_.x_m[i];
        state.y_m[i] = offset_m_.y + local_.y_m[i];
    }
    return Status::kOk;
}

bool StringPart::start(double first_step_s) {
    if (!contacts_.resolve(string_, is_taut_, start_s_)) return false;
    decisions_.push_back({start_s_, contacts_.margin_m()});
    for (std::size_t k = 0; k < longer_m_.size(); ++k) {
        if (is_taut_[k] == 0) string_.bars[k].rest_m += std::exchange(longer_m_[k], 0.0);
    }
    // Each of these costs about one update per particle.
    const std::size_t updates = 1 + string_.particle_count();
    count_work(updates);
    dynamics_ = std::make_unique<ChainDynamics>(chains_of_string(string_, is_taut_, forces_.from(start_s_)));
    count_work(updates);
    StepControl control = step_control(dynamics_->inverse_timescale_1_s(), tolerance_);
    control.first_s = std::max(control.first_s, first_step_s);
    integrator_ =
        std::make_unique<Dop853>(*dynamics_, dynamics_->initial_state(), dynamics_->error_scales(), control);
    count_work(updates);
    finder_.start(string_, is_taut_, contacts_, *dynamics_);
    count_work(updates);
    return true;
}

bool StringPart::take_step() {
    if (integrator_->step() == Status::kDiverged) return false;
    event_s_ = finder_.first_in_step(*integrator_, *dynamics_);
    known_s_ = start_s_ + (event_s_ ? *event_s_ : integrator_->time_s());
    for (const StringEvents::Miss& miss : finder_.misses()) {
        const double time_s = start_s_ + miss.time_s;
        if (time_s <= known_s_)
            decisions_.push_back({time_s, miss.margin_m / contacts_.error_share(miss.link, time_s)});
    }
    return true;
}

bool StringPart::pass_event() {
    std::vector<double> y(integrator_->size());
    integrator_->interpolate(*event_s_, y.data());
    dynamics_->project(y.data());
    dynamics_->positions(y.data(), local_);
    dynamics_->velocities(y.data(), local_);
    string_.x_m = local_.x_m;
    string_.y_m = local_.y_m;
    string_.vx_m_s = local_.vx_m_s;
    string_.vy_m_s = local_.vy_m_s;
    start_s_ = known_s_;
    event_s_.reset();
    steps_before_ += integrator_->accepted_steps();
    rejected_before_ += integrator_->rejected_steps();
    return count_event() && start(integrator_->next_step_s());
}

bool StringPart::count_event() {
    ++events_;
    const double span_s = kBurst / dynamics_->inverse_timescale_1_s();
    if (start_s_ - burst_s_ > span_s) {
        burst_s_ = start_s_;
        burst_ = 0;
    }
    return ++burst_ <= kMaxEventsALink * string_.bars.size();
}

double StringPart::energy_j() const {
    double energy_j = dynamics_->energy_j(output_.data());
    for (std::size_t i = 0; i < string_.particle_count(); ++i) {
        if (!string_.is_pinned(i)) energy_j += string_.mass_kg[i] * forces_.potential_j_kg(offset_m_);
    }
    return energy_j;
}

void StringPart::read_rest_lengths(std::vector<Bar>& bars) const {
    for (std::size_t k = 0; k < bars.size(); ++k) bars[k].rest_m = string_.bars[k].rest_m;
}

std::uint64_t StringPart::steps() const {
    return steps_before_ + integrator_->accepted_steps();
}

std::uint64_t StringPart::rejected_steps() const {
    return rejected_before_ + integrator_->rejected_steps();
}

}  // namespace corda::sim
