// Videos and stills of the program, read back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "corda/film/film.hpp"
#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/decode_video.hpp"
#include "support/image_matchers.hpp"
#include "support/yuv420_image.hpp"

namespace corda {
namespace {

// ITU-R BT.709-6, item 3.2.
constexpr double kRed = 0.2126;
constexpr double kBlue = 0.0722;
constexpr double kGreen = 1.0 - kRed - kBlue;

/// R'G'B' (0..255, not rounded) of the BT.709 limited-range picture at pixel (x, y), in double precision.
std::array<double, 3> rgb_at(const test::Yuv420Image& picture, int x, int y) {
    const auto sample = [&](int plane, int px, int py) {
        return static_cast<double>(picture.plane(plane)[py * picture.plane_width(plane) + px]);
    };
    return media::rgb_from_ycbcr(sample(0, x, y), sample(1, x / 2, y / 2), sample(2, x / 2, y / 2));
}

/// Peak signal-to-noise ratio of the luma planes in dB: the decoded picture's against the rendered one's,
/// computed in double precision and rounded to 8 bits.
double luma_psnr_db(const test::Yuv420Image& decoded, const Image& rendered) {
    double squares = 0.0;
    for (int y = 0; y < rendered.height(); ++y) {
        for (int x = 0; x < rendered.width(); ++x) {
            const std::uint8_t* rgb = rendered.pixel(x, y);
            const double luma = 16.0 + 219.0 * (kRed * rgb[0] + kGreen * rgb[1] + kBlue * rgb[2]) / 255.0;
            const double difference = std::round(luma) - decoded.plane(0)[y * decoded.width() + x];
            squares += difference * difference;
        }
    }
    if (squares == 0.0) return std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(255.0 * 255.0 * rendered.width() * rendered.height() / squares);
}

using nlohmann::json;
using test::run_corda;
using test::ScratchFolder;
using testing::HasSubstr;

const char* const kSceneOfVideo = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 20, length = 1.0, angle_deg = 60.0 }
[solver]
method = "relaxation"
step = 0.005
reach = 1
sweeps = 30
[video]
size = [320, 180]
fps = 30
)";

/// Wide bars of one colour each, all pinned, on grey: patches with known decoded colours.
const char* const kPatches = R"(schema = 1
[world]
duration = 0.5
[[rope]]
points = [[0.0, 3.0], [8.0, 3.0]]
pinned = [0, 1]
color = "#ff0000"
[[rope]]
points = [[0.0, 2.0], [8.0, 2.0]]
pinned = [0, 1]
color = "#00ff00"
[[rope]]
points = [[0.0, 1.0], [8.0, 1.0]]
pinned = [0, 1]
color = "#0000ff"
[style]
background = "#808080"
rope_width_px = 40.0
markers = "none"
[camera]
center = [4.0, 2.0]
height = 5.0
[video]
size = [640, 360]
fps = 30
)";

/// Environments with several numbers of llvmpipe threads. These occasionally crash LeakSanitizer at exit, so
/// only the other tests look for leaks.
std::vector<std::string> thread_counts() {
    return {"", "ASAN_OPTIONS=detect_leaks=0 LP_NUM_THREADS=0",
            "ASAN_OPTIONS=detect_leaks=0 LP_NUM_THREADS=1", "ASAN_OPTIONS=detect_leaks=0 LP_NUM_THREADS=2"};
}

class Video : public testing::Test {
  protected:
    ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfVideo);
    std::string video_ = folder_.file("out.mp4");
};

TEST_F(Video, LeavesNothingButTheVideo) {
    ASSERT_EQ(run_corda({"render", scene_, "-o", video_}).exit_code, 0);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"out.mp4", "scene.toml"}));
}

TEST_F(Video, KeepsPureColoursAndTheFirstFrame) {
    const std::string patches = folder_.write("patches.toml", kPatches);
    ASSERT_EQ(run_corda({"render", patches, "-o", video_}).exit_code, 0);
    ASSERT_EQ(run_corda({"still", patches, "--frame", "0", "-o", folder_.file("first.png")}).exit_code, 0);
    const test::DecodedFrames decoded = test::decode_video(video_);
    ASSERT_EQ(decoded.pictures.size(), 15U);
    struct Patch {
        int y;
        std::array<double, 3> rgb;
    };
    // The middles of the ropes, at 72 px per metre, and the grey between the picture's edge and the first
    // one.
    for (const Patch& patch : {Patch{108, {255, 0, 0}}, Patch{180, {0, 255, 0}}, Patch{252, {0, 0, 255}},
                               Patch{40, {128, 128, 128}}}) {
        const std::array<double, 3> rgb = rgb_at(decoded.pictures[0], 320, patch.y);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(rgb[c], patch.rgb[c], 2.0) << "row " << patch.y << " channel " << c;
    }
    EXPECT_GE(luma_psnr_db(decoded.pictures[0], read_png(folder_.file("first.png"))), 40.0);
}

TEST_F(Video, KeepsTheFirstFrameOfAMovingRope) {
    ASSERT_EQ(run_corda({"render", scene_, "-o", video_}).exit_code, 0);
    ASSERT_EQ(run_corda({"still", scene_, "--frame", "0", "-o", folder_.file("first.png")}).exit_code, 0);
    const test::DecodedFrames decoded = test::decode_video(video_);
    EXPECT_GE(luma_psnr_db(decoded.pictures[0], read_png(folder_.file("first.png"))), 40.0);
}

