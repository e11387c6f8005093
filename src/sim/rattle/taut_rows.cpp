#include "corda/sim/rattle/taut_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

/// A row is straight if its bars are longer than the distance of its ends by no more than this share of it,
/// which is rounding: sagging by a part in 1e7 would take twice as much.
constexpr double kSlack = 1e-14;
/// Of the coordinates and, where a check moves its start by rounding, of all lengths together.
constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
/// The sine of the angle by which a bar of a straight row may turn from the one before, far above what kSlack
/// leaves and rounding.
constexpr double kSameDirection = 1e-5;

struct End {
    std::uint32_t particle = 0;
    double rest_m = 0.0;
};

/// Walks along straight rows from held particles.
class Rows {
  public:
    explicit Rows(const System& system)
        : system_(system), bars_at_(system.particle_count()), inverse_mass_1_kg_(system.inverse_mass_1_kg) {
        double farthest_m = 0.0;
        for (std::size_t i = 0; i < system.particle_count(); ++i)
            farthest_m = std::max({farthest_m, std::abs(system.x_m[i]), std::abs(system.y_m[i])});
        rounding_m_ = kRounding * (farthest_m + largest_length_m(system));
        for (const Bar& bar : rigid_bars(system)) {
            bars_at_[bar.a].push_back({bar.b, bar.rest_m});
            bars_at_[bar.b].push_back({bar.a, bar.rest_m});
        }
    }

    /// Holds what rows between held particles hold until no more is found; returns the inverse masses.
    std::vector<double> hold() {
        std::vector<std::uint32_t> to_do;
        for (std::uint32_t i = 0; i < bars_at_.size(); ++i) {
            if (is_held(i)) to_do.push_back(i);
        }
        while (!to_do.empty()) {
            const std::uint32_t from = to_do.back();
            to_do.pop_back();
            for (const End& first : bars_at_[from]) {
                if (!find_row(from, first)) continue;
                for (const std::uint32_t i : row_) {
                    inverse_mass_1_kg_[i] = 0.0;
                    to_do.push_back(i);
                }
            }
        }
        return inverse_mass_1_kg_;
    }

  private:
    [[nodiscard]] bool is_held(std::uint32_t i) const { return inverse_mass_1_kg_[i] == 0.0; }
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

    /// Whether a row that starts like this is straight and ends at a held particle; row_ are then the ones
    /// between.
    [[nodiscard]] bool find_row(std::uint32_t from, const End& first) {
        row_.clear();
        const Vec2 direction = along(from, first.particle);
        End end = first;
        double length_m = first.rest_m;
        while (!is_held(end.particle)) {
            row_.push_back(end.particle);
            const std::optional<End> onward = next(end.particle, direction);
            if (!onward) return false;
            length_m += onward->rest_m;
            end = *onward;
        }
        const Vec2 all = along(from, end.particle);
        return !row_.empty() && length_m <= (1.0 + kSlack) * length(all.x, all.y) + rounding_m_;
    }

    const System& system_;
    std::vector<std::vector<End>> bars_at_;
    std::vector<double> inverse_mass_1_kg_;
    std::vector<std::uint32_t> row_;
    double rounding_m_ = 0.0;
};

}  // namespace

std::vector<double> inverse_masses_with_taut_rows_held(const System& system) {
    return Rows(system).hold();
}

}  // namespace corda::sim
