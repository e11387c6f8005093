// Every example scene, at sizes from a stamp to 4K, with its own, hair-thin and very thick ropes: the GL
// frame is the reference frame. A 4K frame takes a third of a second: the thin and the thick ones, and two of
// three times, are for CORDA_TEST_LONG=1.

#include <gtest/gtest.h>

#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"
#include "corda/render/frame_renderer.hpp"
#include "support/draw_list_of.hpp"
#include "support/files.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

class Examples : public testing::TestWithParam<std::string> {};

TEST_P(Examples, EqualTheReferenceByteForByte) {
    Film film(load_scene(GetParam()));  // sizes and widths share its motion
    const double end_s = film.scene().world.duration_s;
    std::vector<State> states;
    std::vector<MotionBounds> motion;
    for (const double time_s : {0.0, 0.37 * end_s, end_s}) {
        states.push_back(film.state_at(time_s));
        test::include(states.back(), motion);
    }
    const bool is_long = std::getenv("CORDA_TEST_LONG") != nullptr;
    for (const char* size : {"[64,64]", "[641,359]", "[1920,1080]", "[3840,2160]"}) {
        for (const char* width : {"", "0.5", "60"}) {
            const bool is_brief = !is_long && std::string(size) == "[3840,2160]";
            if (is_brief && *width != '\0') continue;
            std::vector<Setting> settings{std::string("video.size=") + size};
            if (*width != '\0') settings.push_back(std::string("style.rope_width_px=") + width);
            const Scene scene = load_scene(GetParam(), settings);
            const film::Look look = film::look_within(scene, film.system(), motion);
            const render::CanvasUse canvas(film.context_def());
            for (const State& state : std::span(states).last(is_brief ? 1 : states.size())) {
                film::draw(look, state, canvas->list());
                canvas->paint(canvas->list());
                const Image expected = render::render_reference(
                    test::draw_list_of(scene, film.system(), look.camera, state, motion));
                EXPECT_TRUE(test::equal_images(canvas->image(), expected))
                    << size << ", rope width \"" << width << "\" at " << state.time_s << " s";
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Gl, Examples, testing::ValuesIn(test::list_files(CORDA_EXAMPLES, ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
