// Tasks on several threads.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "corda/golden/task_queue.hpp"

namespace corda::golden {
namespace {

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

}  // namespace
}  // namespace corda::golden
