#include "corda/sim/exact/string/tension_lcp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "corda/core/cancel.hpp"

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
    EXPECT_LT(worst, 1e-10);  // measured 1.5e-11
}

/// Long chains in which pivoting changes one link at a time: a pull that has to run along all of them.
struct LongProblem {
    enum class Kind { kStraight, kStraightOfUnequalMasses, kCurved, kFolded, kPushed };
    TensionLcp lcp;

    LongProblem(Kind kind, std::size_t links) : lcp(masses(kind, links)) {
        std::mt19937 random(7);
        for (std::size_t k = 0; k < links; ++k) {
            double angle = 0.0;
            if (kind == Kind::kCurved) angle = 1e-3 * std::sin(0.01 * static_cast<double>(k));
            if (kind == Kind::kFolded && k % 500 == 499) angle = 3.0;
            lcp.cosine[k] = std::cos(angle);
            lcp.sine[k] = std::sin(angle);
            lcp.right[k] = k == 0 ? 1.0 : kind == Kind::kPushed ? -1e-7 * uniform(random) : 0.0;
            if (kind == Kind::kCurved || kind == Kind::kFolded)
                lcp.right[k] = std::sin(0.003 * static_cast<double>(k)) + 0.3 * (uniform(random) - 0.5);
            lcp.side[k] = random() % 20 == 0 ? Side::kFree : Side::kPulls;
            lcp.z_error[k] = 1e-9;
        }
    }
    static std::vector<double> masses(Kind kind, std::size_t links) {
        std::mt19937 random(8);
        std::vector<double> inverse_mass(links + 1, 1.0);
        if (kind == Kind::kStraightOfUnequalMasses) {
            for (double& mass : inverse_mass) mass = std::pow(10.0, 12.0 * uniform(random) - 6.0);
        }
        inverse_mass[0] = 0.0;
        return inverse_mass;
    }
};

/// How often the links of a problem are gone through until it is solved.
double passes_to_solve(LongProblem::Kind kind, std::size_t links) {
    LongProblem problem(kind, links);
    std::uint64_t asked = 0;
    const CancelScope count([&asked] { ++asked; });
    EXPECT_TRUE(problem.lcp.solve(1e-12)) << static_cast<int>(kind);
    return static_cast<double>(asked * kUpdatesPerCheck) / static_cast<double>(links);
}

TEST(TensionLcp, TakesNoMorePassesForMoreLinks) {
    using Kind = LongProblem::Kind;
    for (const Kind kind :
         {Kind::kStraight, Kind::kStraightOfUnequalMasses, Kind::kCurved, Kind::kFolded, Kind::kPushed}) {
        double most = 0.0;
        for (const std::size_t links : {10'000U, 40'000U})
            most = std::max(most, passes_to_solve(kind, links));
        std::printf("kind %d: %.0f passes\n", static_cast<int>(kind), most);
        EXPECT_LT(most, 300.0);  // measured 99 to 152; pivoting alone some 5000
    }
}

TEST(TensionLcp, KeepsTheGuessOfLinksWithoutAnyForceInALongChain) {
    // Only the first half is pulled; the links of the other have z = w = 0 on either side.
    LongProblem problem(LongProblem::Kind::kStraight, 4000);
    TensionLcp& lcp = problem.lcp;
    lcp.side[2000] = Side::kAbsent;
    const std::vector<Side> guess = lcp.side;
    ASSERT_TRUE(lcp.solve(1e-12));
    for (std::size_t k = 0; k < 2000; ++k) EXPECT_EQ(lcp.side[k], Side::kPulls) << k;
    EXPECT_TRUE(std::equal(guess.begin() + 2000, guess.end(), lcp.side.begin() + 2000));
}

TEST(TensionLcp, KeepsTheGuessWithinRounding) {
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

TEST(TensionLcp, FailsOnNumbersThatAreNotFinite) {
    TensionLcp lcp({1.0, 1.0});
    lcp.side = {Side::kPulls};
    lcp.right = {std::nan("")};
    EXPECT_FALSE(lcp.solve(0.0));
}

}  // namespace
}  // namespace corda::sim
