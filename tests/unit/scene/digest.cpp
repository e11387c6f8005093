#include "corda/scene/digest.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "corda/scene/keys.hpp"

namespace corda {
namespace {

constexpr const char* kDigested = R"(schema = 1
[[rope]]
hang = { links = 30, length = 2.0, angle_deg = 30 }
[[net]]
grid = { columns = 4, rows = 3, spacing = 0.5 }
compliance = 1e-4
)";

std::map<std::string, std::string> digest_of(const std::vector<Setting>& settings = {}) {
    return digest(parse_scene(kDigested, "scene.toml", settings));
}

TEST(Digest, HasEveryKeyOfAPictureAndAWorld) {
    const auto all = digest_of();
    int keys = 0;
    for (const scene::Key& key : scene::all_keys()) {
        const bool is_plain = key.section == "world" || key.section == "style" || key.section == "overlay" ||
                              key.section == "camera" || key.section == "video";
        if (!is_plain || key.name == "jobs") continue;
        ++keys;
        EXPECT_TRUE(all.contains(scene::dotted(key.section, key.name))) << key.name;
    }
    EXPECT_GE(keys, 40);
}

TEST(Digest, DiffersInTheKeyThatDiffers) {
    const auto same = digest_of();
    EXPECT_EQ(first_difference(same, digest_of({"video.jobs=3"})), "");
    for (const auto& [setting, difference] : std::vector<std::pair<std::string, std::string>>{
             {"video.crf=20", "video.crf is not given and was 20"},
             {"world.drag=0.1", "world.drag is 0 and was 0.1"},
             {"style.theme=paper", "style.theme is not given and was paper"},
             {"overlay.plot=tip", "overlay.plot is none and was tip"},
             {"style.color_by=speed", "style.color_by is body and was speed"},
             {"camera.height=2", "camera.height is not given and was 2"},
             {"rope[0].mass=2", "rope[0].mass has other values"},
             {"rope[0].color=red", "rope[0].color is not given and was #ff0000"},
             {"rope[0].bending=1e-3", "rope[0].bending is 0 and was 0.001"},
             {"rope[0].hang.length=2.0000000000000004", "rope[0].points has other values"},
             {"net[0].compliance=1e-5", "net[0].compliance is 0.0001 and was 1e-05"},
             {"net[0].grid.diagonals=false", "net[0].bars has other values"},
             {"solver.tolerance_px=0.2", "solver.tolerance_px is 0.1 and was 0.2"},
             {"solver.method=exact", "solver.method is auto and was exact"},
         }) {
        EXPECT_EQ(first_difference(same, digest_of({setting})), difference);
    }
}

TEST(Digest, OfManyBodiesIsShort) {
    std::string toml = "schema = 1\n";
    for (int i = 0; i < 150; ++i) toml += "[[rope]]\npoints = [[0, 0], [1, 0]]\n";
    const Scene scene = parse_scene(toml, "many.toml");
    Scene other = scene;
    other.ropes[140].payload_kg = 3.0;
    EXPECT_LT(digest(scene).size(), 100U);
    EXPECT_EQ(first_difference(digest(scene), digest(other)), "scene.bodies has other values");
}

}  // namespace
}  // namespace corda
