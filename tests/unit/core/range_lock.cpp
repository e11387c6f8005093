#include "corda/core/file.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

class RangeLocks : public testing::Test {
  protected:
    [[nodiscard]] std::string path() const { return folder_.path() + "/lock"; }
    [[nodiscard]] bool is_there() const { return std::filesystem::exists(path()); }

  private:
    test::ScratchFolder folder_;
};

TEST_F(RangeLocks, ExcludeOnlyTheSameNumbers) {
    std::optional<RangeLock> first(std::in_place, path(), 10, 20, "frames");
    const auto error = test::failure_of([&] { const RangeLock second(path(), 19, 30, "frames"); });
    EXPECT_EQ(error.code, ExitCode::kIo);
    EXPECT_EQ(error.message, "another render is writing frames; wait for its end, or choose another name");
    {
        const RangeLock before(path(), 0, 10, "frames");
        const RangeLock after(path(), 20, 30, "frames");
    }
    EXPECT_TRUE(is_there());  // that of the first lock
    first.reset();
    EXPECT_FALSE(is_there());
    const RangeLock again(path(), 19, 30, "frames");
}

TEST_F(RangeLocks, ReuseTheFileOfAKilledRender) {
    test::write_file(path(), "");
    { const RangeLock lock(path(), 0, 10, "frames"); }
    EXPECT_FALSE(is_there());
}

TEST_F(RangeLocks, OfOtherNumbersAreIndependent) {
    // While one thread removes the file, others open it.
    std::atomic<int> failures = 0;
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 2000; ++i) {
                try {
                    const RangeLock lock(path(), 10 * t, 10 * t + 10, "frames");
                    if (!is_there()) ++failures;
                } catch (const Error&) {
                    ++failures;
                }
            }
        });
    }
    threads.clear();
    EXPECT_EQ(failures, 0);
    EXPECT_FALSE(is_there());
}

TEST_F(RangeLocks, OfTheSameNumbersAreExclusive) {
    std::atomic<int> holders = 0;
    std::atomic<int> met = 0;
    std::atomic<int> held = 0;
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 2000; ++i) {
                try {
                    const RangeLock lock(path(), t, 10, "frames");  // all hold 3 to 9
                    if (++holders > 1) ++met;
                    ++held;
                    --holders;
                } catch (const Error&) {
                }
            }
        });
    }
    threads.clear();
    EXPECT_EQ(met, 0);
    EXPECT_GT(held, 0);
    EXPECT_FALSE(is_there());
}

}  // namespace
}  // namespace corda
