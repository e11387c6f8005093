// The strings of ExtendedMotion.

#include <algorithm>
#include <cmath>

#include "support/extended_motion.hpp"

namespace corda::test {
namespace {

using Real = ExtendedMotion::Real;

/// Links this close to their rest length at the start, relative to it, count as taut, because scenes are
/// rounded.
constexpr Real kThere = 1e-14L;
/// A link that returns before it has shortened by this share of its length continues to pull.
constexpr Real kNoBounce = 1e-16L;
/// Tolerance of speeds, lengths and tensions, relative to those of the system.
constexpr Real kRounding = 1e-17L;
/// A tension this far below 0, relative to the system's, ends a link's pull: far more than its rounding
/// error, and too little to matter, because all derivatives below the third are 0 when a link goes slack.
constexpr Real kSlackens = 1e-14L;

}  // namespace

void ExtendedMotion::use_links_that_pull() {
    rigid_.clear();
    first_.clear();
    for (std::size_t k = 0; k < links_.size(); ++k) {
        if (links_[k].compliance > 0 || !links_[k].pulls) continue;
        const auto touches = [&](std::size_t other) {
            const Link& p = links_[k];
            const Link& q = links_[other];
            return p.a == q.a || p.a == q.b || p.b == q.a || p.b == q.b;
        };
        const auto first = std::find_if(rigid_.begin(), rigid_.end(), touches);
        first_.push_back(first - rigid_.begin());
        rigid_.push_back(k);
    }
    const auto n = static_cast<Eigen::Index>(rigid_.size());
    matrix_.resize(n, n);
}

/// Restarts at a state: removes velocities that would stretch rigid bars, and finds the links of strings that
/// pull from now on. False if there is no solution.
bool ExtendedMotion::begin() {
    std::vector<bool> present(links_.size());
    for (std::size_t k = 0; k < links_.size(); ++k) {
        Link& link = links_[k];
        if (!link.is_string) continue;
        const Real distance = apart(y_, link, 0).norm();
        const bool is_there = distance >= link.rest * (1 - (time_ == 0 ? kThere : kRounding));
        const Real parts = apart(y_, link, 0).dot(apart(y_, link, 2 * count_));
        if (link.compliance > 0) {
            const bool is_near = std::abs(distance / link.rest - 1) < kThere;
            link.pulls = is_near ? parts > 0 : is_there;
        } else {
            present[k] = link.pulls || is_there;
            link.pulls = link.pulls || (is_there && parts > 0);
        }
    }
    const Eigen::Index n = static_cast<Eigen::Index>(links_.size());
    const Real speed = y_.tail(2 * count_).cwiseAbs().maxCoeff();
    Vector after = y_;
    Answer found{Vector::Zero(n), Vector::Zero(n)};
    const Answer speed_error{Vector::Constant(n, kRounding * mass_ * speed),
                             Vector::Constant(n, kRounding * speed)};
    if (!complement(present, speed_error, [&] { return found = snapped(after); })) return false;
    y_ = after;
    const Real pull = strength_ + speed * speed / shortest_;
    first_step_ = HUGE_VALL;
    begun_ = time_;
    for (std::size_t k = 0; k < links_.size(); ++k) {
        const Real inward = -found.away[static_cast<Eigen::Index>(k)];
        if (!(inward > 0 && inward * inward > 2 * kNoBounce * links_[k].rest * pull)) continue;
        if (present[k]) first_step_ = std::min(first_step_, inward / (4 * pull));
        present[k] = false;
    }
    const Answer error{Vector::Constant(n, kRounding * mass_ * pull), Vector::Constant(n, kRounding * pull)};
    if (!complement(present, error, [&] { return accelerated(); })) return false;
    // For links that would return at once: pushing now and pulling for that long equals the snap.
    Vector impulses;
    remove_stretching(y_, impulses);
    for (Link& link : links_) {
        if (!link.pulls) link.square = 0;
        if (link.pulls && link.square == 0) link.square = apart(y_, link, 0).squaredNorm();
    }
    if (!has_strings_) return true;
    const Vector margin = raw_margins(y_, time_);
    for (std::size_t k = 0; k < links_.size(); ++k) {
        Link& link = links_[k];
        const bool is_taut = link.compliance == 0 && link.pulls;
        const Real rounding = is_taut ? kSlackens * mass_ * pull : kRounding * size_;
        link.least = std::max(margin[static_cast<Eigen::Index>(k)], Real{0}) + rounding;
    }
    return true;
}

/// Finds which of the taut rigid links of strings pull: those that must do so to keep their ends from
/// parting. Murty's rule: the last link with a wrong sign changes sides.
bool ExtendedMotion::complement(const std::vector<bool>& present, const Answer& error,
                                const std::function<Answer()>& answer) {
    for (std::size_t k = 0; k < links_.size(); ++k) {
        if (links_[k].is_string && links_[k].compliance == 0) links_[k].pulls = links_[k].pulls && present[k];
    }
    for (int round = 0; round < 10000; ++round) {
        use_links_that_pull();
        const Answer found = answer();
        if (!found.pull.allFinite() || !found.away.allFinite()) return false;
        std::size_t wrong = links_.size();
        for (std::size_t k = 0; k < links_.size(); ++k) {
            const auto i = static_cast<Eigen::Index>(k);
            if (!present[k]) continue;
            const bool is_wrong =
                links_[k].pulls ? found.pull[i] < -error.pull[i] : found.away[i] > error.away[i];
            if (is_wrong) wrong = k;
        }
        if (wrong == links_.size()) return true;
        links_[wrong].pulls = !links_[wrong].pulls;
    }
    return false;
}

/// The impulses of a snap of the links that pull, and the state after it.
ExtendedMotion::Answer ExtendedMotion::snapped(Vector& after) {
    Vector multiplier;
    after = y_;
    remove_stretching(after, multiplier);
    const auto n = static_cast<Eigen::Index>(links_.size());
    Answer answer{Vector::Zero(n), Vector::Zero(n)};
    for (Eigen::Index k = 0; k < multiplier.size(); ++k)
        answer.pull[static_cast<Eigen::Index>(rigid_[static_cast<std::size_t>(k)])] =
            -multiplier[k] * apart(y_, bar(k), 0).norm();
    for (Eigen::Index k = 0; k < n; ++k) {
        const Link& link = links_[static_cast<std::size_t>(k)];
        if (link.pulls) continue;
        answer.away[k] = apart(after, link, 0).normalized().dot(apart(after, link, 2 * count_));
    }
    return answer;
}

/// The tensions of the links that pull, and the accelerations with which the ends of the other links part if
/// they are not moving yet.
ExtendedMotion::Answer ExtendedMotion::accelerated() {
    Vector slope(4 * count_);
    derivative(y_, time_, slope);
    const auto n = static_cast<Eigen::Index>(links_.size());
    Answer answer{Vector::Zero(n), Vector::Zero(n)};
    for (Eigen::Index k = 0; k < multiplier_.size(); ++k)
        answer.pull[static_cast<Eigen::Index>(rigid_[static_cast<std::size_t>(k)])] =
            -multiplier_[k] * apart(y_, bar(k), 0).norm();
    for (Eigen::Index k = 0; k < n; ++k) {
        const Link& link = links_[static_cast<std::size_t>(k)];
        if (link.pulls) continue;
        const Pair d = apart(y_, link, 0);
        answer.away[k] =
            (apart(y_, link, 2 * count_).squaredNorm() + d.dot(apart(slope, link, 2 * count_))) / d.norm();
    }
    return answer;
}

/// Per link of a string, a margin that is negative until its event: minus the tension of a pulling rigid
/// link, otherwise its distance in length from the event. -1 for other links.
ExtendedMotion::Vector ExtendedMotion::raw_margins(const Vector& y, Real time) {
    const auto n = static_cast<Eigen::Index>(links_.size());
    Vector margin = Vector::Constant(n, Real{-1});
    for (Eigen::Index k = 0; k < n; ++k) {
        const Link& link = links_[static_cast<std::size_t>(k)];
        if (!link.is_string) continue;
        const Real longer = apart(y, link, 0).norm() - link.rest;
        margin[k] = link.pulls ? -longer : longer;
    }
    Vector slope(4 * count_);
    derivative(y, time, slope);
    for (Eigen::Index k = 0; k < multiplier_.size(); ++k) {
        if (bar(k).is_string)
            margin[static_cast<Eigen::Index>(rigid_[static_cast<std::size_t>(k)])] =
                multiplier_[k] * apart(y, bar(k), 0).norm();
    }
    return margin;
}

ExtendedMotion::Vector ExtendedMotion::margins(Real step) {
    Vector change = rest_;
    if (step > 0) static_cast<void>(extrapolate(step, change));
    Vector margin = raw_margins(y_ + change, time_ + step);
    for (std::size_t k = 0; k < links_.size(); ++k) margin[static_cast<Eigen::Index>(k)] -= links_[k].least;
    return margin;
}

/// The time between two times at which a link's margin is largest, or a time at which it is not negative.
Real ExtendedMotion::highest(Eigen::Index link, Real low, Real high) {
    for (int round = 0; round < 60; ++round) {
        const Real third = (high - low) / 3;
        const Real early = margins(low + third)[link];
        const Real later = margins(high - third)[link];
        if (early >= 0) return low + third;
        if (later >= 0) return high - third;
        (early < later ? low : high) += early < later ? third : -third;
    }
    return low;
}

/// The time from the step's start to the first event in it.
std::optional<Real> ExtendedMotion::event_within(Real step) {
    const Vector start = margins(0);
    const Vector half = margins(step / 2);
    const Vector end = margins(step);
    std::optional<Real> late;
    if (end.maxCoeff() >= 0) late = step;
    if (half.maxCoeff() >= 0) late = step / 2;
    for (Eigen::Index k = 0; k < start.size(); ++k) {
        // The parabola through the three margins; a maximum near 0 is examined.
        const Real slope = (4 * half[k] - 3 * start[k] - end[k]) / step;
        const Real curve = 2 * (start[k] - 2 * half[k] + end[k]) / (step * step);
        const Real top = -slope / (2 * curve);
        // The parabola's top may be beyond an end that is near the true one.
        if (!(curve < 0 && top > -step / 8 && top < late.value_or(step) + step / 8)) continue;
        const Real height = start[k] + slope * top / 2;
        const Real range = std::max({start[k], half[k], end[k]}) - std::min({start[k], half[k], end[k]});
        if (!(height > -range / 2)) continue;
        const Real high =
            highest(k, std::max(Real{0}, top - step / 4), std::min(late.value_or(step), top + step / 4));
        if (margins(high).maxCoeff() >= 0) late = high;
    }
    if (!late) return std::nullopt;
    return event_before(0, *late);
}

/// The time at which the largest margin reaches 0, by the Illinois method, on the side where it is not
/// negative.
Real ExtendedMotion::event_before(Real low, Real high) {
    Real below = margins(low).maxCoeff();
    Real above = margins(high).maxCoeff();
    for (int round = 0; round < 200 && high - low > Real{1e-18L} * (time_ + high); ++round) {
        // Every third time the middle, so that no side stays unchanged for long.
        const Real share = round % 3 == 2 ? Real{0.5L} : -below / (above - below);
        const Real time = low + (high - low) * std::clamp(share, Real{1e-3L}, Real{0.999L});
        if (time <= low || time >= high) break;
        const Real margin = margins(time).maxCoeff();
        (margin < 0 ? low : high) = time;
        (margin < 0 ? below : above) = margin;
    }
    return high;
}

/// The length of a step, so short that margins have one maximum in it: after an event shorter than any link
/// needs to return, then doubled.
Real ExtendedMotion::longest_step() {
    if (!has_strings_) return HUGE_VALL;
    Vector slope(4 * count_);
    derivative(y_, time_, slope);
    const Real speed = slope.head(2 * count_).cwiseAbs().maxCoeff();
    const Real acceleration = slope.tail(2 * count_).cwiseAbs().maxCoeff();
    constexpr Real kPart = 0.15L;
    const Real step = kPart * shortest_ / (speed + std::sqrt(acceleration * shortest_) + Real{1e-30L});
    return std::min(step, first_step_ + (time_ - begun_));
}

}  // namespace corda::test
