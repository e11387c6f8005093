#include "corda/sim/rattle/constraint_solver.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/rattle/chain_constraints.hpp"
#include "corda/sim/rattle/graph_constraints.hpp"

namespace corda::sim {

Motion Motion::start_of(const System& system) {
    const std::vector<double> none(system.particle_count(), 0.0);
    return {system.x_m, system.y_m, system.vx_m_s, system.vy_m_s, none, none, none, none};
}

RigidBars::RigidBars(const System& system, std::vector<double> inverse_masses)
    : inverse_mass_1_kg(std::move(inverse_masses)) {
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (inverse_mass_1_kg[i] == 0.0) held.push_back(static_cast<std::uint32_t>(i));
    }
    for (const Bar& bar : rigid_bars(system)) {
        if (inverse_mass_1_kg[bar.a] > 0.0 || inverse_mass_1_kg[bar.b] > 0.0)
            links.push_back({bar.a, bar.b, bar.rest_m});
    }
}

std::vector<std::size_t> bars_of_links(const System& system, const RigidBars& bars) {
    std::vector<std::size_t> bar_of_link;
    for (const Body& body : system.bodies) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
            const Bar& bar = system.bars[k];
            const bool moves = bars.inverse_mass_1_kg[bar.a] > 0.0 || bars.inverse_mass_1_kg[bar.b] > 0.0;
            if (body.material.compliance_1_n == 0.0 && moves) bar_of_link.push_back(k);
        }
    }
    assert(bar_of_link.size() == bars.links.size());
    return bar_of_link;
}

double ConstraintSolver::expected_square_frequency(const System& system, double acceleration_m_s2,
                                                   std::span<const double> multiplier) const {
    std::vector<double> expected = carried_mass(system.mass_kg);
    for (std::size_t k = 0; k < expected.size(); ++k) {
        expected[k] =
            std::max(acceleration_m_s2 * expected[k] / links()[k].rest_m, 2.0 * std::abs(multiplier[k]));
    }
    return square_frequency(expected);
}

std::vector<double> loads(const RigidBars& bars, const Motion& motion, Vec2 uniform_m_s2) {
    // d . (acceleration of b - acceleration of a) + |velocity of b - velocity of a|^2 = 0.
    std::vector<double> load;
    load.reserve(bars.links.size());
    const auto falls = [&](std::uint32_t i) { return bars.inverse_mass_1_kg[i] == 0.0 ? 0.0 : 1.0; };
    for (const Link& link : bars.links) {
        const Vec2 u = apart(link, motion);
        load.push_back(dot(u, u) + (falls(link.b) - falls(link.a)) * dot(along(link, motion), uniform_m_s2));
    }
    return load;
}

namespace {

CORDA_AVX2_CLONES void kick_all(const RigidBars& bars, const Stage& stage, Motion& motion) {
    double* __restrict const vx = motion.vx_m_s.data();
    double* __restrict const vy = motion.vy_m_s.data();
    double* __restrict const lost_x = motion.vx_lost_m_s.data();
    double* __restrict const lost_y = motion.vy_lost_m_s.data();
    const double slowdown = stage.decay - 1.0;
    for (std::size_t i = 0; i < motion.vx_m_s.size(); ++i) {
        add_unrounded(vx[i], lost_x[i], slowdown * vx[i] + stage.push_m_s.x);
        add_unrounded(vy[i], lost_y[i], slowdown * vy[i] + stage.push_m_s.y);
    }
    for (const std::uint32_t i : bars.held) vx[i] = vy[i] = lost_x[i] = lost_y[i] = 0.0;
    for (std::size_t k = 0; k < stage.held_m_s.size(); ++k) {
        vx[bars.held[k]] = stage.held_m_s[k].x;
        vy[bars.held[k]] = stage.held_m_s[k].y;
    }
}

CORDA_AVX2_CLONES void drift_all(double span_s, Motion& motion) {
    double* __restrict const x = motion.x_m.data();
    double* __restrict const y = motion.y_m.data();
    double* __restrict const lost_x = motion.x_lost_m.data();
    double* __restrict const lost_y = motion.y_lost_m.data();
    const double* __restrict const vx = motion.vx_m_s.data();
    const double* __restrict const vy = motion.vy_m_s.data();
    const double* __restrict const lost_vx = motion.vx_lost_m_s.data();
    const double* __restrict const lost_vy = motion.vy_lost_m_s.data();
    for (std::size_t i = 0; i < motion.x_m.size(); ++i) {
        add_unrounded(x[i], lost_x[i], span_s * vx[i] + span_s * lost_vx[i]);
        add_unrounded(y[i], lost_y[i], span_s * vy[i] + span_s * lost_vy[i]);
    }
}

}  // namespace

void kick(const RigidBars& bars, const Stage& stage, Motion& motion) {
    kick_all(bars, stage, motion);
}

void drift(double span_s, Motion& motion) {
    drift_all(span_s, motion);
}

std::unique_ptr<ConstraintSolver> make_constraint_solver(const System& system) {
    if (ChainConstraints::suits(rigid_bars(system))) return std::make_unique<ChainConstraints>(system);
    return std::make_unique<GraphConstraints>(system);
}