TEST_F(Video, HasTheSameBytesOnEveryRunAndThreadCount) {
    std::vector<std::string> videos;
    for (const std::string& threads : thread_counts()) {
        ASSERT_EQ(run_corda({"render", scene_, "-o", video_, "--force"}, threads).exit_code, 0);
        videos.push_back(test::read_file(video_));
        EXPECT_EQ(videos.back(), videos.front()) << threads;
    }
}

TEST_F(Video, DoesNotDependOnUninitialisedMemory) {
    // Rows of 30, 40 and 45 macroblocks. glibc fills allocated memory with the complement of the number.
    for (const char* const size : {"480x270", "640x360", "720x400"}) {
        std::set<std::string> kinds;
        for (const char* const memory :
             {"", "MALLOC_PERTURB_=1", "MALLOC_PERTURB_=2", "MALLOC_PERTURB_=128"}) {
            const auto result = run_corda({"render", CORDA_EXAMPLES "/first.toml", "--duration", "1",
                                           "--size", size, "-o", video_, "--force"},
                                          memory);
            ASSERT_EQ(result.exit_code, 0) << result.err;
            kinds.insert(test::read_file(video_));
        }
        EXPECT_EQ(kinds.size(), 1U) << size;
    }
}

TEST_F(Video, FramesOptionSelectsARange) {
    ASSERT_EQ(run_corda({"render", scene_, "-o", video_, "--frames", "10:15"}).exit_code, 0);
    const auto still = run_corda({"still", scene_, "--frame", "10", "-o", folder_.file("tenth.png")});
    ASSERT_EQ(still.exit_code, 0) << still.err;
    const test::DecodedFrames decoded = test::decode_video(video_);
    ASSERT_EQ(decoded.pictures.size(), 5U);
    EXPECT_GE(luma_psnr_db(decoded.pictures[0], read_png(folder_.file("tenth.png"))), 40.0);
}

TEST_F(Video, StillsAreTheFramesBeforeEncodingByteForByte) {
    ASSERT_EQ(run_corda({"still", scene_, "--at", "0,0.1,0.5,0.7333333333333333", "-o", folder_.file("at")})
                  .exit_code,
              0);
    ASSERT_EQ(run_corda({"still", scene_, "--frame", "22", "-o", folder_.file("frame.png")}).exit_code, 0);
    // The frames of the video, drawn in order as by `render`.
    Film film(load_scene(scene_));
    const std::map<int, std::string> stills{{0, "0.000"}, {3, "0.100"}, {15, "0.500"}, {22, "0.733"}};
    for (int k = 0; k <= 22; ++k) {
        const Image frame = film.frame(k);
        if (!stills.contains(k)) continue;
        const std::string path = folder_.file("at/scene_" + stills.at(k) + "s.png");
        EXPECT_TRUE(test::equal_images(read_png(path), frame)) << path;
    }
    EXPECT_TRUE(test::equal_images(read_png(folder_.file("frame.png")), film.frame(22)));
}

TEST_F(Video, StillsAcceptFrameRanges) {
    const std::string stills = folder_.file("v1.2");  // a folder whose name has a dot
    const auto result =
        run_corda({"still", scene_, "--frame", ":2,9,20:", "-o", stills + "/", "--size", "32x32", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::vector<std::string> wanted;
    for (const int k : {0, 1, 9, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29})
        wanted.push_back(fmt::format("{}/scene_f{:06}.png", stills, k));
    std::vector<std::string> written;
    const json report = json::parse(result.out);
    for (const json& output : report["outputs"]) {
        written.push_back(output["path"]);
        EXPECT_NE(test::read_file(written.back()), "");
    }
    EXPECT_EQ(written, wanted);
}

TEST_F(Video, StillsHaveTheirTimesAsNames) {
    const std::string scene = folder_.write("my.scene.v2.toml", test::read_file(scene_));
    const auto result = run_corda({"still", scene, "--at", "0.25", "-o", folder_.path(), "--size", "32x32"});
    EXPECT_EQ(result.out, folder_.file("my_scene_v2_0.25s.png") + "\n");
}

TEST_F(Video, StillsRecordTitleTimeAndResolution) {
    ASSERT_EQ(run_corda({"still", scene_, "--at", "0.3", "-o", folder_.file("a.png"), "--ppi", "300",
                         "--size", "65x33"})
                  .exit_code,
              0);
    const PngInfo info = read_png_info(folder_.file("a.png"));
    EXPECT_THAT(info.text, testing::Contains(testing::Pair("Title", "scene")));
    EXPECT_THAT(info.text, testing::Contains(testing::Pair("Time", "0.3 s")));
    EXPECT_NEAR(info.pixels_per_inch, 300.0, 0.02);
    EXPECT_EQ(read_png(folder_.file("a.png")).width(), 65);
    const std::string bytes = test::read_file(folder_.file("a.png"));
    EXPECT_NE(bytes.find("sRGB"), std::string::npos);
    EXPECT_NE(bytes.find("pHYs"), std::string::npos);
}

TEST_F(Video, StillsHaveTheSameBytesOnEveryRunAndThreadCount) {
    std::vector<std::string> stills;
    for (const std::string& threads : thread_counts()) {
        ASSERT_EQ(run_corda({"still", scene_, "--at", "0.5", "-o", folder_.file("a.png"), "--force"}, threads)
                      .exit_code,
                  0);
        stills.push_back(test::read_file(folder_.file("a.png")));
        EXPECT_EQ(stills.back(), stills.front()) << threads;
    }
}

}  // namespace
}  // namespace corda
