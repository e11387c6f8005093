#include "support/extended_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

namespace corda::test {
namespace {

using Real = ExtendedMotion::Real;

constexpr int kColumns = 7;
constexpr Real kShare = 3e-18L;  // error of a step relative to the size of the system
/// Weight of a step's velocity error relative to the largest speed. When light particles whip, steps are so
/// short that positions alone do not show the error.
constexpr Real kVelocityShare = 1e-3L;
/// Maximum number of steps for a scene, some minutes.
constexpr long kMaxSteps = 300000;

constexpr Real kTwoPi = 2 * std::numbers::pi_v<Real>;

Real angle_of(const WaveDef& wave, Real time) {
    return kTwoPi * (Real{wave.frequency_hz} * time + Real{wave.phase_deg} / 360);
}

using Pair = Eigen::Matrix<Real, 2, 1>;

Pair pair_of(Vec2 v) {
    return {v.x, v.y};
}

/// The second derivative of a pin's displacement.
Pair acceleration_of(const MoveDef& move, Real time) {
    Pair sum = Pair::Zero();
    for (const WaveDef& wave : move.waves) {
        const Real rate = kTwoPi * wave.frequency_hz;
        sum -= rate * rate * std::sin(angle_of(wave, time)) * pair_of(wave.amplitude);
    }
    for (std::size_t i = 1; i < move.path.size(); ++i) {
        const Real from = move.path[i - 1].time_s;
        const Real takes = move.path[i].time_s - from;
        const Real u = (time - from) / takes;
        if (u <= 0 || u >= 1) continue;
        // Of 10 u^3 - 15 u^4 + 6 u^5.
        sum += (60 * u - 180 * u * u + 120 * u * u * u) / (takes * takes) *
               (pair_of(move.path[i].by_m) - pair_of(move.path[i - 1].by_m));
    }
    return sum;
}

/// Upper bound of its length.
Real largest_acceleration_of(const MoveDef& move) {
    Real sum = 0;
    for (const WaveDef& wave : move.waves) {
        const Real rate = kTwoPi * wave.frequency_hz;
        sum += rate * rate * pair_of(wave.amplitude).norm();
    }
    for (std::size_t i = 1; i < move.path.size(); ++i) {
        const Real takes = move.path[i].time_s - move.path[i - 1].time_s;
        sum += 6 / (takes * takes) * (pair_of(move.path[i].by_m) - pair_of(move.path[i - 1].by_m)).norm();
    }
    return sum;
}

}  // namespace

ExtendedMotion::ExtendedMotion(const System& system, const WorldDef& world, const std::vector<Real>& start)
    : count_(static_cast<Eigen::Index>(system.particle_count())),
      world_(world),
      bends_(system.bends),
      moves_(system.moves),
      mass_kg_(system.mass_kg) {
    y_ = Vector::Zero(4 * count_);
    rest_ = y_;
    for (Eigen::Index i = 0; i < count_; ++i) {
        const auto k = static_cast<std::size_t>(i);
        y_[i] = start.empty() ? Real{system.x_m[k]} : start[k];
        y_[count_ + i] = start.empty() ? Real{system.y_m[k]} : start[k + system.particle_count()];
        y_[2 * count_ + i] = system.vx_m_s[k];
        y_[3 * count_ + i] = system.vy_m_s[k];
        inverse_mass_.push_back(system.is_pinned(k) ? Real{0} : Real{1} / Real{system.mass_kg[k]});
        release_s_.push_back(system.release_s.empty() ? HUGE_VAL : system.release_s[k]);
        if (!system.is_pinned(k)) mass_ += system.mass_kg[k];
    }
    strength_ = pair_of(world.gravity_m_s2).norm() +
                world.drag_1_s * (pair_of(world.wind_m_s).norm() + pair_of(world.gusts.amplitude).norm());
    for (const MoveDef& move : moves_) strength_ += largest_acceleration_of(move);
    size_ = largest_length_m(system);
    shortest_ = size_;
    for (const Body& body : system.bodies) add_links(system, body);
    changes_s_ = release_s_;
    for (const auto* const links : {&links_, &idle_})
        for (const Link& link : *links) changes_s_.push_back(link.cut_s);
    std::sort(changes_s_.begin(), changes_s_.end(), std::greater<>());
    changes_s_.erase(std::unique(changes_s_.begin(), changes_s_.end()), changes_s_.end());
    if (changes_s_.front() == HUGE_VAL) changes_s_.erase(changes_s_.begin());
    const bool changes_at_once = !changes_s_.empty() && changes_s_.back() == 0.0;
    if (changes_at_once) changes_s_.pop_back();
    if (changes_at_once ? !change() : !begin()) failure_ = "the start is not determined";
}

void ExtendedMotion::add_links(const System& system, const Body& body) {
    for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
        const Bar& bar = system.bars[k];
        const bool is_idle = system.is_pinned(bar.a) && system.is_pinned(bar.b);
        Link& link = (is_idle ? idle_ : links_)
                         .emplace_back(Link{bar.a, bar.b, bar.rest_m, body.material.compliance_1_n,
                                            body.material.is_string});
        if (!system.cut_s.empty()) link.cut_s = system.cut_s[k];
        link.pulls = !link.is_string;
        has_strings_ = has_strings_ || link.is_string;
        shortest_ = std::min(shortest_, link.rest);
    }
}

