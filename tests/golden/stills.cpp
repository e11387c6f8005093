// Golden stills: Film and the reference renderer draw the pictures of golden/stills, and of
// golden/pinned those that another solver or camera drew than auto chooses now; at 1920x1080 each has the
// hash in golden/stills_1080p. A second test runs `corda golden` on the same scenes (tests/CMakeLists.txt).
// The target update_golden_stills rewrites the pictures, CORDA_UPDATE_GOLDENS=1 the hashes; look at the
// pictures before committing.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/media/defs.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/testing.hpp"
#include "support/command.hpp"
#include "support/draw_list_of.hpp"
#include "support/files.hpp"

namespace corda {
namespace {

constexpr double kTimeSeconds = 0.7;

/// A frame of a film by the reference renderer.
Image reference_of(const Film& film) {
    const view::DrawList sharp = test::draw_list_of(film, kTimeSeconds);
    const VideoDef& video = film.scene().video;
    if (video.shutter == 0.0) return render::render_reference(sharp);
    const double half_s = 0.5 * video.shutter * video.scene_rate().interval_s();
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

class GoldenStill : public ::testing::TestWithParam<std::string> {};

TEST_P(GoldenStill, IsUnchanged) {
    const std::string pinned = CORDA_GOLDENS "/pinned/" + test::test_name(GetParam()) + ".toml";
    const bool is_pinned = std::filesystem::exists(pinned);
    const std::string path = is_pinned ? pinned : GetParam();
    const std::string folder = std::string(CORDA_GOLDENS) + (is_pinned ? "/pinned" : "/stills");
    const std::string name = test::test_name(GetParam()) + "_t0000_700000.png";
    std::vector<Setting> settings{"world.duration=1.0"};
    const Scene scene = load_scene(path, settings);
    settings.push_back(fmt::format("video.size=[{},{}]", scene.golden->width_px, scene.golden->height_px));
    Film film(load_scene(path, settings));
    const Image drawn = film.still(kTimeSeconds, film.scene().video.shutter);
    EXPECT_THAT(drawn, corda::testing::MatchesGolden(name, {.folder = folder}));
    EXPECT_THAT(reference_of(film), corda::testing::MatchesGolden(name, {.folder = folder}));
}

TEST_P(GoldenStill, IsUnchangedAt1080p) {
    const std::string path =
        std::string(CORDA_GOLDENS) + "/stills_1080p/" + test::test_name(GetParam()) + ".txt";
    Film film(load_scene(GetParam(), {"video.size=[1920,1080]", "world.duration=1.0"}));
    const std::string hash = hash_of(film.still(kTimeSeconds, film.scene().video.shutter));
    if (std::getenv("CORDA_UPDATE_GOLDENS") != nullptr) std::ofstream(path) << hash;
    EXPECT_EQ(test::read_file(path), hash) << path;
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenStill,
                         ::testing::ValuesIn(test::list_files(CORDA_GOLDENS "/scenes", ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
