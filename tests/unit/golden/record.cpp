// The record in a golden picture of how it was made, and the causes of differences that follow from it.
#include "corda/golden/record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace corda::golden {
namespace {

using ::testing::HasSubstr;

Film swing(int links = 5, const std::vector<Setting>& settings = {}) {
    const std::string text =
        "schema = 1\n[world]\nduration = 0.5\n[[rope]]\nhang = { links = " + std::to_string(links) +
        ", length = 1.0, angle_deg = 40.0 }\n";
    return Film(parse_scene(text, "swing.toml", settings));
}

/// What a kept picture of a film tells.
Provenance kept_of(Film& film) {
    return provenance_in(to_png_info(record_of(film), film, 0.25));
}

TEST(GoldenRecords, SurviveARoundTrip) {
    Film film = swing();
    const Provenance kept = kept_of(film);
    EXPECT_EQ(kept.name, "swing");
    EXPECT_EQ(kept.scene, film.scene().text);
    ASSERT_TRUE(kept.golden);
    EXPECT_EQ(kept.golden->chosen, record_of(film).chosen);
    EXPECT_TRUE(kept.golden->chosen.contains("camera.height"));
    EXPECT_TRUE(kept.golden->chosen.contains("solver.method"));
    Film named = swing(5, {"solver.method=exact", "camera={center=[0,0],height=3}"});
    EXPECT_TRUE(record_of(named).chosen.empty());
}

TEST(GoldenRecords, NameTheKeyOfTheSceneThatChanged) {
    Film film = swing();
    const Provenance kept = kept_of(film);
    EXPECT_EQ(scene_change(kept, swing().scene()), "");
    EXPECT_EQ(scene_change(kept, swing(5, {"world.drag=0.5"}).scene()), "world.drag is 0.5 and was 0");
    EXPECT_EQ(scene_change(kept, swing(5, {"rope[0].hang.links=6", "world.drag=0.5"}).scene()),
              "rope[0].hang.links is 6 and was 5, world.drag is 0.5 and was 0");
    EXPECT_EQ(scene_change(kept, swing(5, {"video.crf=30"}).scene()), "");  // affects videos only
    EXPECT_EQ(scene_change(kept, swing(5, {"video.fps=50"}).scene()), "video.fps is 50 and was 60");
    const std::vector<Setting> settings{"rope[0].hang={links=6,length=1,angle_deg=40}", "world.dr=1"};
    EXPECT_EQ(scene_change(kept, swing(6, {"world.drag=0.5"}).scene(), settings),
              "rope[0].hang.links is 6 and was 5 (by --set), world.drag is 0.5 and was 0");
    EXPECT_EQ(scene_change(kept, swing(5, {"video.shutter=0.5"}).scene()), "video.shutter is 0.5 and was 0");
    EXPECT_EQ(scene_change({}, film.scene()), "");
}

TEST(GoldenRecords, ReportTheFirstDifference) {
    Film film = swing();
    const GoldenRecord made = record_of(film);
    Provenance kept = kept_of(film);
    const auto cause = [&](const Scene& now) { return cause_of(kept, made, now); };
    EXPECT_EQ(cause(film.scene()).text, "same scene, version and OpenGL, but pixels differ");
    kept.golden->renderer = "Voodoo";
    EXPECT_THAT(cause(film.scene()).text, HasSubstr("same scene, drawn by another OpenGL: Voodoo, now "));
    kept.corda = "0.0.1";
    EXPECT_THAT(cause(film.scene()).text,
                HasSubstr("same scene, drawn by another version of Corda: 0.0.1, now "));
    kept.golden->chosen["camera.height"] = "9";
    EXPECT_THAT(cause(film.scene()).text, HasSubstr("same scene, another choice: camera.height is "));
    EXPECT_EQ(cause(film.scene()).group, "another solver or camera is chosen");
    Film other = swing(5, {"world.drag=0.5"});
    EXPECT_THAT(cause(other.scene()).text, HasSubstr("another choice: camera.height is "));
    EXPECT_THAT(cause(other.scene()).text, HasSubstr(" and was 9; world.drag is 0.5 and was 0"));
    EXPECT_EQ(cause(other.scene()).group, "world.drag is 0.5 and was 0");
    kept.golden->chosen.clear();
    EXPECT_EQ(cause(other.scene()).text, "world.drag is 0.5 and was 0");
    kept.golden.reset();
    EXPECT_THAT(cause(film.scene()).text, HasSubstr("does not say how it was made"));
}

}  // namespace
}  // namespace corda::golden
