#include "corda/core/threads.hpp"

#include <gtest/gtest.h>

#include <atomic>

namespace corda {
namespace {

TEST(Threads, DoTheWorkOnceEach) {
    std::atomic<int> done = 0;
    {
        const auto threads = start_threads(3, [&] { ++done; });
        EXPECT_EQ(threads.size(), 3U);
    }
    EXPECT_EQ(done, 3);
    EXPECT_TRUE(start_threads(0, [&] { ++done; }).empty());
    EXPECT_TRUE(start_threads(-1, [&] { ++done; }).empty());
    EXPECT_EQ(done, 3);
}

TEST(Threads, AreCountedByStartingThem) {
    EXPECT_TRUE(can_start_threads(0));
    EXPECT_TRUE(can_start_threads(20));
}

}  // namespace
}  // namespace corda
