#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/chunks/video_writer.hpp"
#include "corda/media/verify/verify.hpp"
#include "support/command.hpp"

namespace corda::media {

inline constexpr int kWidth = 320;
inline constexpr int kHeight = 180;

/// A test with a folder for its videos.
class Video : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    test::ScratchFolder folder_;
};

inline void fill(Image& image, const PixelRect& rect, std::array<std::uint8_t, 3> rgb) {
    const PixelRect inside = rect.intersected(image.rect());
    for (int y = inside.y0; y < inside.y1; ++y) {
        for (int x = inside.x0; x < inside.x1; ++x) {
            std::copy(rgb.begin(), rgb.end(), image.pixel(x, y));
            image.pixel(x, y)[3] = 255;
        }
    }
}

struct Patch {
    PixelRect rect;
    std::array<std::uint8_t, 3> rgb{};
};
inline const std::array<Patch, 4> patches{{{{16, 16, 64, 64}, {255, 0, 0}},
                                           {{80, 16, 128, 64}, {0, 255, 0}},
                                           {{144, 16, 192, 64}, {0, 0, 255}},
                                           {{208, 16, 256, 64}, {128, 128, 128}}}};

/// The patches on a dark ground.
inline Image background() {
    Image image(kWidth, kHeight);
    fill(image, image.rect(), {18, 22, 30});
    for (const Patch& patch : patches) fill(image, patch.rect, patch.rgb);
    return image;
}

/// The place of the moving square in frame `frame`.
inline PixelRect bob(std::int64_t frame) {
    const int x = 140 + static_cast<int>(std::lround(100 * std::sin(static_cast<double>(frame) * 0.2)));
    return {x, 100, x + 21, 121};
}

inline Image frame_image(std::int64_t frame) {
    Image image = background();
    fill(image, bob(frame), {240, 200, 90});
    return image;
}

inline VideoDef small_video(Rational fps = {60, 1}) {
    VideoDef def;
    def.width_px = kWidth;
    def.height_px = kHeight;
    def.fps = FrameRate(fps);
    return def;
}

inline void write_frames(VideoWriter& writer, std::int64_t frames) {
    for (std::int64_t k = 0; k < frames; ++k) {
        writer.write(frame_image(k), k == 0 ? Damage{{0, 0, kWidth, kHeight}} : Damage{bob(k), bob(k - 1)});
    }
}

inline void make_video(const std::string& path, const VideoDef& def, std::int64_t frames) {
    VideoWriter writer(path, def, {"A swing", R"({"scene":"test"})"}, {.force = true});
    write_frames(writer, frames);
    EXPECT_EQ(writer.frames(), frames);
    writer.finish();
}

/// Leaves the part file of a video that was not finished.
inline void abandon_video(const std::string& path, const VideoDef& def, std::int64_t frames) {
    VideoWriter writer(path, def, {"A swing", "{}"}, {.force = true});
    write_frames(writer, frames);
    EXPECT_EQ(writer.abandon(), path + ".part");
}

/// Decode times of a fragment that no video has and that libav lets pass.
inline constexpr std::array<std::uint64_t, 3> kDamagedStamps{0x7000'0000'0000'0000, 0x4000'0000'0000'0000,
                                                             0x1000'0000'0000'0100};

/// The part file with checksums that are right again.
inline std::string with_checksums(std::string part) {
    constexpr std::string_view kMark =
        "\xc3"
        "corda checksum\n";
    std::size_t from = 0;
    for (std::size_t at = part.find(kMark); at != std::string::npos; at = part.find(kMark, from)) {
        PartChecksum checksum;
        checksum.add(std::string_view(part).substr(from, at - from));
        const std::string record = checksum.record();
        part.replace(at, record.size(), record);
        from = at + record.size();
    }
    return part;
}

/// How many fragments say when their decoding starts.
inline int decode_times_in(const std::string& part) {
    int count = 0;
    for (std::size_t at = part.find("tfdt"); at != std::string::npos; at = part.find("tfdt", at + 4)) ++count;
    return count;
}

/// The part file with another decode time, 64 bits wide, of a fragment.
inline std::string with_decode_time(std::string part, int fragment, std::uint64_t ticks) {
    std::size_t at = part.find("tfdt");
    for (int i = 0; i < fragment; ++i) at = part.find("tfdt", at + 4);
    EXPECT_EQ(part[at + 4], 1) << "the decode time is not 64 bits wide";
    for (std::size_t i = 0; i < 8; ++i) part[at + 8 + i] = static_cast<char>(ticks >> (56 - 8 * i));
    return with_checksums(part);
}

inline std::string all_problems(const VerifyReport& report) {
    std::string text;
    for (const auto& line : report.problems) text += line + "\n";
    return text;
}

}  // namespace corda::media
