// Golden stills: every scene of golden/scenes at 128x128 and 0.7 s is the picture kept in golden/stills, byte
// for byte. CORDA_UPDATE_GOLDENS=1 writes the pictures anew; look at them before committing.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "corda/gl/context.hpp"
#include "corda/golden/compare.hpp"
#include "corda/media/png.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/reference_renderer.hpp"
#include "corda/scene/auto_plan.hpp"
#include "corda/scene/player.hpp"
#include "support/files.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

constexpr double kTimeSeconds = 0.7;

class GoldenStill : public testing::TestWithParam<std::string> {};

TEST_P(GoldenStill, IsUnchanged) {
    const std::string golden_path =
        std::string(CORDA_GOLDENS) + "/stills/" + test::test_name(GetParam()) + ".png";
    scene::Scene scene = scene::load_scene(GetParam(), {"video.size=[128,128]", "world.duration=1.0"});
    static_cast<void>(scene::settle_method(scene));
    scene::Player player(scene);
    const gl::Context context;
    render::FrameRenderer renderer(128, 128);
    const view::DrawList& list = player.at(kTimeSeconds);
    renderer.render(list);
    if (std::getenv("CORDA_UPDATE_GOLDENS") != nullptr) {
        media::PngInfo info;
        info.text = {{"Scene", scene.name}, {"Renderer", context.info().gl_renderer}};
        media::write_png(golden_path, renderer.image(), info);
    }
    const Image golden = media::read_png(golden_path);
    EXPECT_TRUE(test::equal_images(renderer.image(), golden)) << golden_path;
    EXPECT_TRUE(test::equal_images(render::render_reference(list), golden)) << golden_path;
    // Not a blank picture.
    Image blank(128, 128);
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) std::copy_n(golden.pixel(0, 0), 4, blank.pixel(x, y));
    }
    EXPECT_GT(golden::compare(golden, blank).share, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenStill,
                         testing::ValuesIn(test::list_files(CORDA_GOLDENS "/scenes", ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
