#include <fmt/format.h>

#include "corda/scene/schema.hpp"
#include "corda/scene/write_scene.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::HasSubstr;

/// Each key in pixels of the schema, so that a new one is not forgotten.
TEST(ScaledTo, ScalesAllThatIsInPixels) {
    int count = 0;
    for (const Key& key : all_keys()) {
        if (key.unit != "px" || key.name == "size") continue;
        const bool is_net = key.section == "net";
        std::string path(key.section);
        if (is_net || path == "rope") path += "[0]";
        const bool is_pair = (key.type.forms & kPair) != 0;
        const Scene scene =
            parse_scene(is_net ? grid_with("") : rope_with(""), "swing.toml",
                        {fmt::format("{}.{}={}", path, key.name, is_pair ? "[36.0, 12]" : "36"),
                         "style.arrows=weight", "video.size=[1200, 600]"});
        const std::string text = write_scene(scaled_to(scene, 400, 200));
        EXPECT_THAT(text, HasSubstr(fmt::format("{} = {}\n", key.name, is_pair ? "[12, 4]" : "12")))
            << path_of(key);
        EXPECT_THAT(text, HasSubstr("size = [400, 200]"));
        // Back again, and no other value changes.
        EXPECT_EQ(write_scene(scaled_to(scaled_to(scene, 400, 200), 1200, 600)), write_scene(scene));
        ++count;
    }
    EXPECT_GE(count, 8);
}

TEST(ScaledTo, KeepsDefaultsAndRanges) {
    const Scene scene =
        parse_scene(rope_with("width_px = 0.2\n[style]\nrope_width_px = 900\n"), "swing.toml");
    const Scene small = scaled_to(scene, 192, 108);
    EXPECT_EQ(small.body_styles[0].width_px, 0.1);
    EXPECT_EQ(small.style.rope_width_px, 90.0);
    EXPECT_EQ(small.style.net_width_px, std::nullopt);
    EXPECT_EQ(std::get<AutoDef>(small.solver).tolerance_px, 0.1);
    const Scene large = scaled_to(scene, 3840, 2160);
    EXPECT_EQ(large.style.rope_width_px, 1000.0);
    EXPECT_EQ(large.video.width_px, 3840);
    EXPECT_NO_THROW(check_definitions(large));
}

}  // namespace
}  // namespace corda::scene