bool ExtendedMotion::fail(const char* reason) {
    failure_ = reason;
    return false;
}

bool ExtendedMotion::advance_to(double time_s) {
    while (!changes_s_.empty() && changes_s_.back() <= time_s) {
        if (!move_to(changes_s_.back())) return false;
        changes_s_.pop_back();
        if (!change()) return fail("what is let go or cut leaves no solution");
    }
    return move_to(time_s);
}

bool ExtendedMotion::change() {
    const auto now_s = static_cast<double>(time_);
    for (std::size_t i = 0; i < inverse_mass_.size(); ++i) {
        if (inverse_mass_[i] > 0 || release_s_[i] > now_s) continue;
        inverse_mass_[i] = Real{1} / Real{mass_kg_[i]};
        mass_ += mass_kg_[i];
    }
    const auto is_free = [&](const Link& link) { return inverse_mass_[link.a] + inverse_mass_[link.b] > 0; };
    std::copy_if(idle_.begin(), idle_.end(), std::back_inserter(links_), is_free);
    std::erase_if(idle_, is_free);
    std::erase_if(links_, [&](const Link& link) { return link.cut_s <= now_s; });
    std::erase_if(bends_, [&](const Bend& bend) { return bend.cut_s <= now_s; });
    std::erase_if(moves_, [&](const MoveDef& move) { return inverse_mass_[move.pin] > 0; });
    has_strings_ = std::any_of(links_.begin(), links_.end(), [](const Link& link) { return link.is_string; });
    constexpr Real kFirstStep = 1e-3L;
    step_ = std::min(step_, kFirstStep);
    return begin();
}

bool ExtendedMotion::move_to(double time_s) {
    if (!failure_.empty()) return false;
    while (time_ < time_s) {
        if (++steps_ > kMaxSteps) return fail("the truth takes too many steps");
        const Real left = time_s - time_;
        const Real step = std::min({step_, left, longest_step(), next_key() - time_});
        Vector change;
        const Real error = extrapolate(step, change);
        const Real grow = std::pow(kShare / std::max(error, Real{1e-30L}), Real{1} / (2 * kColumns - 1));
        if (!(error <= kShare)) {
            step_ = step * std::clamp(Real{0.9L} * grow, Real{0.1L}, Real{0.7L});
            if (!(step_ > Real{1e-15L} * std::max(time_, Real{1e-6L})))
                return fail("the truth's steps become too short");
            continue;
        }
        const Real wanted = step * std::clamp(Real{0.9L} * grow, Real{0.5L}, Real{2});
        if (const auto event = has_strings_ ? event_within(step) : std::nullopt) {
            static_cast<void>(extrapolate(*event, change));
            add(change);
            project();
            time_ += *event;
            if (++events_ > 20000) return fail("the truth meets too many events");
            if (!begin()) return fail("an event has no solution");
            continue;
        }
        add(change);
        if (has_strings_) project();
        time_ = step == left ? Real{time_s} : time_ + step;
        step_ = step < step_ ? std::max(step_, wanted) : wanted;
    }
    return true;
}

/// The next time at which a derivative of a pin's displacement jumps.
ExtendedMotion::Real ExtendedMotion::next_key() const {
    Real next = HUGE_VALL;
    for (const MoveDef& move : moves_)
        for (const PathKeyDef& key : move.path)
            if (key.time_s > time_) next = std::min(next, Real{key.time_s});
    return next;
}

ExtendedMotion::Real ExtendedMotion::length_error_m() const {
    Real largest_m = 0;
    for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(rigid_.size()); ++k)
        largest_m = std::max(largest_m, std::abs(apart(y_, bar(k), 0).norm() - std::sqrt(bar(k).square)));
    return largest_m;
}

ExtendedMotion::Pair ExtendedMotion::apart(const Vector& y, const Link& link, Eigen::Index first) const {
    const auto i = static_cast<Eigen::Index>(link.a);
    const auto j = static_cast<Eigen::Index>(link.b);
    return {y[first + j] - y[first + i], y[first + count_ + j] - y[first + count_ + i]};
}

