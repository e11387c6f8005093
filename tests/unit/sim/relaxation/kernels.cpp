// The AVX2 kernel of the relaxation method gives the bits of the scalar one.

#include "corda/sim/relaxation/kernels.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "corda/sim/relaxation/relaxation.hpp"
#include "support/random_system.hpp"

namespace corda::sim {
namespace {

RelaxationDef random_method(test::Random& random) {
    RelaxationDef def;
    def.sweeps = std::array{1, 1, 2, 3, 7}[static_cast<std::size_t>(test::pick(random, 0, 4))];
    def.delta = test::pick(random, 0, 1) * 0.01;
    if (test::pick(random, 0, 1) == 0) def.force_n = Vec2{0.0, test::pick(random, 0, 1) * -9.8};
    return def;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// A run by one kernel.
struct KernelRun {
    KernelRun(const System& system, const RelaxationDef& def, RelaxationKernel kernel)
        : relaxation(system, WorldDef{}, def, 1.0 / 64.0, kernel), state{0.0, system.x_m, system.y_m} {}
    Relaxation relaxation;
    State state;
};

class RelaxationKernels : public testing::TestWithParam<RelaxationKernel> {};

INSTANTIATE_TEST_SUITE_P(OfThisCpu, RelaxationKernels, testing::ValuesIn(relaxation_kernels()),
                         [](const auto& param) {
                             return fmt::format("kernel_{}", static_cast<int>(param.param));
                         });

TEST_P(RelaxationKernels, HaveTheBitsOfTheScalarOneOnRandomBodies) {
    for (unsigned seed = 0; seed < 250; ++seed) {
        test::Random random(seed);
        const System system = test::random_system(random);
        const RelaxationDef def = random_method(random);
        KernelRun scalar(system, def, RelaxationKernel::kScalar);
        KernelRun run(system, def, GetParam());
        double time_s = 0.0;
        // Single steps, many at once, and times between two steps.
        for (const double steps : {1.0, 1.0, 1.0, 2.0, 0.25, 0.75, 5.0, 20.0, 1.5, 2.5}) {
            time_s += steps / 64.0;
            ASSERT_EQ(scalar.relaxation.advance_to(time_s, scalar.state), Status::kOk);
            ASSERT_EQ(run.relaxation.advance_to(time_s, run.state), Status::kOk);
            ASSERT_TRUE(same_bits(scalar.state.x_m, run.state.x_m)) << "seed " << seed << ", " << time_s;
            ASSERT_TRUE(same_bits(scalar.state.y_m, run.state.y_m)) << "seed " << seed << ", " << time_s;
            ASSERT_EQ(scalar.relaxation.energy_j(), run.relaxation.energy_j()) << "seed " << seed;
        }
    }
}

TEST_P(RelaxationKernels, HaveTheBitsOfTheScalarOneOverManySteps) {
    for (const int particles : {20, 40, 100, 300}) {
        const System system = test::report_system(particles);
        KernelRun scalar(system, RelaxationDef{}, RelaxationKernel::kScalar);
        KernelRun run(system, RelaxationDef{}, GetParam());
        ASSERT_EQ(scalar.relaxation.advance_to(60.0, scalar.state), Status::kOk);
        ASSERT_EQ(run.relaxation.advance_to(60.0, run.state), Status::kOk);
        EXPECT_LT(std::abs(scalar.state.x_m.back()), particles);
        EXPECT_TRUE(same_bits(scalar.state.x_m, run.state.x_m)) << particles << " particles";
        EXPECT_TRUE(same_bits(scalar.state.y_m, run.state.y_m)) << particles << " particles";
    }
}

TEST_P(RelaxationKernels, GiveTheSameBitsInPiecesOfSweeps) {
    const System system = test::report_system(40);
    std::vector<RelaxationBar> bars;
    for (const Bar& bar : system.bars)
        bars.push_back({bar.a, bar.b, bar.rest_m, system.is_pinned(bar.a) ? 0.0 : 0.5});
    const RelaxationSchedule schedule =
        schedule_bars(bars, 0, static_cast<std::uint32_t>(system.particle_count()));
    RelaxationMotion start;
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        const double push_m = system.is_pinned(i) ? 0.0 : -0.002;
        start.position_m.insert(start.position_m.end(), {system.x_m[i], system.y_m[i]});
        start.moves.push_back({{}, {system.x_m[i], system.y_m[i]}, {}, {0.0, push_m}});
    }
    for (const bool starts_updated : {false, true}) {
        RelaxationMotion whole = start;
        run_sweeps(bars, {0, 100, 7, starts_updated}, whole);
        for (const std::uint64_t piece : {1, 3, 7, 8, 50}) {
            RelaxationMotion motion = start;
            for (std::uint64_t k = 0; k < 100; k += piece) {
                const RelaxationSweeps sweeps{k, std::min<std::uint64_t>(100, k + piece), 7, starts_updated};
                if (GetParam() == RelaxationKernel::kScalar) {
                    run_sweeps(bars, sweeps, motion);
                } else {
                    run_sweeps(schedule, sweeps, motion);
                }
            }
            EXPECT_TRUE(same_bits(motion.position_m, whole.position_m)) << piece;
            for (std::size_t i = 0; i < whole.moves.size(); ++i)
                EXPECT_EQ(motion.moves[i].last_move_m, whole.moves[i].last_move_m) << piece;
        }
    }
}

TEST_P(RelaxationKernels, DoNotMoveAFoldedRopeOfBarsWithoutLength) {
    // Particles in turn in two places, weightless and motionless: bars of even reach have no length, ever.
    RopeDef rope = reference::report_rope(50);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i) rope.points_m[i] = {0.0, i % 2 == 0 ? 0.0 : -1.0};
    RelaxationDef def;
    def.force_n = Vec2{};
    rope.reach = 7;
    const System system = build_system({&rope, 1});
    KernelRun run(system, def, GetParam());
    ASSERT_EQ(run.relaxation.advance_to(2.0, run.state), Status::kOk);
    EXPECT_EQ(run.state.x_m, system.x_m);
    EXPECT_EQ(run.state.y_m, system.y_m);
}

}  // namespace
}  // namespace corda::sim
