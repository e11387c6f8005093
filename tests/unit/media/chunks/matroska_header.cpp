#include "corda/media/chunks/track_output.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace corda::media {
namespace {

using namespace std::string_literals;

/// An element with a length of one byte.
std::string element(const std::string& id, const std::string& data) {
    return id + static_cast<char>(0x80U | data.size()) + data;
}

/// A file as a muxer of FFmpeg 5.1 leaves it, or with what FFmpeg 7.1 has in its header, without checksums.
std::string small_file(bool is_new) {
    const std::string room = is_new ? "\x55\xee\x81\0\xec\x01\0\0\0\0\0\0\x02\0\0"s : "";
    const std::string words = is_new ? "00:00:01\0"s : "00:00:01\0\0"s;
    const std::string tracks =
        element("\x16\x54\xae\x6b", element("\xae", "\xd7\x81\x01" + room + element("\x63\xa2", "private")));
    const std::string tags =
        element("\x12\x54\xc3\x67", element("\x73\x73", element("\x67\xc8", element("\x44\x87", words))));
    constexpr std::size_t kSeekHeadBytes = 5 + 3 + 3 + 4;
    const auto at = static_cast<char>(kSeekHeadBytes + tracks.size());
    const std::string seek_head =
        element("\x11\x4d\x9b\x74", element("\x4d\xbb", "\x53\xab\x80" + element("\x53\xac", {at})));
    EXPECT_EQ(seek_head.size(), kSeekHeadBytes);
    const std::string gap = is_new ? "" : "\xec\x01\0\0\0\0\0\0\x05\0\0\0\0\0"s;
    return element("\x1a\x45\xdf\xa3", "") + "\x18\x53\x80\x67\x01\0\0\0\0\0\x01\0"s + seek_head + tracks +
           tags + gap + element("\x1f\x43\xb6\x75", "cluster");
}

TEST(MatroskaHeader, BecomesTheNewerOne) {
    EXPECT_EQ(with_new_matroska_header(small_file(false)), small_file(true));
}

TEST(MatroskaHeader, OfAnotherStructureStaysAsItIs) {
    EXPECT_EQ(with_new_matroska_header("ftypisom"), "ftypisom");
    EXPECT_EQ(with_new_matroska_header(small_file(true)), small_file(true));
    const std::string old = small_file(false);
    const std::size_t room_end = old.find("\x1f\x43\xb6\x75");
    for (std::size_t bytes = 0; bytes < room_end; ++bytes)
        EXPECT_EQ(with_new_matroska_header(old.substr(0, bytes)), old.substr(0, bytes)) << bytes;
    for (std::size_t at = 0; at < old.size(); ++at) {
        for (const char bits : {'\x01', '\x10', '\x80', '\xff'}) {
            std::string changed = old;
            changed[at] = static_cast<char>(changed[at] ^ bits);
            EXPECT_EQ(with_new_matroska_header(changed).size(), changed.size()) << at;
        }
    }
}

}  // namespace
}  // namespace corda::media
