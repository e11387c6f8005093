#include "corda/sim/exact/string/tension_lcp.hpp"
#include "support/unstopped.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

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
        ASSERT_TRUE(lcp.solve(0.0, test::unstopped));
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
    EXPECT_LT(worst, 1e-10);  // measured 1.5e-11
}

TEST(TensionLcp, KeepsTheGuessWithinRounding) {
    for (const Side guess : {Side::kPulls, Side::kFree}) {
        TensionLcp lcp({1.0, 1.0, 1.0});
        lcp.side = {guess, guess};
        lcp.z_error = {1e-12, 1e-12};
        lcp.right = {1e-14, -1e-14};
        lcp.cosine = {1.0, 1.0};
        ASSERT_TRUE(lcp.solve(1e-12, test::unstopped));
        EXPECT_EQ(lcp.side, std::vector<Side>({guess, guess}));
    }
}

TEST(TensionLcp, FailsOnNumbersThatAreNotFinite) {
    TensionLcp lcp({1.0, 1.0});
    lcp.side = {Side::kPulls};
    lcp.right = {std::nan("")};
    EXPECT_FALSE(lcp.solve(0.0, test::unstopped));
}

}  // namespace
}  // namespace corda::sim