/// Adds the effect of a force on a particle's acceleration, or of an impulse on its velocity.
void ExtendedMotion::push(Vector& slope, std::size_t i, const Pair& force) const {
    const auto k = static_cast<Eigen::Index>(i);
    slope[2 * count_ + k] += inverse_mass_[i] * force[0];
    slope[3 * count_ + k] += inverse_mass_[i] * force[1];
}

void ExtendedMotion::add_bends(const Vector& y, Vector& slope) const {
    for (const Bend& bend : bends_) {
        const Pair p = apart(y, {bend.a, bend.b, 0, 0, false}, 0);
        const Pair q = apart(y, {bend.b, bend.c, 0, 0, false}, 0);
        const Real pp = p.norm();
        const Real qq = q.norm();
        const Real cosine = p.dot(q) / (pp * qq);
        // -dE/dp and -dE/dq of E = -k cosine.
        const Pair fp = bend.stiffness_n_m * (q / (pp * qq) - cosine / (pp * pp) * p);
        const Pair fq = bend.stiffness_n_m * (p / (pp * qq) - cosine / (qq * qq) * q);
        push(slope, bend.a, -fp);
        push(slope, bend.b, fp - fq);
        push(slope, bend.c, fq);
    }
}

/// Coupling of two rigid bars through a common particle.
Real ExtendedMotion::coupling(const Vector& y, const Link& link, const Link& other) const {
    const Real weight =
        (link.a == other.a ? inverse_mass_[link.a] : 0) + (link.b == other.b ? inverse_mass_[link.b] : 0) -
        (link.a == other.b ? inverse_mass_[link.a] : 0) - (link.b == other.a ? inverse_mass_[link.b] : 0);
    return weight == 0 ? 0 : weight * apart(y, link, 0).dot(apart(y, other, 0));
}

/// The multipliers of the rigid bars that pull: solves L D L^T in the profile of the matrix.
ExtendedMotion::Vector ExtendedMotion::solve(const Vector& y, Vector right) {
    const Eigen::Index n = right.size();
    for (Eigen::Index k = 0; k < n; ++k) {
        const auto row = static_cast<std::size_t>(k);
        for (Eigen::Index l = first_[row]; l <= k; ++l) {
            Real sum = coupling(y, bar(k), bar(l));
            for (Eigen::Index m = std::max(first_[row], first_[static_cast<std::size_t>(l)]); m < l; ++m)
                sum -= matrix_(k, m) * matrix_(l, m) * matrix_(m, m);
            matrix_(k, l) = l < k ? sum / matrix_(l, l) : sum;
        }
        for (Eigen::Index m = first_[row]; m < k; ++m) right[k] -= matrix_(k, m) * right[m];
    }
    for (Eigen::Index k = 0; k < n; ++k) right[k] /= matrix_(k, k);
    for (Eigen::Index k = n; k-- > 0;) {
        for (Eigen::Index m = first_[static_cast<std::size_t>(k)]; m < k; ++m)
            right[m] -= matrix_(k, m) * right[k];
    }
    return right;
}

/// Forces or impulses of the rigid bars at `y`: each bar's multiplier times the vector from `a` to `b`, on
/// `b`.
void ExtendedMotion::push_along_bars(Vector& slope, const Vector& y, const Vector& multiplier) const {
    for (Eigen::Index k = 0; k < multiplier.size(); ++k) {
        const Pair force = multiplier[k] * apart(y, bar(k), 0);
        push(slope, bar(k).a, -force);
        push(slope, bar(k).b, force);
    }
}

/// Of a free particle at rest, by gravity and wind.
ExtendedMotion::Pair ExtendedMotion::uniform_acceleration(Real time) const {
    const Pair gust = std::sin(angle_of(world_.gusts, time)) * pair_of(world_.gusts.amplitude);
    return pair_of(world_.gravity_m_s2) + world_.drag_1_s * (pair_of(world_.wind_m_s) + gust);
}

