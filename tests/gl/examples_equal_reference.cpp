// Every example scene, at sizes from a stamp to 4K, with its own, hair-thin and very thick ropes: the GL
// frame is the reference frame.

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "corda/pipeline/film.hpp"
#include "corda/render/reference_renderer.hpp"
#include "support/draw_list_of.hpp"
#include "support/files.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

class Examples : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(Examples, EqualTheReferenceByteForByte) {
    const auto& [path, size] = GetParam();
    for (const char* width : {"", "0.5", "60"}) {
        std::vector<Setting> settings{"video.size=" + size};
        if (*width != '\0') settings.push_back(std::string("style.rope_width_px=") + width);
        const Film film(load_scene(path, settings));
        const double end_s = film.scene().world.duration_s;
        for (const double time_s : {0.0, 0.37 * end_s, end_s}) {
            const Image expected = render::render_reference(test::draw_list_of(film, time_s));
            EXPECT_TRUE(test::equal_images(film.still(time_s), expected))
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
