#include "corda/sweep/archive.hpp"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "support/command.hpp"

namespace corda::sweep {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string tar_of(const std::vector<std::pair<std::string, std::string>>& entries) {
    std::string bytes;
    for (const auto& [name, content] : entries) bytes += tar_entry(name, content);
    return bytes + tar_end();
}

/// Fields of the head of an entry: POSIX.1-1988, "ustar".
TEST(Archive, TarIsUstarWithoutOwnerAndTime) {
    const std::string tar = tar_of({{"000000.json", "{}\n"}, {"000000.npz", std::string(513, 'x')}});
    ASSERT_EQ(tar.size(), 512U * (1 + 1 + 1 + 2 + 2));
    for (const std::size_t head : {0U, 1024U}) {
        EXPECT_EQ(tar.substr(head + 100, 7), "000644 ");        // mode
        EXPECT_EQ(tar.substr(head + 108, 7), "000000 ");        // user
        EXPECT_EQ(tar.substr(head + 116, 7), "000000 ");        // group
        EXPECT_EQ(tar.substr(head + 136, 12), "00000000000 ");  // time
        EXPECT_EQ(tar[head + 156], '0');                        // ordinary file
        EXPECT_EQ(tar.substr(head + 257, 8), std::string("ustar\00000", 8));
        EXPECT_EQ(tar.substr(head + 265, 64), std::string(64, '\0'));  // names of user and group
    }
    EXPECT_THAT(tar, StartsWith(std::string("000000.json\0", 12)));
    EXPECT_EQ(tar.substr(124, 12), "00000000003 ");
    EXPECT_EQ(tar.substr(512, 512), "{}\n" + std::string(509, '\0'));
    EXPECT_EQ(tar.substr(1024 + 124, 12), "00000001001 ");
    EXPECT_EQ(tar.substr(tar.size() - 1024), std::string(1024, '\0'));
}

TEST(Archive, OtherProgramsReadTheTar) {
    const test::ScratchFolder folder;
    const std::string path = folder.write("a.tar", tar_of({{"b.mp4", "bytes"}, {"a.json", ""}}));
    const auto listed = test::run_shell("TZ=UTC tar -tvf " + path);
    EXPECT_EQ(listed.out,
              "-rw-r--r-- 0/0               5 1970-01-01 00:00 b.mp4\n"
              "-rw-r--r-- 0/0               0 1970-01-01 00:00 a.json\n");
    EXPECT_EQ(test::run_shell("tar -xOf " + path + " b.mp4").out, "bytes");
}

/// The array "a" of an .npz file that has no compressed one.
std::string npy_of(const Array& array) {
    const std::string npz = npz_bytes({array});
    const std::size_t begin = npz.find("\x93NUMPY");
    const std::size_t head = 10U + static_cast<unsigned char>(npz[begin + 8]);
    return npz.substr(begin, head + array.data.size());
}

/// NumPy enhancement proposal 1, version 1.0.
TEST(Npz, ArraysHaveTheHeadOfNumpy) {
    const std::string numbers(16, '\x42');
    struct {
        std::vector<std::int64_t> shape;
        std::string text;
    } const cases[] = {{{2}, "(2,)"}, {{1, 2}, "(1, 2)"}, {{1, 1, 2}, "(1, 1, 2)"}};
    for (const auto& [shape, text] : cases) {
        const std::string npy = npy_of({"a", false, shape, numbers});
        EXPECT_THAT(npy, StartsWith(std::string("\x93NUMPY\1\0", 8)));
        EXPECT_EQ((npy.size() - 16) % 64, 0U);
        EXPECT_EQ(npy[npy.size() - 17], '\n');
        EXPECT_THAT(npy.substr(10),
                    StartsWith("{'descr': '<f8', 'fortran_order': False, 'shape': " + text + ", }"));
        EXPECT_THAT(npy, testing::EndsWith(numbers));
    }
}

TEST(Npz, HeadsOfEveryLengthAreWholeBlocks) {
    std::set<std::size_t> lengths;
    for (std::int64_t number = 10; number < 100'000'000'000'000'000; number *= 10) {
        const std::string npy = npy_of({"a", false, {number, number, number, number}, ""});
        EXPECT_EQ(npy.size() % 64, 0U) << number;
        EXPECT_EQ(npy.back(), '\n') << number;
        lengths.insert(npy.size());
    }
    EXPECT_EQ(lengths.size(), 2U);
}

TEST(Npz, BytesAreCompressedAndNumbersAreNot) {
    const std::string data(8000, 'x');
    const std::string npz = npz_bytes({{"mask", true, {1, 80, 100}, data}, {"times", false, {1000}, data}});
    EXPECT_THAT(npz, HasSubstr("mask.npy"));
    EXPECT_THAT(npz, HasSubstr("times.npy"));
    EXPECT_THAT(npz, HasSubstr(data));
    EXPECT_LT(npz.size(), 9000U);
}

}  // namespace
}  // namespace corda::sweep
