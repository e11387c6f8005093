#include "corda/core/machine.hpp"

#include <gtest/gtest.h>
#include <sched.h>

namespace corda {
namespace {

TEST(Machine, HasTheCoresOfTheAffinityMask) {
    cpu_set_t old;
    ASSERT_EQ(::sched_getaffinity(0, sizeof old, &old), 0);
    EXPECT_EQ(usable_cores(), CPU_COUNT(&old));
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int core = 0; CPU_COUNT(&one) == 0; ++core)
        if (CPU_ISSET(core, &old)) CPU_SET(core, &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(usable_cores(), 1);
    EXPECT_EQ(jobs_of(0), 1);
    EXPECT_EQ(jobs_of(3), 3);
    ASSERT_EQ(::sched_setaffinity(0, sizeof old, &old), 0);
}

}  // namespace
}  // namespace corda
