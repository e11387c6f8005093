#include "corda/sim/exact/string/contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "corda/sim/defs.hpp"

namespace corda::sim {
namespace {

using Side = TensionLcp::Side;

/// Events closer than this, in parts of the string's time scale, count as simultaneous. Rounding moves the
/// events of a symmetric scene by less.
constexpr double kSimultaneous = 1e-13;

/// Upper bound of the acceleration at which a link turns back, in parts of the string's own.
constexpr double kTurnsBack = 10.0;

/// Rounding of a distance, in units in the last place of the farthest coordinate.
constexpr double kUlps = 8.0;

/// Speeds and accelerations below this share of the string's own are rounding, as are impulses and tensions
/// that change those of a link's particles by less.
constexpr double kRounding = 1e-12;

/// Rounding of a tension comes from all masses that hang on it: at least this share of the string's mass
/// counts.
constexpr double kMinShareOfMass = 1e-3;

/// A link that shortens by less than this share of its length before it returns counts as taut throughout. It
/// is a share of the tolerance, because a link that does not return continues from there, and a tighter run
/// must show it. The limits are far above the rounding of lengths, where bounces might never end, and below
/// any visible error.
constexpr double kNoBouncePerTolerance = 1e-2;
constexpr double kMinNoBounce = 1e-13;
constexpr double kMaxNoBounce = 1e-10;

/// Tensions accelerate a link by at most this multiple of the acceleration that they balance.
constexpr double kMaxAcceleration = 100.0;

Vec2 between(const std::vector<double>& x, const std::vector<double>& y, std::size_t link) {
    return {x[link + 1] - x[link], y[link + 1] - y[link]};
}

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

}  // namespace

StringContacts::StringContacts(const System& string, const Forces& forces, double tolerance)
    : forces_(forces),
      no_bounce_(std::clamp(kNoBouncePerTolerance * tolerance, kMinNoBounce, kMaxNoBounce)),
      left_s_(string.bars.size(), -std::numeric_limits<double>::infinity()),
      direction_(string.bars.size()),
      inward_m_s_(string.bars.size()),
      lcp_(string.inverse_mass_1_kg) {
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < string.particle_count(); ++i) {
        if (!string.is_pinned(i)) mass_kg += string.mass_kg[i];
    }
    for (std::size_t k = 0; k < string.bars.size(); ++k) {
        rest_m_.push_back(string.bars[k].rest_m);
        length_m_ += rest_m_.back();
        const double inverse_1_kg = string.inverse_mass_1_kg[k] + string.inverse_mass_1_kg[k + 1];
        largest_mass_kg_.push_back(
            std::max(inverse_1_kg > 0.0 ? 1.0 / inverse_1_kg : 0.0, kMinShareOfMass * mass_kg));
    }
}

bool StringContacts::resolve(System& string, std::vector<std::uint8_t>& is_taut, double time_s) {
    const std::size_t links = rest_m_.size();
    forces_.set_time(time_s);
    measure(string);
    find_margin(string, is_taut, time_s);
    find_present(string, is_taut);
    for (std::size_t k = 0; k < links; ++k) lcp_.z_error[k] = speed_error_m_s_ * largest_mass_kg_[k];
    if (!lcp_.solve(speed_error_m_s_)) return false;
    snap(string);
    for (std::size_t k = 0; k < links; ++k) {
        const bool goes_in = lcp_.side[k] == Side::kFree && lcp_.w()[k] > speed_error_m_s_;
        inward_m_s_[k] = goes_in ? lcp_.w()[k] : 0.0;
    }
    if (!find_tensions(string)) return false;
    for (std::size_t k = 0; k < links; ++k) is_taut[k] = lcp_.side[k] == Side::kPulls ? 1 : 0;
    // A link that pulls from now on could not have turned back.
    if (excess_m_ < margin_m_ && is_taut[first_] == 0) margin_m_ = excess_m_;
    return true;
}

void StringContacts::measure(const System& string) {
    for (std::size_t k = 0; k < rest_m_.size(); ++k) rest_m_[k] = string.bars[k].rest_m;
    double fastest_m_s = 0.0;
    double farthest_m = 0.0;
    for (std::size_t i = 0; i < string.particle_count(); ++i) {
        fastest_m_s = std::max(fastest_m_s, length(string.vx_m_s[i], string.vy_m_s[i]));
        farthest_m = std::max({farthest_m, std::abs(string.x_m[i]), std::abs(string.y_m[i])});
    }
    inverse_timescale_1_s_ = forces_.inverse_timescale_1_s(length_m_, fastest_m_s);
    if (inverse_timescale_1_s_ == 0.0) inverse_timescale_1_s_ = 1.0;
    speed_error_m_s_ = kRounding * length_m_ * inverse_timescale_1_s_;
    place_error_m_ = kUlps * std::numeric_limits<double>::epsilon() * farthest_m;
}

