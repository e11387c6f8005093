#include "corda/sim/exact/net_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "corda/core/cancel.hpp"
#include "corda/core/disjoint_sets.hpp"

namespace corda::sim {
namespace {

/// Two bars are parallel if their vectors differ by no more than this share of the length of all links and of
/// the largest coordinate: rounding, also that of the displaced starts of checks.
constexpr double kSameSide = 16.0 * std::numeric_limits<double>::epsilon();
/// Cells are flat if the sine of their angle is below this. They could open into two motions.
constexpr double kFlat = 1e-6;
/// Bars looked at per update of count_work().
constexpr std::size_t kBarsPerUpdate = 16;
/// Finds the bars that turn together.
class Joiner {
  public:
    Joiner(const System& system, const std::vector<double>& inverse_mass_1_kg)
        : system_(system),
          ends_(system.particle_count()),
          held_(system.particle_count()),
          groups_(ground() + 1) {
        double farthest_m = 0.0;
        for (std::uint32_t k = 0; k < system.bars.size(); ++k) {
            ends_[system.bars[k].a].push_back({system.bars[k].b, k});
            ends_[system.bars[k].b].push_back({system.bars[k].a, k});
        }
        for (std::size_t i = 0; i < held_.size(); ++i) {
            held_[i] = inverse_mass_1_kg[i] == 0.0;
            farthest_m = std::max({farthest_m, std::abs(system.x_m[i]), std::abs(system.y_m[i])});
        }
        rounding_m_ = kSameSide * (farthest_m + largest_length_m(system));
        do {
            is_new_ = false;
            hold();
            for (std::uint32_t k = 0; k < system.bars.size(); ++k) join_around(k);
        } while (is_new_);
    }

    void read(BarGroups& groups) {
        constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
        std::vector<std::uint32_t> number(ground() + std::size_t{1}, kNone);
        for (std::uint32_t k = 0; k < system_.bars.size(); ++k) {
            std::uint32_t& own = number[find(k)];
            if (own == kNone && find(k) != find(ground())) own = static_cast<std::uint32_t>(groups.count++);
            groups.of_bar.push_back(own);
        }
        std::ranges::replace(groups.of_bar, kNone, static_cast<std::uint32_t>(groups.count));
        groups.is_held = held_;
    }

  private:
    struct End {
        std::uint32_t particle;
        std::uint32_t bar;
    };

    /// The group of bars that never turn.
    [[nodiscard]] std::uint32_t ground() const { return static_cast<std::uint32_t>(system_.bars.size()); }

    [[nodiscard]] std::uint32_t find(std::uint32_t k) { return groups_.of(k); }

    void unite(std::uint32_t k, std::uint32_t l) { is_new_ = groups_.join(k, l) || is_new_; }

    /// Bars between held particles never turn, and such bars hold the particles to which they lead.
    void hold() {
        std::vector<std::uint32_t> to_do;
        for (std::uint32_t i = 0; i < held_.size(); ++i) {
            if (held_[i]) to_do.push_back(i);
        }
        while (!to_do.empty()) {
            const std::uint32_t from = to_do.back();
            to_do.pop_back();
            count_work(1);
            for (const auto& [particle, bar] : ends_[from]) {
                if (held_[particle]) unite(bar, ground());
                if (held_[particle] || find(bar) != find(ground())) continue;
                held_[particle] = true;
                to_do.push_back(particle);
            }
        }
    }

    /// The bar between two particles, ground() if both are held, std::nullopt if there is none.
    [[nodiscard]] std::optional<std::uint32_t> between(std::uint32_t a, std::uint32_t d) const {
        if (held_[a] && held_[d]) return ground();
        for (const End& end : ends_[a]) {
            if (end.particle == d) return end.bar;
        }
        return std::nullopt;
    }

    [[nodiscard]] Vec2 along(std::uint32_t a, std::uint32_t b) const {
        return {system_.x_m[b] - system_.x_m[a], system_.y_m[b] - system_.y_m[a]};
    }

    /// Unites the sides of the triangles, and the opposite sides of the parallelograms, that have this bar as
    /// a side.
    void join_around(std::uint32_t bar) {
        const auto [b, c, reach, rest_m] = system_.bars[bar];
        const Vec2 base = along(b, c);
        for (const End& from_b : ends_[b]) {
            if (from_b.particle == c) continue;
            count_work(1 + ends_[c].size() / kBarsPerUpdate);
            const Vec2 side = along(b, from_b.particle);
            const bool is_flat = std::abs(base.x * side.y - base.y * side.x) <=
                                 kFlat * rest_m * system_.bars[from_b.bar].rest_m;
            for (const End& from_c : ends_[c]) {
                if (from_c.particle == b) continue;
                if (from_c.particle == from_b.particle) {
                    unite(bar, from_b.bar);
                    unite(bar, from_c.bar);
                    continue;
                }
                const Vec2 differ = along(c, from_c.particle) - side;
                if (is_flat || !(std::abs(differ.x) + std::abs(differ.y) <= rounding_m_)) continue;
                const auto top = between(from_b.particle, from_c.particle);
                if (!top) continue;
                unite(bar, *top);
                unite(from_b.bar, from_c.bar);
            }
        }
    }

    const System& system_;
    std::vector<std::vector<End>> ends_;  ///< of the bars at each particle
    std::vector<bool> held_;
    DisjointSets groups_;
    double rounding_m_ = 0.0;
    bool is_new_ = false;
};

}  // namespace

BarGroups::BarGroups(const System& system, const std::vector<double>& inverse_mass_1_kg) {
    Joiner(system, inverse_mass_1_kg).read(*this);
}

}  // namespace corda::sim
