#include "corda/media/read/containers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/core/basics.hpp"
#include "support/command.hpp"

namespace corda::media {
namespace {

/// `value` as big-endian bytes.
std::string number(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i) & 0xffU);
    return text;
}

std::string u32(std::uint64_t value) {
    return number(value, 4);
}

std::string u64(std::uint64_t value) {
    return number(value, 8);
}

/// ISO/IEC 14496-12 section 4.2: size, type, payload.
std::string box(const std::string& type, const std::string& payload) {
    return u32(8 + payload.size()) + type + payload;
}

/// The same with a 64-bit size.
std::string long_box(const std::string& type, const std::string& payload) {
    return u32(1) + type + u64(16 + payload.size()) + payload;
}

/// Version and flags of a full box.
std::string version(unsigned number_of) {
    return number(number_of, 1) + number(0, 3);
}

/// The beginning of mvhd and mdhd: version, creation and modification times, time scale, duration.
std::string clock32(std::uint64_t timescale, std::uint64_t duration) {
    return version(0) + u32(11) + u32(22) + u32(timescale) + u32(duration);
}
std::string clock64(std::uint64_t timescale, std::uint64_t duration) {
    return version(1) + u64(11) + u64(22) + u32(timescale) + u64(duration);
}

/// tkhd: version, times, track number, reserved, duration.
std::string track_header32(std::uint64_t duration) {
    return box("tkhd", version(0) + u32(11) + u32(22) + u32(1) + u32(0) + u32(duration));
}
std::string track_header64(std::uint64_t duration) {
    return box("tkhd", version(1) + u64(11) + u64(22) + u32(1) + u32(0) + u64(duration));
}

std::string edit_list(const std::string& payload) {
    return box("edts", box("elst", payload));
}

std::string track(const std::string& inner) {
    return box("trak", inner);
}

const std::string kFtyp = box("ftyp", "isom");
const std::string kMdat = box("mdat", "picture data");
const std::string kMoov = box("moov", box("mvhd", clock32(600, 1200)) + track(track_header32(1200)));

Mp4Boxes boxes_of(const std::string& bytes) {
    const test::ScratchFolder folder;
    return read_mp4_boxes(folder.write("a.mp4", bytes));
}

TEST(Mp4Boxes, ReadsAPlainFile) {
    const Mp4Boxes boxes = boxes_of(
        kFtyp +
        box("moov", box("mvhd", clock32(30000, 60060)) +
                        track(track_header32(60060) +
                              box("mdia", box("hdlr", "video") + box("mdhd", clock32(90000, 180180))))) +
        kMdat);
    EXPECT_TRUE(boxes.is_mp4);
    EXPECT_TRUE(boxes.whole);
    EXPECT_TRUE(boxes.has_index);
    EXPECT_TRUE(boxes.index_first);
    EXPECT_FALSE(boxes.fragmented);
    EXPECT_EQ(boxes.tracks, 1);
    EXPECT_EQ(boxes.movie_timescale, 30000U);
    EXPECT_EQ(boxes.movie_duration, 60060U);
    EXPECT_EQ(boxes.track_presentation, 60060U);
    EXPECT_EQ(boxes.track_timescale, 90000U);
    EXPECT_EQ(boxes.track_duration, 180180U);
    EXPECT_THAT(boxes.edits, testing::IsEmpty());
}

TEST(Mp4Boxes, ReadsVersionOneWith64BitTimes) {
    constexpr std::uint64_t kLong = std::uint64_t{5} << 33U;
    const Mp4Boxes boxes =
        boxes_of(kFtyp + box("moov", box("mvhd", clock64(600, kLong)) +
                                         track(track_header64(kLong + 1) +
                                               box("mdia", box("mdhd", clock64(90000, kLong + 2))))));
    EXPECT_EQ(boxes.movie_timescale, 600U);
    EXPECT_EQ(boxes.movie_duration, kLong);
    EXPECT_EQ(boxes.track_presentation, kLong + 1);
    EXPECT_EQ(boxes.track_timescale, 90000U);
    EXPECT_EQ(boxes.track_duration, kLong + 2);
}

TEST(Mp4Boxes, SeesWhichOfIndexAndDataComesFirst) {
    EXPECT_TRUE(boxes_of(kFtyp + kMoov + kMdat).index_first);
    EXPECT_FALSE(boxes_of(kFtyp + kMdat + kMoov).index_first);
    EXPECT_TRUE(boxes_of(kFtyp + kMdat + kMoov).has_index);
}

TEST(Mp4Boxes, Follows64BitSizes) {
    const std::string movie = box("mvhd", clock32(600, 1200)) + long_box("trak", track_header32(7));
    const Mp4Boxes boxes = boxes_of(kFtyp + long_box("mdat", "data") + long_box("moov", movie));
    EXPECT_TRUE(boxes.whole);
    EXPECT_TRUE(boxes.has_index);
    EXPECT_EQ(boxes.movie_timescale, 600U);
    EXPECT_EQ(boxes.track_presentation, 7U);
}

TEST(Mp4Boxes, ASizeOfZeroReachesToTheEnd) {
    const Mp4Boxes boxes = boxes_of(kFtyp + kMoov + u32(0) + "mdat" + std::string(1000, 'x'));
    EXPECT_TRUE(boxes.whole);
    const std::string last_track = u32(0) + "trak" + track_header32(7);
    EXPECT_EQ(boxes_of(kFtyp + box("moov", last_track)).track_presentation, 7U);
}

