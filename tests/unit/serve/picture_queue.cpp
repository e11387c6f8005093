#include "corda/serve/picture_queue.hpp"

#include <gmock/gmock.h>

#include <string>

namespace corda::serve {
namespace {

constexpr std::int64_t kFrames = 10;

Picture picture_of(std::size_t bytes) {
    return {std::string(bytes, 'p'), {}};
}

/// The frames that the queue draws, one after the other.
std::vector<std::int64_t> drawn_by(PictureQueue& queue, std::size_t bytes) {
    std::vector<std::int64_t> frames;
    for (auto next = queue.next(); next; next = queue.next()) {
        frames.push_back(*next);
        queue.keep(*next, picture_of(bytes));
    }
    return frames;
}

TEST(PictureQueue, DrawsOnFromThePlayhead) {
    PictureQueue queue(kFrames, 1000, 7);
    EXPECT_THAT(drawn_by(queue, 1), testing::ElementsAre(7, 8, 9, 0, 1, 2, 3, 4, 5, 6));
    EXPECT_EQ(PictureQueue(kFrames, 1000, 99).playhead(), 9);
}

TEST(PictureQueue, DrawsAwaitedFramesFirst) {
    PictureQueue queue(kFrames, 1000, 0);
    queue.await(8);
    queue.await(4);
    EXPECT_EQ(queue.next(), 4);  // the playhead
    queue.keep(4, picture_of(1));
    EXPECT_EQ(queue.next(), 8);
    queue.leave(8);
    EXPECT_EQ(queue.next(), 5);
}

TEST(PictureQueue, KeepsWhatIsPlayedNext) {
    PictureQueue queue(kFrames, 40, 0);
    EXPECT_THAT(drawn_by(queue, 10), testing::ElementsAre(0, 1));  // half of the room
    queue.await(2);
    queue.await(5);
    queue.keep(2, picture_of(10));
    queue.keep(5, picture_of(10));
    queue.keep(6, picture_of(10));
    EXPECT_EQ(queue.find(1), nullptr);  // behind the playhead, and so played last
    EXPECT_NE(queue.find(5), nullptr);
    EXPECT_NE(queue.find(6), nullptr);
}

TEST(PictureQueue, KeepsAnAwaitedPictureHoweverLargeItIs) {
    PictureQueue queue(kFrames, 1, 0);
    queue.await(3);
    queue.await(4);
    queue.keep(3, picture_of(10));
    queue.keep(4, picture_of(10));
    EXPECT_NE(queue.find(3), nullptr);
    EXPECT_NE(queue.find(4), nullptr);
}

}  // namespace
}  // namespace corda::serve
