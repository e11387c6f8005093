#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "corda/media/write/video_file.hpp"
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

/// Writes a video of drawn frames, as one drawing thread does.
class VideoWriter {
  public:
    VideoWriter(const std::string& path, const VideoDef& def, std::int64_t frames,
                bool is_transparent = false, bool force = false)
        : video_(check_video_output({.path = path, .def = def, .end = frames, .force = force}, "",
                                    is_transparent)),
          file_(video_, {"A swing", R"({"scene":"test"})"}),
          maker_(video_.format, 0, {}) {}

    void write(const Image& frame, const Damage& damage) { file_.add(maker_.make(next_++, frame, damage)); }
    void write_whole(const Image& frame) { write(frame, {frame.rect()}); }
    void finish() { file_.commit(); }

  private:
    CheckedVideo video_;
    VideoFile file_;
    FrameMaker maker_;
    std::int64_t next_ = 0;
};

inline void write_frames(VideoWriter& writer, std::int64_t first, std::int64_t end) {
    for (std::int64_t k = first; k < end; ++k) writer.write(frame_image(k), {bob(k), bob(k - 1)});
}

inline void make_video(const std::string& path, const VideoDef& def, std::int64_t frames) {
    VideoWriter writer(path, def, frames, false, true);
    write_frames(writer, 0, frames);
    writer.finish();
}

/// Changes a byte of a file.
inline void damage(const std::string& path, std::size_t at) {
    std::string bytes = test::read_file(path);
    bytes.at(at) = static_cast<char>(bytes.at(at) ^ 1);
    test::write_file(path, bytes);
}

}  // namespace corda::media
