#include "corda/media/read/containers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/media/format/file_kind.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

TEST_F(Video, BreaksOffIfAnyOfItsLastBytesIsMissing) {
    for (const char* const ending : {".gif", ".webm", ".mkv"}) {
        const std::string path = file(std::string("a") + ending);
        make_video(path, small_video({50, 1}), 3);
        EXPECT_FALSE(is_truncated(path, file_kind(path))) << ending;
        const std::string whole = test::read_file(path);
        for (const std::size_t missing : std::vector<std::size_t>{1, 2, 11, 12, 13, 100, whole.size() / 2}) {
            const std::string cut = file("cut");
            test::write_file(cut, whole.substr(0, whole.size() - missing));
            EXPECT_TRUE(is_truncated(cut, file_kind(cut))) << ending << ' ' << missing;
            EXPECT_FALSE(verify(cut).ok()) << ending << ' ' << missing;
        }
        for (std::size_t length = 32; length < 200; ++length) {
            test::write_file(file("cut"), whole.substr(0, length));
            EXPECT_TRUE(is_truncated(file("cut"), file_kind(path))) << ending << ' ' << length;
        }
        test::write_file(file("more"), whole + "more");
        EXPECT_FALSE(is_truncated(file("more"), file_kind(path))) << ending;
    }
}

TEST_F(Video, OfPlainFramesBreaksOffInOne) {
    for (const auto& [colors, bytes] :
         {std::pair("C420mpeg2 XYSCSS=420MPEG2", 6 * 4 * 3 / 2), std::pair("C444", 72)}) {
        const std::string frame = "FRAME\n" + std::string(static_cast<std::size_t>(bytes), 'x');
        const std::string whole = std::string("YUV4MPEG2 W6 H4 F25:1 Ip ") + colors + "\n" + frame + frame;
        test::write_file(file("a.y4m"), whole);
        EXPECT_FALSE(is_truncated(file("a.y4m"), file_kind(file("a.y4m"))));
        for (const std::size_t missing :
             {std::size_t{1}, std::size_t{20}, frame.size() - 1, frame.size() + 1}) {
            test::write_file(file("a.y4m"), whole.substr(0, whole.size() - missing));
            EXPECT_TRUE(is_truncated(file("a.y4m"), file_kind(file("a.y4m")))) << missing;
        }
    }
    test::write_file(file("a.y4m"), "YUV4MPEG2 W6 H4 F25:1 C444p16\nFRAME\nx");  // another form
    EXPECT_FALSE(is_truncated(file("a.y4m"), file_kind(file("a.y4m"))));
}

TEST_F(Video, DoesNotBreakOffIfItTellsNoLength) {
    // What a muxer writes to a pipe: the segment's length is unknown.
    const std::string head = std::string("\x1a\x45\xdf\xa3\x84") + "data" + "\x18\x53\x80\x67";
    const std::string unknown = "\x01\xff\xff\xff\xff\xff\xff\xff";
    for (const auto& [length, breaks] : {std::pair(unknown, false), std::pair(std::string("\x84"), false),
                                         std::pair(std::string("\x85"), true)}) {
        test::write_file(file("a"), head + length + "data");
        EXPECT_EQ(is_truncated(file("a"), "matroska"), breaks);
    }
    EXPECT_FALSE(is_truncated(file("a"), "mov"));
}

}  // namespace
}  // namespace corda::media
