#include "corda/sim/exact/string/contacts.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/strings.hpp"

namespace corda::sim {
namespace {

TEST(StringContacts, ShareASnapAmongTautNeighbours) {
    // Unit masses at 0, 1, 2 and 3 on a line; the last one flies off at 4 m/s: all move at 1 m/s then.
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {3.0, 0.0}}, {});
    rope.pinned = {};
    rope.velocity_m_s[3] = {4.0, 2.0};
    System system = build_system({&rope, 1});
    StringContacts contacts(system, Forces(ForceTerm{}), 1e-9);
    std::vector<std::uint8_t> is_taut{1, 1, 0};
    ASSERT_TRUE(contacts.resolve(system, is_taut));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(system.vx_m_s[i], 1.0, 1e-15);
    EXPECT_EQ(system.vy_m_s, std::vector<double>({0.0, 0.0, 0.0, 2.0}));
    // The last one goes round the others and pulls.
    EXPECT_EQ(is_taut, std::vector<std::uint8_t>({1, 1, 1}));
}

TEST(StringContacts, ReleaseLinksThatASnapShortens) {
    // Link 1 lies back on link 0, both taut; the particle between them is pulled by link 1 alone.
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {0.0, 0.0}}, {});
    rope.velocity_m_s[2] = {-4.0, 0.0};
    System system = build_system({&rope, 1});
    StringContacts contacts(system, Forces(ForceTerm{}), 1e-9);
    std::vector<std::uint8_t> is_taut{1, 1};
    ASSERT_TRUE(contacts.resolve(system, is_taut));
    EXPECT_NEAR(system.vx_m_s[1], -2.0, 1e-15);
    EXPECT_NEAR(system.vx_m_s[2], -2.0, 1e-15);
    EXPECT_EQ(is_taut[0], 0);
}

/// Whether link 1 stays taut at a tolerance, when the snap of link 0 sends it inwards at about `speed_m_s`.
bool stays_taut(double speed_m_s, double tolerance) {
    // Link 0 hangs down and snaps; link 1 leads off from it to the side and a little down.
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.0, -1.0}, {1.0, -1.0}}, {});
    rope.velocity_m_s[2] = {-speed_m_s, -3.0};
    System system = build_system({&rope, 1});
    StringContacts contacts(system, Forces(ForceTerm{{0.0, -9.81}}), tolerance);
    std::vector<std::uint8_t> is_taut{1, 1};
    EXPECT_TRUE(contacts.resolve(system, is_taut));
    return is_taut[1] == 1;
}

TEST(StringContacts, ReleaseMoreLinksAtATighterTolerance) {
    // Back after 4e-6 s at an acceleration of about 9 m/s^2: shorter by 4e-11 m meanwhile.
    EXPECT_TRUE(stays_taut(2e-5, 1e-8));
    EXPECT_FALSE(stays_taut(2e-5, 1e-10));
    EXPECT_TRUE(stays_taut(2e-7, 1e-15));  // 4e-15 m are rounding
}

}  // namespace
}  // namespace corda::sim