TEST(Mp4Boxes, BadSizesEndTheReading) {
    // Smaller than their own header, or larger than what holds them.
    for (const std::string& bad : {u32(7) + "free", u32(1) + "free" + u64(15), u32(1) + "free" + u64(~0ULL),
                                   u32(0xffffffff) + "free", u32(2) + "free", u32(9) + "free"}) {
        const Mp4Boxes outer = boxes_of(kFtyp + bad);
        EXPECT_TRUE(outer.is_mp4);
        EXPECT_FALSE(outer.whole);
        const Mp4Boxes inner = boxes_of(kFtyp + box("moov", box("mvhd", clock32(600, 1)) + bad + track("")));
        EXPECT_TRUE(inner.whole);
        EXPECT_EQ(inner.movie_timescale, 600U);
        EXPECT_EQ(inner.tracks, 0);
        EXPECT_FALSE(inner.has_index);
    }
}

TEST(Mp4Boxes, ATruncatedFileIsNotWhole) {
    const std::string file = kFtyp + kMoov + kMdat;
    for (std::size_t length = 0; length < file.size(); ++length) {
        const Mp4Boxes boxes = boxes_of(file.substr(0, length));
        const bool at_a_border = length == kFtyp.size() || length == kFtyp.size() + kMoov.size();
        EXPECT_EQ(boxes.whole, at_a_border) << length;
        EXPECT_EQ(boxes.is_mp4, length >= 8) << length;
        EXPECT_EQ(boxes.has_index, length >= kFtyp.size() + kMoov.size()) << length;
        EXPECT_EQ(boxes.file_bytes, length);
    }
}

TEST(Mp4Boxes, TruncatedFieldsAreZero) {
    const std::string header = clock32(600, 1200);
    for (std::size_t length = 0; length < header.size(); ++length) {
        const Mp4Boxes boxes = boxes_of(kFtyp + box("moov", box("mvhd", header.substr(0, length))));
        EXPECT_EQ(boxes.movie_timescale, length >= 16 ? 600U : 0U) << length;
        EXPECT_EQ(boxes.movie_duration, 0U) << length;
    }
}

TEST(Mp4Boxes, OtherFilesAreNoMp4) {
    for (const std::string& bytes :
         {std::string(), std::string("text"), kMoov + kFtyp, std::string(100, '\0')}) {
        const Mp4Boxes boxes = boxes_of(bytes);
        EXPECT_FALSE(boxes.is_mp4);
        EXPECT_FALSE(boxes.whole);
        EXPECT_FALSE(boxes.has_index);
    }
    EXPECT_THROW(static_cast<void>(read_mp4_boxes("/no/such/file")), Error);
}

TEST(Mp4Boxes, ReadsEditLists) {
    const std::string short_entries = version(0) + u32(2) + u32(500) + u32(0xffffffff) + u32(0x10000) +
                                      u32(1200) + u32(1002) + u32(0x10000);
    std::vector<Mp4Edit> edits = boxes_of(kFtyp + box("moov", track(edit_list(short_entries)))).edits;
    ASSERT_EQ(edits.size(), 2U);
    EXPECT_EQ(edits[0].duration, 500U);
    EXPECT_EQ(edits[0].media_time, -1);  // an empty edit
    EXPECT_EQ(edits[1].duration, 1200U);
    EXPECT_EQ(edits[1].media_time, 1002);

    const std::string long_entries = version(1) + u32(2) + u64(std::uint64_t{1} << 40U) +
                                     u64(~std::uint64_t{0}) + u32(0x10000) + u64(3) +
                                     u64(std::uint64_t{1} << 41U) + u32(0x10000);
    edits = boxes_of(kFtyp + box("moov", track(edit_list(long_entries)))).edits;
    ASSERT_EQ(edits.size(), 2U);
    EXPECT_EQ(edits[0].duration, std::uint64_t{1} << 40);
    EXPECT_EQ(edits[0].media_time, -1);
    EXPECT_EQ(edits[1].duration, 3);
    EXPECT_EQ(edits[1].media_time, std::int64_t{1} << 41);
}

TEST(Mp4Boxes, AnEditListHoldsAsManyEntriesAsItHasBytesFor) {
    const std::string promise = version(0) + u32(0xffffffff) + u32(500) + u32(7) + u32(0x10000) + u32(600);
    const std::vector<Mp4Edit> edits = boxes_of(kFtyp + box("moov", track(edit_list(promise)))).edits;
    ASSERT_EQ(edits.size(), 1U);
    EXPECT_EQ(edits[0].media_time, 7);
}

TEST(Mp4Boxes, DescribesTheFirstTrackAndCountsAll) {
    const Mp4Boxes boxes =
        boxes_of(kFtyp + box("moov", track(track_header32(1)) + track(track_header32(2)) + track("")));
    EXPECT_EQ(boxes.tracks, 3);
    EXPECT_EQ(boxes.track_presentation, 1U);
}

TEST(Mp4Boxes, OfTwoIndexesTheFirstCounts) {
    const Mp4Boxes boxes = boxes_of(kFtyp + kMoov + kMdat + box("moov", track(track_header32(7))));
    EXPECT_EQ(boxes.track_presentation, 1200U);
    EXPECT_TRUE(boxes.index_first);
    EXPECT_EQ(boxes.tracks, 1);
}

TEST(Mp4Boxes, RecognisesFragments) {
    EXPECT_TRUE(boxes_of(kFtyp + box("moov", track("") + box("mvex", ""))).fragmented);
    EXPECT_TRUE(boxes_of(kFtyp + kMoov + box("moof", "") + kMdat).fragmented);
    // One that breaks off in its header is one, too.
    EXPECT_TRUE(boxes_of(kFtyp + kMoov + box("moof", "header").substr(0, 8)).fragmented);
}

}  // namespace
}  // namespace corda::media
