#include "corda/render/frame_renderer.hpp"

#include <gmock/gmock.h>

#include "corda/gl/context.hpp"
#include "support/draw_lists.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

TEST(DriverChecks, PassOnEveryUsablePlatform) {
    int checked = 0;
    const std::vector<gl::Attempt> attempts = gl::probe_contexts([&checked](const gl::Context& context) {
        render::check_driver(context);
        render::check_driver(context);  // does nothing: this driver has been checked
        ++checked;
    });
    EXPECT_GT(checked, 0);
    for (const gl::Attempt& attempt : attempts) EXPECT_EQ(attempt.is_usable(), attempt.info.has_value());
}

TEST(DriverChecks, DoNotChangeTheRenderer) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 64, 48);
    const view::DrawList list = test::random_draw_list(1, 64, 48, 4, 20, 6);
    for (const bool with_tints : {false, true}) {
        render::check_driver(context, renderer, with_tints);
        renderer.render(list);
        EXPECT_TRUE(test::equal_images(renderer.image(), render::render_reference(list)));
    }
}

TEST(DriverChecks, FailThePlatform) {
    const auto attempts = gl::probe_contexts(
        [](const gl::Context&) { throw Error(ExitCode::kNoGl, "the driver draws wrongly"); });
    for (const gl::Attempt& attempt : attempts) {
        EXPECT_FALSE(attempt.is_usable());
        if (attempt.info) {
            EXPECT_EQ(attempt.failure, "the driver draws wrongly");
        }
    }
}

}  // namespace
}  // namespace corda
