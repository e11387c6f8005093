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

TEST(TautRows, HoldFarAwayAndInAStartThatIsMovedByRounding) {
    NetDef net = test::cloth(30, 30, 0.1);
    net.pinned = {0, 29, 885};
    const std::ptrdiff_t here = held(net);
    EXPECT_GT(here, 31);
    for (Vec2& point : net.points_m) point = point + Vec2{100.1, 33.3};
    EXPECT_EQ(held(net), here);
    System system = build_system({}, {&net, 1});
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        if (!system.is_pinned(i)) system.x_m[i] += sign * 2.2e-16 * largest_length_m(system);
    }
    const std::vector<double> moved = inverse_masses_with_taut_rows_held(system);
    EXPECT_EQ(std::count(moved.begin(), moved.end(), 0.0), here);
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
