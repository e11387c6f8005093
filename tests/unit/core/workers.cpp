#include "corda/core/workers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

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

TEST(TaskQueue, RunsTasksThatTasksAdd) {
    for (const unsigned threads : {1U, 4U}) {
        TaskQueue queue;
        std::atomic<int> done = 0;
        for (int i = 0; i < 20; ++i)
            queue.push_back([&] {
                for (int k = 0; k < 10; ++k) queue.push_front([&] { ++done; });
            });
        queue.run(threads);
        EXPECT_EQ(done, 200);
    }
}

TEST(TaskQueue, RunsFrontTasksBeforeWaitingOnes) {
    TaskQueue queue;
    std::vector<int> order;
    queue.push_back([&] {
        order.push_back(1);
        queue.push_front([&] { order.push_back(2); });
    });
    queue.push_back([&] { order.push_back(3); });
    queue.run(1);
    EXPECT_EQ(order, (std::vector{1, 2, 3}));
}

TEST(TaskQueue, DropsTheRestAfterAFailure) {
    TaskQueue queue;
    int done = 0;
    queue.push_back([&] { ++done; });
    queue.push_back([] { throw std::runtime_error("first"); });
    queue.push_back([&] { ++done; });
    EXPECT_THROW(queue.run(1), std::runtime_error);
    EXPECT_EQ(done, 1);
}

using Numbers = OrderedWorkers<std::int64_t>;

/// Takes the remaining items.
std::vector<std::int64_t> take(Numbers& all, std::size_t count) {
    std::vector<std::int64_t> taken;
    while (taken.size() < count)
        if (const auto number = all.wait()) taken.push_back(*number);
    return taken;
}

TEST(OrderedWorkers, ReturnsItemsInOrderIfLaterOnesFinishFirst) {
    for (const int threads : {1, 2, 8}) {
        Numbers all(3, 40, threads, [] {
            return [](std::int64_t number, const Numbers&) {
                std::this_thread::sleep_for(std::chrono::microseconds(number % 3 == 0 ? 2000 : 10));
                return number;
            };
        });
        std::vector<std::int64_t> expected(37);
        std::iota(expected.begin(), expected.end(), 3);
        EXPECT_EQ(take(all, expected.size()), expected) << threads;
        EXPECT_EQ(all.taken(), 40);
    }
}

TEST(OrderedWorkers, MakesAtMostTwoUntakenItemsPerThread) {
    std::atomic<int> made = 0;
    Numbers all(0, 100, 2, [&made] {
        return [&made](std::int64_t number, const Numbers&) {
            ++made;
            return number;
        };
    });
    while (made < 4) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(made, 4);
    EXPECT_EQ(take(all, 1).front(), 0);
    while (made < 5) std::this_thread::yield();
}

TEST(OrderedWorkers, ThrowsAFailureInItsTurn) {
    Numbers all(0, 10, 2, [] {
        return [](std::int64_t number, const Numbers&) {
            if (number == 3) throw std::runtime_error("three");
            return number;
        };
    });
    EXPECT_EQ(take(all, 3), (std::vector<std::int64_t>{0, 1, 2}));
    EXPECT_THROW(
        {
            for (;;) static_cast<void>(all.wait());
        },
        std::runtime_error);
}

TEST(OrderedWorkers, ThrowsTheErrorOfCreatingAMaker) {
    Numbers all(0, 4, 1, []() -> Numbers::Make { throw std::runtime_error("no maker"); });
    EXPECT_THROW(
        {
            for (;;) static_cast<void>(all.wait());
        },
        std::runtime_error);
}

TEST(OrderedWorkers, ReturnsStartedItemsAfterAStop) {
    std::atomic<int> begun = 0;
    Numbers all(0, 10, 2, [&begun] {
        return [&begun](std::int64_t number, const Numbers& numbers) {
            ++begun;
            while (!numbers.is_stopped()) std::this_thread::yield();
            return number;
        };
    });
    while (begun < 2) std::this_thread::yield();
    EXPECT_EQ(all.wait(), std::nullopt);
    all.stop();
    EXPECT_EQ(all.rest(), 0);
    EXPECT_EQ(all.rest(), 1);
    EXPECT_EQ(all.rest(), std::nullopt);
}

}  // namespace
}  // namespace corda