bool StringContacts::find_tensions(const System& string) {
    const std::size_t links = rest_m_.size();
    find_accelerations(string);
    double largest_m_s2 = length_m_ * inverse_timescale_1_s_ * inverse_timescale_1_s_;
    for (std::size_t k = 0; k < links; ++k) {
        if (lcp_.side[k] != Side::kAbsent) largest_m_s2 = std::max(largest_m_s2, std::abs(lcp_.right[k]));
    }
    acceleration_error_m_s2_ = kRounding * largest_m_s2;
    const auto leaves = [&](std::size_t k, double back_m_s2) {
        return inward_m_s_[k] * inward_m_s_[k] > 2.0 * no_bounce_ * rest_m_[k] * back_m_s2;
    };
    for (std::size_t k = 0; k < links; ++k) {
        lcp_.z_error[k] = tension_error_n(k);
        if (leaves(k, kMaxAcceleration * largest_m_s2)) lcp_.side[k] = Side::kAbsent;
    }
    for (;;) {
        if (!lcp_.solve(acceleration_error_m_s2_)) return false;
        bool is_done = true;
        for (std::size_t k = 0; k < links; ++k) {
            // The acceleration that would bring the link back if it alone did not pull.
            const double inverse_1_kg = string.inverse_mass_1_kg[k] + string.inverse_mass_1_kg[k + 1];
            if (lcp_.side[k] != Side::kPulls || !leaves(k, inverse_1_kg * lcp_.z()[k])) continue;
            lcp_.side[k] = Side::kAbsent;
            is_done = false;
        }
        if (is_done) return true;
    }
}

void StringContacts::find_margin(const System& string, const std::vector<std::uint8_t>& is_taut,
                                 double time_s) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    margin_m_ = excess_m_ = kNever;
    first_ = rest_m_.size();
    const auto missing_m = [&](std::size_t k) {
        const Vec2 along = between(string.x_m, string.y_m, k);
        return rest_m_[k] - length(along.x, along.y);
    };
    for (std::size_t k = 0; k < rest_m_.size(); ++k) {
        if (is_taut[k] != 0 || (string.is_pinned(k) && string.is_pinned(k + 1))) continue;
        const bool is_there = missing_m(k) <= length_error_m(k);
        if (is_there && (first_ == rest_m_.size() || missing_m(k) < missing_m(first_))) first_ = k;
    }
    for (std::size_t k = 0; first_ < rest_m_.size() && k < rest_m_.size(); ++k) {
        if (is_taut[k] != 0 || (string.is_pinned(k) && string.is_pinned(k + 1))) continue;
        if (k != first_) {
            margin_m_ = std::min(margin_m_, missing_m(k) / error_share(k, time_s));
            continue;
        }
        const Vec2 along = between(string.x_m, string.y_m, k);
        const double speed_m_s =
            dot(between(string.vx_m_s, string.vy_m_s, k), along) / length(along.x, along.y);
        const double turns_m_s2 = kTurnsBack * length_m_ * inverse_timescale_1_s_ * inverse_timescale_1_s_;
        excess_m_ = 0.5 * speed_m_s * speed_m_s / turns_m_s2 / error_share(k, time_s);
    }
    for (std::size_t k = 0; k < rest_m_.size(); ++k) {
        if (is_taut[k] != 0 || missing_m(k) <= length_error_m(k)) left_s_[k] = time_s;
    }
}

double StringContacts::error_share(std::size_t link, double time_s) const {
    return std::min(1.0, (time_s - left_s_[link]) * inverse_timescale_1_s_);
}

void StringContacts::find_present(const System& string, const std::vector<std::uint8_t>& is_taut) {
    const std::size_t links = rest_m_.size();
    for (std::size_t k = 0; k < links; ++k) {
        lcp_.side[k] = Side::kAbsent;
        if (string.is_pinned(k) && string.is_pinned(k + 1)) continue;
        const Vec2 along = between(string.x_m, string.y_m, k);
        const double distance_m = length(along.x, along.y);
        if (distance_m < 0.5 * rest_m_[k]) continue;
        direction_[k] = (1.0 / distance_m) * along;
        const double speed_m_s = dot(between(string.vx_m_s, string.vy_m_s, k), direction_[k]);
        const double soon_m = std::max(speed_m_s, 0.0) * kSimultaneous / inverse_timescale_1_s_;
        if (is_taut[k] == 0 && distance_m + soon_m + length_error_m(k) < rest_m_[k]) continue;
        lcp_.side[k] = is_taut[k] != 0 || speed_m_s > 0.0 ? Side::kPulls : Side::kFree;
        lcp_.right[k] = speed_m_s;
    }
    for (std::size_t k = 0; k + 1 < links; ++k) {
        if (lcp_.side[k] == Side::kAbsent || lcp_.side[k + 1] == Side::kAbsent) continue;
        lcp_.cosine[k] = dot(direction_[k], direction_[k + 1]);
        lcp_.sine[k] = cross(direction_[k], direction_[k + 1]);
    }
}

void StringContacts::snap(System& string) const {
    const auto kick = [&](std::size_t particle, Vec2 impulse_n_s) {
        string.vx_m_s[particle] += string.inverse_mass_1_kg[particle] * impulse_n_s.x;
        string.vy_m_s[particle] += string.inverse_mass_1_kg[particle] * impulse_n_s.y;
    };
    for (std::size_t k = 0; k < rest_m_.size(); ++k) {
        if (lcp_.side[k] != Side::kPulls) continue;
        const Vec2 impulse_n_s = lcp_.z()[k] * direction_[k];
        kick(k, impulse_n_s);
        kick(k + 1, -1.0 * impulse_n_s);
    }
}

void StringContacts::find_accelerations(const System& string) {
    const auto own_m_s2 = [&](std::size_t particle) {
        return string.is_pinned(particle) ? Vec2{} : forces_.uniform_m_s2();
    };
    for (std::size_t k = 0; k < rest_m_.size(); ++k) {
        if (lcp_.side[k] == Side::kAbsent) continue;
        const double across_m_s = cross(direction_[k], between(string.vx_m_s, string.vy_m_s, k));
        lcp_.right[k] =
            across_m_s * across_m_s / rest_m_[k] + dot(own_m_s2(k + 1) - own_m_s2(k), direction_[k]);
    }
}

}  // namespace corda::sim
