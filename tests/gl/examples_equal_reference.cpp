// Every example scene, at sizes from a stamp to 4K, with its own, hair-thin and very thick ropes: the GL
// frame is the reference frame.

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/reference_renderer.hpp"
#include "corda/scene/auto_plan.hpp"
#include "corda/scene/player.hpp"
#include "support/files.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

class Examples : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(Examples, EqualTheReferenceByteForByte) {
    const auto& [path, size] = GetParam();
    const gl::Context context;
    for (const char* width : {"", "0.5", "60"}) {
        std::vector<scene::Setting> settings{"video.size=" + size};
        if (*width != '\0') settings.push_back(std::string("style.rope_width_px=") + width);
        scene::Scene scene = scene::load_scene(path, settings);
        static_cast<void>(scene::settle_method(scene));
        scene::Player player(scene);
        render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
        for (const double time_s : {0.0, 0.37 * scene.world.duration_s, scene.world.duration_s}) {
            const view::DrawList& list = player.at(time_s);
            renderer.render(list);
            EXPECT_TRUE(test::equal_images(renderer.image(), render::render_reference(list)))
                << "rope width \"" << width << "\" at " << time_s << " s";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Gl, Examples,
                         testing::Combine(testing::ValuesIn(test::list_files(CORDA_EXAMPLES, ".toml")),
                                          testing::Values("[64,64]", "[641,359]", "[1920,1080]",
                                                          "[3840,2160]")),
                         [](const auto& param) {
                             return test::test_name(std::get<0>(param.param)) +
                                    test::test_name(std::get<1>(param.param));
                         });

}  // namespace
}  // namespace corda
