// What has to hold for any rope, on a few hundred random ones: links are kept, energy is kept without drag
// and never rises with it, the mirrored start gives the mirrored motion, and a rope four times as long moves
// half as fast.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

constexpr int kRopes = 300;
constexpr double kDuration = 0.5;

/// std::mt19937 is the same everywhere; the distributions of <random> are not.
class Numbers {
  public:
    explicit Numbers(std::uint32_t seed) : generator_(seed) {}
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
    }
    int below(int limit) { return static_cast<int>(between(0.0, limit)); }

  private:
    std::mt19937 generator_;
};

/// 1 to 12 links of 0.1 to 0.5 m in directions that turn by up to 1.5 per link, masses of 0.1 to 10 kg,
/// speeds of up to 2 m/s; pinned at its first particle, inside, or not at all.
RopeDef random_rope(std::uint32_t seed) {
    Numbers numbers(seed);
    RopeDef rope;
    const int links = 1 + numbers.below(12);
    double angle = numbers.between(-std::numbers::pi, std::numbers::pi);
    Vec2 point;
    for (int i = 0; i <= links; ++i) {
        rope.points_m.push_back(point);
        rope.mass_kg.push_back(std::pow(10.0, numbers.between(-1.0, 1.0)));
        rope.velocity_m_s.push_back({numbers.between(-2.0, 2.0), numbers.between(-2.0, 2.0)});
        angle += numbers.between(-1.5, 1.5);
        const double link_m = numbers.between(0.1, 0.5);
        point = point + link_m * Vec2{std::sin(angle), -std::cos(angle)};
    }
    const int kind = numbers.below(3);
    rope.pinned = {0};
    if (kind == 1) rope.pinned = {static_cast<std::uint32_t>(links / 2)};
    if (kind == 2) rope.pinned = {};
    return rope;
}

struct Variant {
    MethodDef solver;
    double energy_error;  ///< allowed, of m g L
};

/// Both formulations of an inextensible rope.
std::vector<Variant> variants() {
    return {{ExactDef{1e-9}, 1e-9}, {RattleDef{8, 1e-3}, 1e-7}};  // measured 2.1e-11 and 1.3e-8
}

Simulation start(const RopeDef& rope, const MethodDef& solver, double drag_1_s = 0.0) {
    return {build_system({&rope, 1}), WorldDef{{0.0, -9.81}, 10.0, drag_1_s}, solver, 1.0 / 60.0};
}

TEST(RandomRopes, KeepTheirLinksAndTheirEnergy) {
    for (const Variant& variant : variants()) {
        double worst_energy = 0.0;
        double worst_strain = 0.0;
        for (std::uint32_t seed = 0; seed < kRopes; ++seed) {
            Simulation run = start(random_rope(seed), variant.solver);
            for (int k = 1; k <= 5; ++k)
                ASSERT_EQ(run.advance_to(kDuration * k / 5), Status::kOk) << "seed " << seed;
            worst_energy = std::max(worst_energy, run.diagnostics().largest.energy_error.value_or(1.0));
            worst_strain = std::max(worst_strain, run.diagnostics().largest.strain);
        }
        EXPECT_LT(worst_strain, 1e-13) << method_name(variant.solver);
        EXPECT_LT(worst_energy, variant.energy_error) << method_name(variant.solver);
    }
}

TEST(RandomRopes, NeverGainEnergyUnderDrag) {
    for (const Variant& variant : variants()) {
        for (std::uint32_t seed = 0; seed < kRopes; ++seed) {
            const RopeDef rope = random_rope(seed);
            const System system = build_system({&rope, 1});
            const auto solver =
                make_solver(system, WorldDef{{0.0, -9.81}, 10.0, 1.5}, {&variant.solver, 1}, 1.0 / 60.0);
            State state{0.0, system.x_m, system.y_m};
            double before_j = solver->energy_j();
            for (int k = 1; k <= 20; ++k) {
                ASSERT_EQ(solver->advance_to(kDuration * k / 20, state), Status::kOk);
                const double slack_j = 1e-12 * solver->energy_scale_j();
                EXPECT_LT(solver->energy_j(), before_j + slack_j) << "seed " << seed << " step " << k;
                before_j = solver->energy_j();
            }
        }
    }
}

TEST(RandomRopes, MirroredMoveAsInAMirrorToTheLastBit) {
    for (const Variant& variant : variants()) {
        for (std::uint32_t seed = 0; seed < kRopes; ++seed) {
            const RopeDef rope = random_rope(seed);
            RopeDef mirrored = rope;
            for (Vec2& point : mirrored.points_m) point.x = -point.x;
            for (Vec2& velocity : mirrored.velocity_m_s) velocity.x = -velocity.x;
            Simulation run = start(rope, variant.solver);
            Simulation mirror = start(mirrored, variant.solver);
            ASSERT_EQ(run.advance_to(kDuration), Status::kOk);
            ASSERT_EQ(mirror.advance_to(kDuration), Status::kOk);
            for (std::size_t i = 0; i < run.state().x_m.size(); ++i) {
                EXPECT_EQ(mirror.state().x_m[i], -run.state().x_m[i]) << "seed " << seed;
                EXPECT_EQ(mirror.state().y_m[i], run.state().y_m[i]) << "seed " << seed;
            }
        }
    }
}

TEST(RandomRopes, FourTimesAsLongMoveHalfAsFast) {
    for (Variant variant : variants()) {
        for (std::uint32_t seed = 0; seed < kRopes; ++seed) {
            const RopeDef rope = random_rope(seed);
            RopeDef large = rope;
            for (Vec2& point : large.points_m) point = 4.0 * point;
            for (Vec2& velocity : large.velocity_m_s) velocity = 2.0 * velocity;
            Simulation run = start(rope, variant.solver);
            MethodDef slower = variant.solver;
            if (auto* rattle = std::get_if<RattleDef>(&slower)) rattle->step_s = 2.0 * *rattle->step_s;
            Simulation scaled = start(large, slower);
            ASSERT_EQ(run.advance_to(kDuration), Status::kOk);
            ASSERT_EQ(scaled.advance_to(2.0 * kDuration), Status::kOk);
            for (std::size_t i = 0; i < run.state().x_m.size(); ++i) {
                EXPECT_NEAR(scaled.state().x_m[i], 4.0 * run.state().x_m[i], 1e-9) << "seed " << seed;
                EXPECT_NEAR(scaled.state().y_m[i], 4.0 * run.state().y_m[i], 1e-9) << "seed " << seed;
            }
        }
    }
}

TEST(RandomRopes, MoveAlikeByBothFormulations) {
    double worst_m = 0.0;
    for (std::uint32_t seed = 0; seed < kRopes; ++seed) {
        const RopeDef rope = random_rope(seed);
        Simulation exact = start(rope, variants()[0].solver);
        Simulation rattle = start(rope, variants()[1].solver);
        ASSERT_EQ(exact.advance_to(kDuration), Status::kOk);
        ASSERT_EQ(rattle.advance_to(kDuration), Status::kOk);
        for (std::size_t i = 0; i < exact.state().x_m.size(); ++i) {
            worst_m = std::max(worst_m, std::abs(exact.state().x_m[i] - rattle.state().x_m[i]));
            worst_m = std::max(worst_m, std::abs(exact.state().y_m[i] - rattle.state().y_m[i]));
        }
    }
    EXPECT_LT(worst_m, 1e-6);  // measured 7e-8, the error of rattle at this step
}

}  // namespace
}  // namespace corda::sim
