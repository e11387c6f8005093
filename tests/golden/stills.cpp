// Golden stills: every scene of golden/scenes at 128x128 (live plots have no room there: 256x144) and 0.7 s
// is the picture kept in golden/stills, byte for byte, and at 1920x1080 it has the hash in
// golden/stills_1080p. CORDA_UPDATE_GOLDENS=1 writes both anew; look at the pictures before committing.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "corda/golden/compare.hpp"
#include "corda/media/defs.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/render/reference_renderer.hpp"
#include "support/command.hpp"
#include "support/draw_list_of.hpp"
#include "support/files.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

constexpr double kTimeSeconds = 0.7;

/// What the reference renderer makes of a film.
Image reference_of(const Film& film) {
    const view::DrawList sharp = test::draw_list_of(film, kTimeSeconds);
    const VideoDef& video = film.scene().video;
    if (video.shutter == 0.0) return render::render_reference(sharp);
    const double half_s = 0.5 * video.shutter * video.fps.interval_s();
    const double from_s = kTimeSeconds - half_s;
    const double until_s = kTimeSeconds + half_s;
    std::vector<view::DrawList> exposed;
    for (int i = 0; i < video.subframes; ++i) {
        const double at_s = from_s + (i + 0.5) / video.subframes * (until_s - from_s);
        exposed.push_back(test::draw_list_of(film, at_s));
    }
    return render::render_reference(exposed, sharp);
}

/// FNV-1a of 64 bits.
std::string hash_of(const Image& image) {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (std::size_t i = 0; i < image.size_bytes(); ++i) hash = (hash ^ image.data()[i]) * 0x100000001b3;
    return fmt::format("{:016x}\n", hash);
}

Setting size_of(const std::string& scene) {
    return test::test_name(scene).starts_with("plot_") ? "video.size=[256,144]" : "video.size=[128,128]";
}

class GoldenStill : public testing::TestWithParam<std::string> {};

TEST_P(GoldenStill, IsUnchanged) {
    const std::string golden_path =
        std::string(CORDA_GOLDENS) + "/stills/" + test::test_name(GetParam()) + ".png";
    const Film film(load_scene(GetParam(), {size_of(GetParam()), "world.duration=1.0"}));
    const Image drawn = film.still(kTimeSeconds, {}, film.scene().video.shutter);
    if (std::getenv("CORDA_UPDATE_GOLDENS") != nullptr) {
        PngInfo info;
        info.text = {{"Scene", film.scene().name}, {"Renderer", film.gl().renderer}};
        write_png(golden_path, drawn, info, {.force = true});
    }
    const Image golden = read_png(golden_path);
    EXPECT_TRUE(test::equal_images(drawn, golden)) << golden_path;
    EXPECT_TRUE(test::equal_images(reference_of(film), golden)) << golden_path;
    // Not a blank picture.
    Image blank(golden.width(), golden.height());
    for (int y = 0; y < golden.height(); ++y) {
        for (int x = 0; x < golden.width(); ++x) std::copy_n(golden.pixel(0, 0), 4, blank.pixel(x, y));
    }
    EXPECT_GT(compare(golden, blank).share, 0.002);
}

TEST_P(GoldenStill, IsUnchangedAt1080p) {
    const std::string path =
        std::string(CORDA_GOLDENS) + "/stills_1080p/" + test::test_name(GetParam()) + ".txt";
    const Film film(load_scene(GetParam(), {"video.size=[1920,1080]", "world.duration=1.0"}));
    const std::string hash = hash_of(film.still(kTimeSeconds, {}, film.scene().video.shutter));
    if (std::getenv("CORDA_UPDATE_GOLDENS") != nullptr) std::ofstream(path) << hash;
    EXPECT_EQ(test::read_file(path), hash) << path;
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenStill,
                         testing::ValuesIn(test::list_files(CORDA_GOLDENS "/scenes", ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