void ExtendedMotion::derivative(const Vector& y, Real time, Vector& slope) {
    slope.head(2 * count_) = y.tail(2 * count_);
    const Pair uniform = uniform_acceleration(time);
    for (Eigen::Index i = 0; i < count_; ++i) {
        const Real falls = inverse_mass_[static_cast<std::size_t>(i)] > 0 ? 1 : 0;
        slope[2 * count_ + i] = falls * (uniform[0] - world_.drag_1_s * y[2 * count_ + i]);
        slope[3 * count_ + i] = falls * (uniform[1] - world_.drag_1_s * y[3 * count_ + i]);
    }
    for (const MoveDef& move : moves_) {
        const Pair acceleration = acceleration_of(move, time);
        slope[2 * count_ + move.pin] = acceleration[0];
        slope[3 * count_ + move.pin] = acceleration[1];
    }
    for (const Link& link : links_) {
        if (link.compliance == 0 || !link.pulls) continue;
        const Pair d = apart(y, link, 0);
        const Real now = d.norm();
        const Pair pull = (now / link.rest - 1) / link.compliance / now * d;
        push(slope, link.a, pull);
        push(slope, link.b, -pull);
    }
    add_bends(y, slope);
    multiplier_.resize(static_cast<Eigen::Index>(rigid_.size()));
    if (rigid_.empty()) return;
    for (Eigen::Index k = 0; k < multiplier_.size(); ++k) {
        multiplier_[k] = -apart(y, bar(k), 2 * count_).squaredNorm() -
                         apart(y, bar(k), 0).dot(apart(slope, bar(k), 2 * count_));
    }
    multiplier_ = solve(y, multiplier_);
    push_along_bars(slope, y, multiplier_);
}

/// One step; returns an estimate of the largest position error, relative to the size of the system or to its
/// distance from the origin. Stops early if few columns suffice, as in the short steps that strings need. The
/// change is extrapolated, not the state, because extrapolation magnifies rounding by several tens.
Real ExtendedMotion::extrapolate(Real step, Vector& change) {
    std::array<Vector, kColumns> row;
    Vector slope(4 * count_);
    Vector start_slope(4 * count_);
    derivative(y_, time_, start_slope);
    const Real size = std::max(size_, y_.head(2 * count_).cwiseAbs().maxCoeff());
    const Real speed = std::max({y_.tail(2 * count_).cwiseAbs().maxCoeff(),
                                 step * start_slope.tail(2 * count_).cwiseAbs().maxCoeff(), Real{1e-30L}});
    Real error = 1;
    for (int j = 0; j < kColumns && !(error <= Real{1e-3L} * kShare); ++j) {
        const int parts = 2 * (j + 1);
        const Real h = step / parts;
        Vector before = rest_;
        Vector now = rest_ + h * start_slope;
        for (int m = 1; m < parts; ++m) {
            derivative(y_ + now, time_ + m * h, slope);
            before += 2 * h * slope;
            before.swap(now);
        }
        derivative(y_ + now, time_ + step, slope);
        change = (before + now + h * slope) / 2;
        for (int l = 0; l < j; ++l) {
            const Real ratio = Real(parts) / Real(2 * (j - l));
            const Vector finer = change + (change - row[static_cast<std::size_t>(l)]) / (ratio * ratio - 1);
            row[static_cast<std::size_t>(l)] = change;
            change = finer;
        }
        if (j > 0) {
            const Vector differ = (change - row[static_cast<std::size_t>(j - 1)]).cwiseAbs();
            error = std::max(differ.head(2 * count_).maxCoeff() / size,
                             kVelocityShare * differ.tail(2 * count_).maxCoeff() / speed);
            if (!std::isfinite(error)) error = 1;
        }
        row[static_cast<std::size_t>(j)] = change;
    }
    return error;
}

/// Adds a change to the state, with compensation of the rounding error.
void ExtendedMotion::add(const Vector& change) {
    const Vector before = y_;
    y_ += change;
    rest_ = change - (y_ - before);
}

/// Restores the lengths of the rigid bars that pull, which drift by errors. Without strings this is not done
/// after each step, because rounding of the lengths shakes light particles that hang in line above a heavy
/// one.
void ExtendedMotion::project() {
    Vector multiplier(static_cast<Eigen::Index>(rigid_.size()));
    for (Eigen::Index k = 0; k < multiplier.size(); ++k)
        multiplier[k] = (bar(k).square - apart(y_, bar(k), 0).squaredNorm()) / 2;
    Vector moved = Vector::Zero(4 * count_);
    push_along_bars(moved, y_, solve(y_, multiplier));
    y_.head(2 * count_) += moved.tail(2 * count_);
    remove_stretching(y_, multiplier);
}

/// Removes the speeds at which pulling rigid bars would stretch from the velocities.
void ExtendedMotion::remove_stretching(Vector& y, Vector& multiplier) {
    multiplier.resize(static_cast<Eigen::Index>(rigid_.size()));
    for (Eigen::Index k = 0; k < multiplier.size(); ++k)
        multiplier[k] = -apart(y, bar(k), 0).dot(apart(y, bar(k), 2 * count_));
    multiplier = solve(y, multiplier);
    push_along_bars(y, y, multiplier);
}

}  // namespace corda::test
