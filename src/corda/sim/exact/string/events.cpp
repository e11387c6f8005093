#include "corda/sim/exact/string/events.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "corda/core/cancel.hpp"

namespace corda::sim {
namespace {

/// The runs of taut links as bodies.
std::vector<Body> runs_of(const std::vector<std::uint8_t>& is_taut) {
    std::vector<Body> runs;
    bool goes_on = false;
    for (std::size_t k = 0; k < is_taut.size(); ++k) {
        if (is_taut[k] != 0) {
            if (!goes_on) {
                Body run;
                run.first_particle = run.first_bar = k;
                run.particle_count = 1;
                runs.push_back(run);
            }
            ++runs.back().particle_count;
            ++runs.back().bar_count;
            ++runs.back().link_count;
        }
        goes_on = is_taut[k] != 0;
    }
    return runs;
}

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The top of a parabola counts as near 0 within this share of its height above the lower outer point, which
/// exceeds the difference of parabola and margin within parts of a step.
constexpr double kNearTop = 0.25;
/// Points tried to find a top; each adds some 30 % to the number of correct digits.
constexpr int kTopPoints = 8;
/// The true top may be between the samples although that of the parabola is beyond by this share of them.
constexpr double kBeyond = 0.25;
/// No point is tried nearer to the last one than this share of the interval: it would add no information.
constexpr double kApart = 0.01;

/// A rise by less than this share of the length is rounding.
constexpr double kTurns = 1e-14;

/// Regula falsi takes some ten points; a bisection every fourth time bounds their number.
constexpr int kRootPoints = 240;

}  // namespace

Chains chains_of_string(const System& string, const std::vector<std::uint8_t>& is_taut,
                        const Forces& forces) {
    Chains chains = make_chains(string, runs_of(is_taut), forces);
    double fastest_1_s = chains.link_count() > 0 ? chains.inverse_timescale_1_s : 0.0;
    for (std::size_t k = 0; k < is_taut.size(); ++k) {
        if (is_taut[k] != 0 || (string.is_pinned(k) && string.is_pinned(k + 1))) continue;
        // A slack link must not exceed its rest length and come back within a small part of a step.
        const double speed_m_s =
            length(string.vx_m_s[k + 1] - string.vx_m_s[k], string.vy_m_s[k + 1] - string.vy_m_s[k]);
        fastest_1_s = std::max(fastest_1_s, forces.inverse_timescale_1_s(string.bars[k].rest_m, speed_m_s));
    }
    chains.inverse_timescale_1_s = fastest_1_s > 0.0 ? fastest_1_s : 1.0;
    const double length_m = links_length_m(string, string.bodies.front());
    for (std::size_t i = 0; i < string.particle_count(); ++i) {
        if (string.is_pinned(i)) continue;
        const bool is_held = (i > 0 && is_taut[i - 1] != 0) || (i < is_taut.size() && is_taut[i] != 0);
        if (!is_held) add_particle(chains, string, i, length_m);
    }
    return chains;
}

StringEvents::StringEvents(std::size_t particles)
    : link_count_(particles - 1),
      rest_m_(link_count_),
      threshold_(link_count_),
      margin_((kParts + 1) * link_count_),
      before_(link_count_),
      link_margin_(link_count_) {
    assert(particles >= 2);
}

void StringEvents::start(const System& string, const std::vector<std::uint8_t>& is_taut,
                         const StringContacts& contacts, ChainDynamics& dynamics) {
    is_taut_ = is_taut;
    state_.x_m = string.x_m;
    state_.y_m = string.y_m;
    for (std::size_t k = 0; k < link_count_; ++k) rest_m_[k] = string.bars[k].rest_m;
    y_ = dynamics.initial_state();
    read(dynamics);
    for (std::size_t k = 0; k < link_count_; ++k) {
        const double rounding = is_taut[k] != 0 ? contacts.tension_error_n(k) : contacts.length_error_m(k);
        threshold_[k] = std::max(0.0, raw_margin(k)) + rounding;
        if (string.is_pinned(k) && string.is_pinned(k + 1)) threshold_[k] = kNever;
    }
    knows_start_ = false;
}

void StringEvents::read(ChainDynamics& dynamics) {
    dynamics.project(y_.data());
    dynamics.positions(y_.data(), state_);
    dynamics.tensions(y_.data(), tension_n_);
}

double StringEvents::raw_margin(std::size_t link) const {
    if (is_taut_[link] != 0) return -tension_n_[link];
    const double dx_m = state_.x_m[link + 1] - state_.x_m[link];
    const double dy_m = state_.y_m[link + 1] - state_.y_m[link];
    return (dx_m * dx_m + dy_m * dy_m - rest_m_[link] * rest_m_[link]) / (2.0 * rest_m_[link]);
}

double StringEvents::measure(const Motion& motion, double time_s, double* margin) {
    count_work(1 + link_count_);
    motion.integrator.interpolate(time_s, y_.data());
    motion.dynamics.set_time(time_s);
    read(motion.dynamics);
    double largest = -kNever;
    for (std::size_t k = 0; k < link_count_; ++k) {
        margin[k] = raw_margin(k) - threshold_[k];
        largest = std::max(largest, margin[k]);
    }
    return largest;
}

std::optional<double> StringEvents::first_in_step(Dop853& integrator, ChainDynamics& dynamics) {
    const Motion motion{integrator, dynamics};
    const double start_s = integrator.old_time_s();
    const double part_s = (integrator.time_s() - start_s) / static_cast<double>(kParts);
    misses_.clear();
    for (std::size_t j = 0; j < kParts; ++j) time_s_[j] = start_s + static_cast<double>(j) * part_s;
    time_s_[kParts] = integrator.time_s();
    if (knows_start_) {
        std::copy(row(kParts), row(kParts) + link_count_, row(0));
        largest_[0] = largest_[kParts];
        std::copy(row(kParts - 1), row(kParts), before_.begin());
    } else {
        largest_[0] = measure(motion, start_s, row(0));
        if (largest_[0] >= 0.0) return start_s;
    }
    for (std::size_t j = 1; j <= kParts; ++j) {
        largest_[j] = measure(motion, time_s_[j], row(j));
        if (j == 1 && knows_start_) add_misses_at_start();
        if (j >= 2) {
            if (const auto high = first_top(motion, j - 1)) {
                return root(motion, {time_s_[j - 2], largest_[j - 2]}, *high);
            }
        }
        if (largest_[j] >= 0.0)
            return root(motion, {time_s_[j - 1], largest_[j - 1]}, {time_s_[j], largest_[j]});
    }
    knows_start_ = true;
    return std::nullopt;
}

void StringEvents::add_misses_at_start() {
    for (std::size_t k = 0; k < link_count_; ++k) {
        const double margin = row(0)[k];
        if (is_taut_[k] == 0 && margin > before_[k] && margin > row(1)[k])
            misses_.push_back({k, time_s_[0], -margin});
    }
}

std::optional<StringEvents::Sample> StringEvents::first_top(const Motion& motion, std::size_t middle) {
    std::optional<Sample> first;
    const double* const before = row(middle - 1);
    const double* const at = row(middle);
    const double* const after = row(middle + 1);
    for (std::size_t k = 0; k < link_count_; ++k) {
        if (!(at[k] < 0.0 && after[k] < 0.0) || at[k] == -kNever) continue;
        const auto high = top(motion, k, {time_s_[middle - 1], before[k]}, {time_s_[middle], at[k]},
                              {time_s_[middle + 1], after[k]});
        if (high && (!first || high->time_s < first->time_s)) first = high;
    }
    return first;
}

std::optional<StringEvents::Sample> StringEvents::top(const Motion& motion, std::size_t link, Sample before,
                                                      Sample middle, Sample after) {
    // A link that has just left is not one that turns back.
    const double sides = std::max(before.margin, after.margin) + kTurns * rest_m_[link];
    const auto misses = [&] {
        if (is_taut_[link] == 0 && middle.margin > sides)
            misses_.push_back({link, middle.time_s, -middle.margin});
        return std::nullopt;
    };
    for (int point = 0; point < kTopPoints; ++point) {
        const double whole_s = after.time_s - before.time_s;
        const double rise = (middle.margin - before.margin) / (middle.time_s - before.time_s);
        const double bend =
            ((after.margin - middle.margin) / (after.time_s - middle.time_s) - rise) / whole_s;
        if (!(bend < 0.0)) return misses();
        double time_s = 0.5 * (before.time_s + middle.time_s) - 0.5 * rise / bend;
        if (!(time_s > before.time_s - kBeyond * whole_s && time_s < after.time_s + kBeyond * whole_s))
            return misses();
        const double apart_s = kApart * whole_s;
        if (time_s <= before.time_s) time_s = before.time_s + apart_s;
        if (time_s >= after.time_s) time_s = after.time_s - apart_s;
        const double expected =
            before.margin + (time_s - before.time_s) * (rise + bend * (time_s - middle.time_s));
        const double height = std::max(expected, middle.margin) - std::min(before.margin, after.margin);
        if (!(expected + kNearTop * height >= 0.0)) return misses();
        if (std::abs(time_s - middle.time_s) < apart_s) {
            const bool is_early = middle.time_s - before.time_s > after.time_s - middle.time_s;
            time_s = middle.time_s + (is_early ? -apart_s : apart_s);
        }
        const double largest = measure(motion, time_s, link_margin_.data());
        const Sample next{time_s, link_margin_[link]};
        if (next.margin >= 0.0) return Sample{time_s, largest};
        const bool is_early = next.time_s < middle.time_s;
        if (next.margin > middle.margin) {
            (is_early ? after : before) = middle;
            middle = next;
        } else {
            (is_early ? before : after) = next;
        }
    }
    return misses();
}

double StringEvents::root(const Motion& motion, Sample low, Sample high) {
    const double rounding_s = 4.0 * kEpsilon * high.time_s;
    bool was_high = false;
    for (int point = 1; point <= kRootPoints && high.time_s - low.time_s > rounding_s; ++point) {
        const double middle_s = low.time_s + 0.5 * (high.time_s - low.time_s);
        // The Illinois form of regula falsi. A point too near to an end is moved away from it, so that the
        // other end comes near as well.
        double time_s = (low.time_s * high.margin - high.time_s * low.margin) / (high.margin - low.margin);
        time_s = std::clamp(time_s, low.time_s + 0.5 * rounding_s, high.time_s - 0.5 * rounding_s);
        if (point % 4 == 0 || !(time_s > low.time_s && time_s < high.time_s)) time_s = middle_s;
        if (!(time_s > low.time_s && time_s < high.time_s)) break;
        const double margin = measure(motion, time_s, link_margin_.data());
        const bool is_high = margin >= 0.0;
        (is_high ? high : low) = {time_s, margin};
        if (point > 1 && is_high == was_high) (is_high ? low : high).margin *= 0.5;
        was_high = is_high;
    }
    return high.time_s;
}

}  // namespace corda::sim
