#include "corda/core/spool.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <numeric>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

constexpr std::size_t kSize = 100'000;
constexpr std::size_t kNoMemory = 0;

std::vector<double> read(const Spool& spool, std::size_t first, std::size_t count) {
    std::vector<double> values(count);
    spool.read(first, values);
    return values;
}

TEST(Spools, HoldTheSameInMemoryAndInAFile) {
    std::vector<double> numbers(kSize);
    std::iota(numbers.begin(), numbers.end(), 0.5);
    for (const std::size_t memory : {Spool::kMaxMemory, kNoMemory}) {
        Spool spool(kSize, memory);
        EXPECT_EQ(spool.is_in_file(), memory == kNoMemory);
        spool.write(0, std::span(numbers).first(10));
        spool.write(10, std::span(numbers).subspan(10));
        EXPECT_EQ(read(spool, 0, kSize), numbers);
        const std::vector<double> other{-1.0, -2.0};
        spool.write(7, other);
        EXPECT_EQ(read(spool, 6, 4), (std::vector<double>{6.5, -1.0, -2.0, 9.5}));
    }
}

TEST(Spools, MayBeReadByThreadsAtOnce) {
    std::vector<double> numbers(kSize);
    std::iota(numbers.begin(), numbers.end(), 0.0);
    Spool spool(kSize, kNoMemory);
    spool.write(0, numbers);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 3; ++t) {
        threads.emplace_back([&, t] {
            for (std::size_t i = t; i < 3000; i += 3) EXPECT_EQ(read(spool, i, 1).front(), numbers[i]);
        });
    }
    for (std::thread& thread : threads) thread.join();
}

TEST(Spools, NameTheFolderThatHasNoRoom) {
    const char* const before = std::getenv("TMPDIR");
    const std::string kept = before != nullptr ? before : "";
    ::setenv("TMPDIR", "/nowhere", 1);
    const test::Failure failure = test::failure_of([] { const Spool spool(kSize, kNoMemory); });
    before != nullptr ? ::setenv("TMPDIR", kept.c_str(), 1) : ::unsetenv("TMPDIR");
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, testing::HasSubstr("in '/nowhere': No such file"));
    // More than any disk has.
    EXPECT_EQ(test::failure_of([] { const Spool spool(std::size_t{1} << 56, kNoMemory); }).code,
              ExitCode::kIo);
}

}  // namespace
}  // namespace corda
