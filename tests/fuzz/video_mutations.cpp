// Hundreds of damaged videos, the same on every run: each gives a report within a limited time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>

#include "corda/media/chunks/video_writer.hpp"
#include "corda/media/verify/verify.hpp"
#include "support/command.hpp"

namespace corda::media {
namespace {

/// std::mt19937 is the same everywhere; the standard distributions are not.
class Mutator {
  public:
    explicit Mutator(std::uint32_t seed) : random_(seed) {}

    std::string damaged(std::string bytes) {
        const std::size_t count = 1 + below(6);
        for (std::size_t i = 0; i < count && !bytes.empty(); ++i) mutate(bytes);
        return bytes;
    }

  private:
    std::size_t below(std::size_t count) { return random_() % count; }

    void mutate(std::string& bytes) {
        const std::size_t at = below(bytes.size());
        switch (below(8)) {
            case 0:
                bytes.erase(at, 1 + below(8));
                break;
            case 1:
                bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(60)));
                break;
            case 2:
                put_number(bytes, at);
                break;
            case 3:
                if (below(8) == 0) bytes.resize(at);
                break;
            case 4:
                bytes[at] = static_cast<char>(below(256));
                break;
            default:
                bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << below(8)));
                break;
        }
    }

    /// Replaces a big-endian number, as in MP4 boxes, by an extreme one.
    void put_number(std::string& bytes, std::size_t at) {
        constexpr std::array<std::uint32_t, 6> kHard{0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x4000};
        const std::uint32_t number = kHard[below(kHard.size())];
        for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
            bytes[at + i] = static_cast<char>(number >> (24 - 8 * i));
    }

    std::mt19937 random_;
};

class VideoMutations : public testing::Test {
  protected:
    /// A video of a moving square.
    std::string corda_video() {
        VideoDef def;
        def.width_px = 64;
        def.height_px = 48;
        def.fps = FrameRate({25, 1});
        VideoWriter writer(folder_.file("a.mp4"), def, {"A square", "{}"}, {.force = true});
        for (int k = 0; k < 10; ++k) {
            Image image(def.width_px, def.height_px);
            for (int y = 16; y < 32; ++y) std::fill_n(image.pixel(4 * k, y), 64, std::uint8_t{255});
            writer.write(image, {image.rect()});
        }
        writer.finish();
        return test::read_file(folder_.file("a.mp4"));
    }

    std::string mpeg4_video() {
        const std::string path = folder_.file("b.mp4");
        const auto made = test::run_shell(
            "ffmpeg -v error -f lavfi -i testsrc=size=64x48:rate=25:duration=0.4 -c:v mpeg4 -bf 2 " + path);
        EXPECT_EQ(made.exit_code, 0) << made.err;
        return test::read_file(path);
    }

    /// Verifies damaged copies; returns the number that `verify` accepts, and counts crashes.
    int sound_copies(const std::string& video, std::uint32_t runs) {
        int sound = 0;
        for (std::uint32_t seed = 0; seed < runs; ++seed) {
            test::write_file(folder_.file("c.mp4"), Mutator(seed).damaged(video));
            const VerifyReport report = verify_in_child(folder_.file("c.mp4"));
            sound += report.ok() ? 1 : 0;
            const auto crash = [](const std::string& text) { return text.starts_with("decoding crashed"); };
            crashes_ += std::any_of(report.problems.begin(), report.problems.end(), crash) ? 1 : 0;
        }
        return sound;
    }

    test::ScratchFolder folder_;
    int crashes_ = 0;
};

TEST_F(VideoMutations, GiveAReport) {
    // Accepted: damage in data that no player reads, such as the name of the encoder or the last bits of a
    // picture.
    EXPECT_LT(sound_copies(corda_video(), 200), 60);  // measured: 29
    EXPECT_EQ(crashes_, 0);
}

TEST_F(VideoMutations, OfMpeg4Part2GiveAReport) {
    EXPECT_EQ(sound_copies(mpeg4_video(), 200), 0);
    // libav 5.1 ends the process by an assertion at 21 of them.
    RecordProperty("crashes", crashes_);
}

}  // namespace
}  // namespace corda::media
