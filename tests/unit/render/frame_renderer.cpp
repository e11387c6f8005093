// What needs no OpenGL; its pictures are in tests/gl.
#include "corda/render/frame_renderer.hpp"

#include <gmock/gmock.h>

#include <string>

#include "corda/view/draw_list.hpp"
#include "support/command.hpp"

namespace corda::render {
namespace {

TEST(CompositeShader, HasAColorForEveryLayer) {
    const std::string shader = test::read_file(CORDA_EXAMPLES "/../shaders/composite.frag");
    EXPECT_THAT(shader, testing::HasSubstr("layer_color[" + std::to_string(view::kMaxLayers) + "]"));
}

}  // namespace
}  // namespace corda::render
