#include "corda/sim/exact/string/contacts.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/strings.hpp"
#include "support/unstopped.hpp"

namespace corda::sim {
namespace {

TEST(StringContacts, ShareASnapAmongTautNeighbours) {
    // Unit masses at 0, 1, 2 and 3 on a line; the last one flies off at 4 m/s: all move at 1 m/s then.
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {3.0, 0.0}}, {});
    rope.pinned = {};
    rope.velocity_m_s[3] = {4.0, 2.0};
    System system = build_system({&rope, 1});
    StringContacts contacts(system, Forces(ForceTerm{}));
    std::vector<std::uint8_t> is_taut{1, 1, 0};
    ASSERT_TRUE(contacts.resolve(system, is_taut, test::unstopped));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(system.vx_m_s[i], 1.0, 1e-15);
    EXPECT_EQ(system.vy_m_s, std::vector<double>({0.0, 0.0, 0.0, 2.0}));
    // The last one goes round the others and pulls.
    EXPECT_EQ(is_taut, std::vector<std::uint8_t>({1, 1, 1}));
}

TEST(StringContacts, LetGoWhatASnapSendsInwards) {
    // Link 1 lies back on link 0, both taut; the particle between them is pulled by link 1 alone.
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {0.0, 0.0}}, {});
    rope.velocity_m_s[2] = {-4.0, 0.0};
    System system = build_system({&rope, 1});
    StringContacts contacts(system, Forces(ForceTerm{}));
    std::vector<std::uint8_t> is_taut{1, 1};
    ASSERT_TRUE(contacts.resolve(system, is_taut, test::unstopped));
    EXPECT_NEAR(system.vx_m_s[1], -2.0, 1e-15);
    EXPECT_NEAR(system.vx_m_s[2], -2.0, 1e-15);
    EXPECT_EQ(is_taut[0], 0);
}

}  // namespace
}  // namespace corda::sim
