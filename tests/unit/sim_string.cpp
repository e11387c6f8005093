#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "corda/sim/string_contacts.hpp"
#include "corda/sim/tension_lcp.hpp"
#include "corda/sim/trial.hpp"
#include "corda/study/ropes.hpp"
#include "support/solver_run.hpp"
#include "support/strings.hpp"

namespace corda::sim {
namespace {

using Side = TensionLcp::Side;

double uniform(std::mt19937& random) {
    return static_cast<double>(random()) / 4294967296.0;
}

/// A chain of links in any directions, of masses within a factor of 30 of 1, some pinned.
struct RandomProblem {
    std::vector<double> inverse_mass_1_kg;
    TensionLcp lcp;

    RandomProblem(std::size_t links, std::mt19937& random)
        : inverse_mass_1_kg(masses(links, random)), lcp(inverse_mass_1_kg) {
        for (std::size_t k = 0; k < links; ++k) {
            const double angle = 6.2831853 * uniform(random);
            lcp.cosine[k] = std::cos(angle);
            lcp.sine[k] = std::sin(angle);
            lcp.right[k] = 2.0 * uniform(random) - 1.0;
            const bool is_fixed = inverse_mass_1_kg[k] + inverse_mass_1_kg[k + 1] == 0.0;
            if (is_fixed || random() % 5 == 0) continue;
            lcp.side[k] = random() % 2 == 0 ? Side::kPulls : Side::kFree;
        }
    }
    static std::vector<double> masses(std::size_t links, std::mt19937& random) {
        std::vector<double> inverse_mass;
        for (std::size_t i = 0; i <= links; ++i) {
            inverse_mass.push_back(random() % 6 == 0 ? 0.0 : std::pow(10.0, 3.0 * uniform(random) - 1.5));
        }
        return inverse_mass;
    }
    /// b - A z of row k.
    [[nodiscard]] double rest(std::size_t k) const {
        const std::vector<double>& mass = inverse_mass_1_kg;
        double rest = lcp.right[k] - (mass[k] + mass[k + 1]) * lcp.z()[k];
        if (k > 0) rest += mass[k] * lcp.cosine[k - 1] * lcp.z()[k - 1];
        if (k + 2 < mass.size()) rest += mass[k + 1] * lcp.cosine[k] * lcp.z()[k + 1];
        return rest;
    }
};

TEST(TensionLcp, FindsTheOneSolution) {
    std::mt19937 random(1);
    std::size_t pulling = 0;
    double worst = 0.0;
    for (int trial = 0; trial < 3000; ++trial) {
        const std::size_t links = 1 + random() % (trial % 10 == 0 ? 200 : 12);
        RandomProblem problem(links, random);
        TensionLcp& lcp = problem.lcp;
        const std::vector<Side> guess = lcp.side;
        ASSERT_TRUE(lcp.solve(0.0));
        for (std::size_t k = 0; k < links; ++k) {
            ASSERT_EQ(guess[k] == Side::kAbsent, lcp.side[k] == Side::kAbsent);
            EXPECT_GE(lcp.z()[k], 0.0);
            if (lcp.side[k] == Side::kPulls) {
                worst = std::max(worst, std::abs(problem.rest(k)));
                ++pulling;
            } else {
                EXPECT_EQ(lcp.z()[k], 0.0);
                if (lcp.side[k] == Side::kFree) worst = std::max(worst, problem.rest(k));
            }
        }
    }
    std::printf("%zu links pull, rows off by %.1e\n", pulling, worst);
    EXPECT_GT(pulling, 10000U);
    EXPECT_LT(worst, 1e-10);  // measured 1.8e-12
}

TEST(TensionLcp, KeepsTheGuessWhereNothingTells) {
    for (const Side guess : {Side::kPulls, Side::kFree}) {
        TensionLcp lcp({1.0, 1.0, 1.0});
        lcp.side = {guess, guess};
        lcp.z_error = {1e-12, 1e-12};
        lcp.right = {1e-14, -1e-14};
        lcp.cosine = {1.0, 1.0};
        ASSERT_TRUE(lcp.solve(1e-12));
        EXPECT_EQ(lcp.side, std::vector<Side>({guess, guess}));
    }
}

TEST(TensionLcp, SaysSoWhereNumbersAreNone) {
    TensionLcp lcp({1.0, 1.0});
    lcp.side = {Side::kPulls};
    lcp.right = {std::nan("")};
    EXPECT_FALSE(lcp.solve(0.0));
}

TEST(StringContacts, ShareASnapAmongTautNeighbours) {
    // Unit masses at 0, 1, 2 and 3 on a line; the last one flies off at 4 m/s: all move at 1 m/s then.
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {3.0, 0.0}}, {});
    rope.pinned = {};
    rope.velocity_m_s[3] = {4.0, 2.0};
    System system = build_system({&rope, 1}, 1);
    StringContacts contacts(system, {0.0, 0.0});
    std::vector<std::uint8_t> is_taut{1, 1, 0};
    ASSERT_TRUE(contacts.resolve(system, is_taut));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(system.vx_m_s[i], 1.0, 1e-15);
    EXPECT_EQ(system.vy_m_s, std::vector<double>({0.0, 0.0, 0.0, 2.0}));
    // The last one goes round the others and pulls.
    EXPECT_EQ(is_taut, std::vector<std::uint8_t>({1, 1, 1}));
}

