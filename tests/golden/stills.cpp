// Golden stills: every scene of golden/scenes at 128x128 and 0.7 s is the picture kept in golden/stills, byte
// for byte. CORDA_UPDATE_GOLDENS=1 writes the pictures anew; look at them before committing.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "corda/golden/compare.hpp"
#include "corda/media/defs.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/render/reference_renderer.hpp"
#include "support/draw_list_of.hpp"
#include "support/files.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

constexpr double kTimeSeconds = 0.7;

class GoldenStill : public testing::TestWithParam<std::string> {};

TEST_P(GoldenStill, IsUnchanged) {
    const std::string golden_path =
        std::string(CORDA_GOLDENS) + "/stills/" + test::test_name(GetParam()) + ".png";
    const Film film(load_scene(GetParam(), {"video.size=[128,128]", "world.duration=1.0"}));
    const Image drawn = film.still(kTimeSeconds);
    if (std::getenv("CORDA_UPDATE_GOLDENS") != nullptr) {
        PngInfo info;
        info.text = {{"Scene", film.scene().name}, {"Renderer", film.gl().renderer}};
        write_png(golden_path, drawn, info, {.force = true});
    }
    const Image golden = read_png(golden_path);
    EXPECT_TRUE(test::equal_images(drawn, golden)) << golden_path;
    EXPECT_TRUE(test::equal_images(render::render_reference(test::draw_list_of(film, kTimeSeconds)), golden))
        << golden_path;
    // Not a blank picture.
    Image blank(128, 128);
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) std::copy_n(golden.pixel(0, 0), 4, blank.pixel(x, y));
    }
    EXPECT_GT(compare(golden, blank).share, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenStill,
                         testing::ValuesIn(test::list_files(CORDA_GOLDENS "/scenes", ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