namespace {

/// A row is straight if its bars are longer than the distance of its ends by no more than this share of it,
/// which is rounding: sagging by a part in 1e7 would take twice as much.
constexpr double kSlack = 1e-14;
/// Rounding, as a share of the largest coordinate and, for checks with a moved start, of all lengths
/// together.
constexpr double kRowRounding = 8.0 * std::numeric_limits<double>::epsilon();
/// Sine of the largest angle between successive bars of a straight row, far above kSlack and rounding.
constexpr double kSameDirection = 1e-5;

struct End {
    std::uint32_t particle = 0;
    double rest_m = 0.0;
};

struct HeldRows {
    std::vector<double> inverse_mass_1_kg;
    double play_m = 0.0;
};

/// Walks along straight rows from held particles.
class Rows {
  public:
    explicit Rows(const System& system)
        : system_(system),
          bars_at_(system.particle_count()),
          held_{system.inverse_mass_1_kg, 0.0},
          play_m_(system.particle_count()) {
        double farthest_m = 0.0;
        for (std::size_t i = 0; i < system.particle_count(); ++i)
            farthest_m = std::max({farthest_m, std::abs(system.x_m[i]), std::abs(system.y_m[i])});
        rounding_m_ = kRowRounding * (farthest_m + largest_length_m(system));
        for (const Bar& bar : rigid_bars(system)) {
            bars_at_[bar.a].push_back({bar.b, bar.rest_m});
            bars_at_[bar.b].push_back({bar.a, bar.rest_m});
        }
    }

    /// Holds what rows between held particles hold until no more is found.
    HeldRows hold() {
        std::vector<std::uint32_t> to_do;
        for (std::uint32_t i = 0; i < bars_at_.size(); ++i) {
            if (is_held(i)) to_do.push_back(i);
        }
        while (!to_do.empty()) {
            const std::uint32_t from = to_do.back();
            to_do.pop_back();
            for (const End& first : bars_at_[from]) {
                count_work(1);
                if (!find_row(from, first)) continue;
                const double play_m = play_of_row_m(from);
                held_.play_m = std::max(held_.play_m, play_m);
                row_.pop_back();
                for (const std::uint32_t i : row_) {
                    held_.inverse_mass_1_kg[i] = 0.0;
                    play_m_[i] = play_m;
                    to_do.push_back(i);
                }
            }
        }
        return held_;
    }

  private:
    [[nodiscard]] bool is_held(std::uint32_t i) const { return held_.inverse_mass_1_kg[i] == 0.0; }
    [[nodiscard]] Vec2 along(std::uint32_t a, std::uint32_t b) const {
        return {system_.x_m[b] - system_.x_m[a], system_.y_m[b] - system_.y_m[a]};
    }

    /// The nearest particle that a bar leads to from `at` in this direction.
    [[nodiscard]] std::optional<End> next(std::uint32_t at, Vec2 direction) const {
        std::optional<End> nearest;
        for (const End& end : bars_at_[at]) {
            const Vec2 d = along(at, end.particle);
            const double forward = dot(d, direction);
            if (forward <= 0.0 || std::abs(d.x * direction.y - d.y * direction.x) > kSameDirection * forward)
                continue;
            if (!nearest || end.rest_m < nearest->rest_m) nearest = end;
        }
        return nearest;
    }

    /// How far the particles of row_ may move in truth. The bars of a row that is arched are longer together
    /// than its ends are apart, by the squares of their slopes; so much may gather in one corner.
    [[nodiscard]] double play_of_row_m(std::uint32_t from) const {
        const Vec2 all = along(from, row_.back());
        const double span_m = length(all.x, all.y);
        double longer_m = play_m_[from] + play_m_[row_.back()];  // if the ends approach each other
        std::uint32_t before = from;
        for (const std::uint32_t i : row_) {
            const Vec2 d = along(before, i);
            const double rise_m = (all.x * d.y - all.y * d.x) / span_m;
            longer_m += 0.5 * rise_m * rise_m / length(d.x, d.y);
            before = i;
        }
        return 2.0 * std::sqrt(0.5 * span_m * longer_m);
    }

    /// True if the row that starts with this bar is straight and ends at a held particle. Writes the
    /// particles after `from` to row_.
    [[nodiscard]] bool find_row(std::uint32_t from, const End& first) {
        row_.assign(1, first.particle);
        const Vec2 direction = along(from, first.particle);
        End end = first;
        double length_m = first.rest_m;
        while (!is_held(end.particle)) {
            count_work(1);
            const std::optional<End> onward = next(end.particle, direction);
            if (!onward) return false;
            length_m += onward->rest_m;
            end = *onward;
            row_.push_back(end.particle);
        }
        const Vec2 all = along(from, end.particle);
        return row_.size() > 1 && length_m <= (1.0 + kSlack) * length(all.x, all.y) + rounding_m_;
    }

    const System& system_;
    std::vector<std::vector<End>> bars_at_;
    HeldRows held_;
    std::vector<double> play_m_;  ///< of each particle
    std::vector<std::uint32_t> row_;
    double rounding_m_ = 0.0;
};

}  // namespace

std::vector<double> inverse_masses_with_taut_rows_held(const System& system) {
    return Rows(system).hold().inverse_mass_1_kg;
}

double play_of_taut_rows_m(const System& system) {
    return Rows(system).hold().play_m;
}

}  // namespace corda::sim
