#include "corda/sim/rattle/composition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>

namespace corda::sim {
namespace {

TEST(Compositions, AreSymmetricAndAddUpToOne) {
    for (const auto& [order, stages] : {std::pair{2, 1U}, {4, 5U}, {6, 9U}, {8, 17U}}) {
        const Composition& table = composition(order);
        EXPECT_EQ(table.order, order);
        ASSERT_EQ(table.stages.size(), stages);
        EXPECT_NEAR(std::accumulate(table.stages.begin(), table.stages.end(), 0.0), 1.0, 2e-16);
        for (std::size_t i = 0; i < stages; ++i) EXPECT_EQ(table.stages[i], table.stages[stages - 1 - i]);
        // Conditions of order 4 and, in part, 6 and 8: the odd power sums vanish below the order.
        for (int power = 3; power < order; power += 2) {
            double sum = 0.0;
            for (const double stage : table.stages) sum += std::pow(stage, power);
            EXPECT_NEAR(sum, 0.0, 1e-15) << order << " " << power;
        }
    }
}

TEST(Compositions, AreStableUpToTheTablesLimit) {
    // Half the trace of the composed leapfrog's matrix on x'' = -x with step z.
    const auto half_trace = [](const Composition& table, double z) {
        double a = 1.0, b = 0.0, c = 0.0, d = 1.0;
        for (const double stage : table.stages) {
            const double t = stage * z;
            const double m11 = 1.0 - 0.5 * t * t;
            const double m21 = -t + 0.25 * t * t * t;
            const double a1 = m11 * a + t * c, b1 = m11 * b + t * d;
            c = m21 * a + m11 * c;
            d = m21 * b + m11 * d;
            a = a1;
            b = b1;
        }
        return 0.5 * (a + d);
    };
    for (const int order : {2, 4, 6, 8}) {
        const Composition& table = composition(order);
        for (double z = 0.01; z < table.stable_omega_h; z += 0.01)
            EXPECT_LE(std::abs(half_trace(table, z)), 1.0 + 1e-12) << order << " " << z;
        EXPECT_GT(std::abs(half_trace(table, table.stable_omega_h + 0.02)), 1.0) << order;
    }
}

}  // namespace
}  // namespace corda::sim
