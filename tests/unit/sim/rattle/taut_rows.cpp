#include "corda/sim/rattle/taut_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/nets.hpp"

namespace corda::sim {
namespace {

std::ptrdiff_t held(const NetDef& net) {
    const std::vector<double> inverse_mass_1_kg =
        inverse_masses_with_taut_rows_held(build_system({}, {&net, 1}));
    return std::count(inverse_mass_1_kg.begin(), inverse_mass_1_kg.end(), 0.0);
}

TEST(TautRows, HoldTheRowBetweenTwoPinnedCorners) {
    EXPECT_EQ(held(test::cloth(8, 6, 0.1)), 8);
    NetDef inner = test::cloth(8, 6, 0.1);
    inner.pinned = {1, 5};
    EXPECT_EQ(held(inner), 5);
}

TEST(TautRows, HoldWhatHeldRowsHold) {
    NetDef net = test::cloth(7, 5, 0.3);
    net.pinned = {0, 6, 28, 34};
    EXPECT_EQ(held(net), 35);
}

TEST(TautRows, LeaveRowsThatCanMove) {
    NetDef net = test::cloth(8, 6, 0.1);
    net.pinned = {0};
    EXPECT_EQ(held(net), 1);
    net = test::cloth(8, 6, 0.1);
    net.points_m[3].y -= 1e-6;  // sagging: longer than the pins' distance by 1e-11 of it
    EXPECT_EQ(held(net), 2);
}

}  // namespace
}  // namespace corda::sim