TEST(StringContacts, LetGoWhatASnapSendsInwards) {
    // Link 1 lies back on link 0, both taut; the particle between them is pulled by link 1 alone.
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {0.0, 0.0}}, {});
    rope.velocity_m_s[2] = {-4.0, 0.0};
    System system = build_system({&rope, 1}, 1);
    StringContacts contacts(system, {0.0, 0.0});
    std::vector<std::uint8_t> is_taut{1, 1};
    ASSERT_TRUE(contacts.resolve(system, is_taut));
    EXPECT_NEAR(system.vx_m_s[1], -2.0, 1e-15);
    EXPECT_NEAR(system.vx_m_s[2], -2.0, 1e-15);
    EXPECT_EQ(is_taut[0], 0);
}

/// Why method exact cannot run a rope; empty where it can.
std::string refusal(const RopeDef& rope) {
    return sim::refusal(build_system({&rope, 1}, 1), WorldDef{}, exact_solver(1e-9), 1.0 / 60.0);
}

TEST(ExactRefusesAString, ThatResistsBending) {
    RopeDef rope = study::straight_rope(3, 1.0, 45.0);
    rope.material.is_string = true;
    EXPECT_EQ(refusal(rope), "");
    rope.bending_n_m2 = 1.0;
    EXPECT_NE(refusal(rope).find("bending"), std::string::npos) << refusal(rope);
}

TEST(ExactRefusesAString, ThatIsLongerThanAtRest) {
    EXPECT_EQ(refusal(test::string_of({{0.0, 0.0}, {1.0, 0.0}}, {1.0})), "");
    const std::string reason = refusal(test::string_of({{0.0, 0.0}, {1.0, 0.0}}, {0.99}));
    EXPECT_NE(reason.find("longer than at rest"), std::string::npos) << reason;
}

TEST(ExactRefusesAString, ThatIsStraightBetweenTwoPins) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, {});
    rope.pinned = {0, 2};
    EXPECT_NE(refusal(rope).find("taut between two pins"), std::string::npos) << refusal(rope);
    rope.rest_m = {1.0, 1.001};
    EXPECT_EQ(refusal(rope), "");
}

TEST(ExactRefusesAString, ThatIsClosed) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}, {});
    rope.closed = true;
    EXPECT_NE(refusal(rope).find("open"), std::string::npos) << refusal(rope);
}

TEST(SlackString, CarriesNothingAndFallsFreely) {
    RopeDef rope = test::string_of({{5.0, 1.0}, {5.1, 1.0}, {5.2, 1.0}}, {1.0, 1.0});
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(0.3));
    EXPECT_EQ(run.solver().loads()->largest_tension_n, 0.0);
    EXPECT_EQ(run.solver().loads()->pin_force_n, 0.0);
    EXPECT_EQ(run.state().x_m[0], 5.0);
    EXPECT_EQ(run.state().y_m[0], 1.0);
    for (const std::size_t i : {1U, 2U}) {
        EXPECT_NEAR(run.state().x_m[i], rope.points_m[i].x, 1e-15);
        EXPECT_NEAR(run.state().y_m[i], 1.0 - 0.5 * 9.81 * 0.09, 1e-14);
    }
    EXPECT_FALSE(run.solver().conserves_energy());
    EXPECT_NEAR(run.solver().energy_j(), 9.81 * 2.0, 1e-13);
    EXPECT_NEAR(run.solver().energy_scale_j(), 9.81 * 2.0 * 2.0, 1e-13);
}

TEST(StringAndRope, InOneSceneMoveApart) {
    RopeDef string = test::string_of({{0.0, 0.0}, {0.6, 0.0}}, {1.0});
    RopeDef rope = study::straight_rope(5, 1.0, 50.0);
    rope.origin_m = {3.0, 0.0};
    const RopeDef ropes[] = {string, rope};
    const System system = build_system(ropes, 1);
    Exact both(system, WorldDef{}, SolverDef{}, 1.0 / 60.0);
    State state{0.0, system.x_m, system.y_m};
    ASSERT_EQ(both.advance_to(1.0, state), Status::kOk);
    test::ExactRun string_alone(string);
    rope.origin_m = {};
    test::ExactRun rope_alone(rope);
    ASSERT_TRUE(string_alone.go(1.0) && rope_alone.go(1.0));
    EXPECT_EQ(state.x_m[1], string_alone.state().x_m[1]);
    EXPECT_EQ(state.y_m[1], string_alone.state().y_m[1]);
    EXPECT_NEAR(state.x_m.back() - 3.0, rope_alone.state().x_m.back(), 1e-14);
    EXPECT_NEAR(both.energy_j(), string_alone.solver().energy_j() + rope_alone.solver().energy_j(), 1e-12);
}

TEST(PinnedLinks, OfAStringStay) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.5, 0.0}, {1.0, 0.0}}, {1.0, 0.5});
    rope.pinned = {0, 1};
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(1.0));
    test::ExactRun pendulum(study::straight_rope(1, 0.5, 90.0));
    ASSERT_TRUE(pendulum.go(1.0));
    EXPECT_NEAR(run.state().x_m[2], 0.5 + pendulum.state().x_m[1], 1e-12);
    EXPECT_NEAR(run.state().y_m[2], pendulum.state().y_m[1], 1e-12);
    rope.pinned = {0, 1, 2};
    test::ExactRun fixed(rope);
    ASSERT_TRUE(fixed.go(5.0));
    EXPECT_EQ(fixed.state().x_m, fixed.system().x_m);
}

}  // namespace
}  // namespace corda::sim
