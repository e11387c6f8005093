// Pieces of work on several threads.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "corda/suite/crew.hpp"

namespace corda::suite {
namespace {

TEST(Crew, DoesAllThatIsAddedMeanwhile) {
    for (const unsigned threads : {1U, 4U}) {
        Crew crew;
        std::atomic<int> done = 0;
        for (int i = 0; i < 20; ++i)
            crew.later([&] {
                for (int k = 0; k < 10; ++k) crew.next([&] { ++done; });
            });
        crew.run(threads);
        EXPECT_EQ(done, 200);
    }
}

TEST(Crew, DoesWhatIsNextBeforeWhatWaits) {
    Crew crew;
    std::vector<int> order;
    crew.later([&] {
        order.push_back(1);
        crew.next([&] { order.push_back(2); });
    });
    crew.later([&] { order.push_back(3); });
    crew.run(1);
    EXPECT_EQ(order, (std::vector{1, 2, 3}));
}

TEST(Crew, DropsTheRestAfterAFailure) {
    Crew crew;
    int done = 0;
    crew.later([&] { ++done; });
    crew.later([] { throw std::runtime_error("first"); });
    crew.later([&] { ++done; });
    EXPECT_THROW(crew.run(1), std::runtime_error);
    EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace corda::suite
