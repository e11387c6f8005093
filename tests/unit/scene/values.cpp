#include "corda/scene/write_scene.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "corda/scene/schema.hpp"

namespace corda {
namespace {

constexpr const char* kScene = R"(schema = 1
[[rope]]
hang = { links = 30, length = 2.0, angle_deg = 30 }
[[net]]
grid = { columns = 4, rows = 3, spacing = 0.5 }
compliance = 1e-4
)";

std::map<std::string, std::string> values_with(const std::vector<Setting>& settings = {}) {
    return values_of(parse_scene(kScene, "scene.toml", settings));
}

TEST(Values, HasEveryKeyWithADefault) {
    const auto all = values_with();
    int keys = 0;
    for (const scene::Key& key : scene::all_keys()) {
        const bool is_plain = key.section == "world" || key.section == "style" || key.section == "overlay" ||
                              key.section == "camera" || key.section == "video";
        if (!is_plain || key.name == "jobs" || key.binding.initial.toml.empty()) continue;
        // The theme is the only one of them that a scene leaves open.
        if (key.name == "theme") continue;
        ++keys;
        EXPECT_TRUE(all.contains(scene::dotted(key.section, key.name))) << key.name;
    }
    EXPECT_GE(keys, 21);
}

TEST(Values, DiffersInTheKeyThatDiffers) {
    const auto same = values_with();
    EXPECT_THAT(differences(same, values_with({"video.jobs=3"})), testing::IsEmpty());
    for (const auto& [setting, difference] : std::vector<std::pair<std::string, std::string>>{
             {"video.crf=20", "video.crf is not given and was 20"},
             {"world.drag=0.1", "world.drag is 0 and was 0.1"},
             {"style.theme=paper", "style.theme is not given and was \"paper\""},
             {"overlay.plots=[\"tip\"]", "overlay.plots is [] and was [\"tip\"]"},
             {"style.color_by=speed", "style.color_by is \"body\" and was \"speed\""},
             {"camera.height=2", "camera.height is not given and was 2"},
             {"world.gravity=1.6", "world.gravity is 9.81 and was 1.6"},
             {"world.gravity=[1, 0]", "world.gravity is 9.81 and was [1, 0]"},
             {"rope[0].mass=2", "rope[0].mass is 1 and was 2"},
             {"rope[0].color=red", "rope[0].color is not given and was \"#ff0000\""},
             {"rope[0].bending=1e-3", "rope[0].bending is 0 and was 0.001"},
             {"rope[0].hang.links=31", "rope[0].hang.links is 30 and was 31"},
             {"rope[0].hang.angle_deg=31", "rope[0].hang.angle_deg is 30 and was 31"},
             {"rope[0].hang.length=2.0000000000000004",
              "rope[0].hang.length is 2 and was 2.0000000000000004"},
             {"net[0].compliance=1e-5", "net[0].compliance is 0.0001 and was 1e-5"},
             {"net[0].grid.diagonals=true", "net[0].grid.diagonals is false and was true"},
             {"net[0].grid.spacing=[0.5, 1]", "net[0].grid.spacing is 0.5 and was [0.5, 1]"},
             {"solver.tolerance_px=0.2", "solver.tolerance_px is 0.1 and was 0.2"},
         }) {
        EXPECT_EQ(changes_text(differences(same, values_with({setting}))), difference);
    }
}

TEST(Values, NamesAllKeysThatDiffer) {
    EXPECT_EQ(
        changes_text(differences(
            values_with({"rope[0].hang.links=31", "world.drag=0.5", "solver.method=exact"}), values_with())),
        "rope[0].hang.links is 31 and was 30, solver.implicit is false and was not given, "
        "solver.method is \"exact\" and was \"auto\", solver.tolerance is 1e-9 and was not given, "
        "world.drag is 0.5 and was 0, solver.tolerance_px is not given and was 0.1");
    EXPECT_THAT(changes_text(std::vector<KeyChange>(22, {"a", "1", {}, true})),
                testing::EndsWith(", a is 1 and was not given (by --set), and 2 more"));
}

TEST(Values, OfABodyThatCodeHasMovedHasItsPoints) {
    const Scene scene = parse_scene(kScene, "scene.toml");
    Scene moved = scene;
    moved.ropes[0].points_m[1].x += 1e-3;
    moved.nets[0].bars.pop_back();
    EXPECT_FALSE(values_of(moved).contains("rope[0].hang.links"));
    EXPECT_TRUE(values_of(moved).contains("rope[0].points"));
    EXPECT_TRUE(values_of(moved).contains("net[0].bars"));
    EXPECT_EQ(values_of(moved).at("rope[0].origin"), "[0, 0]");
}

TEST(Values, ThatAreLongAreNotRepeated) {
    const std::string long_title(65, 'a');
    EXPECT_EQ(changes_text(differences(values_with({"overlay.title=" + long_title}), values_with())),
              "overlay.title has other values");
}

}  // namespace
}  // namespace corda
