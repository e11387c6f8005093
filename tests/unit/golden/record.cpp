// The record in a golden picture of how it was made, and the causes of differences that follow from it.
#include "corda/golden/record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace corda::golden {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::StartsWith;

Film swing(const std::vector<Setting>& settings = {}) {
    constexpr const char* kText =
        "schema = 1\n[world]\nduration = 0.5\n[[rope]]\nhang = { links = 5, length = 1, angle_deg = 40 }\n";
    return Film(parse_scene(kText, "swing.toml", settings));
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
    Film named = swing({"solver.method=exact", "camera={center=[0,0],height=3}"});
    EXPECT_TRUE(record_of(named).chosen.empty());
}

TEST(GoldenRecords, NameTheKeyOfTheSceneThatChanged) {
    Film film = swing();
    const Provenance kept = kept_of(film);
    const struct {
        std::vector<Setting> settings;
        std::vector<Setting> told;  // as settings
        std::string changes;
    } cases[] = {
        {{}, {}, ""},
        {{"world.drag=0.5"}, {}, "world.drag is 0.5 and was 0"},
        {{"video.crf=30"}, {}, ""},  // affects videos only
        {{"video.fps=50"}, {}, "video.fps is 50 and was 60"},
        {{"video.speed='1/2'"}, {}, "video.speed is \"1/2\" and was 1"},
        {{"video.shutter=0.5"}, {}, "video.shutter is 0.5 and was 0"},
        {{"rope[0].hang.links=6", "world.drag=0.5"},
         {"rope[0].hang={links=6,length=1,angle_deg=40}", "world.dr=1"},
         "rope[0].hang.links is 6 and was 5 (by --set), world.drag is 0.5 and was 0"},
    };
    for (const auto& [settings, told, changes] : cases)
        EXPECT_EQ(changes_text(scene_changes(kept, swing(settings).scene(), told)), changes);
    EXPECT_EQ(changes_text(scene_changes({}, film.scene())), "");
}

TEST(GoldenRecords, ReportTheFirstDifference) {
    using Kind = Cause::Kind;
    Film film = swing();
    const GoldenRecord made = record_of(film);
    Provenance kept = kept_of(film);
    const auto cause = [&](const std::vector<Setting>& settings = {}) {
        return cause_of(kept, made, swing(settings).scene());
    };
    EXPECT_EQ(cause().kind, Kind::kPixels);
    kept.golden->renderer = "Voodoo";
    EXPECT_EQ(cause().kind, Kind::kRenderer);
    EXPECT_EQ(cause().stored, "Voodoo");
    EXPECT_EQ(cause().now, made.renderer);
    kept.corda = "0.0.1";
    EXPECT_EQ(cause().kind, Kind::kVersion);
    EXPECT_EQ(cause().stored, "0.0.1");
    kept.golden->chosen["camera.height"] = "9";
    EXPECT_EQ(cause().kind, Kind::kChoice);
    EXPECT_THAT(changes_text(cause().chosen), AllOf(StartsWith("camera.height is "), EndsWith(" and was 9")));
    EXPECT_EQ(cause({"world.drag=0.5"}).kind, Kind::kScene);
    EXPECT_EQ(changes_text(cause({"world.drag=0.5"}).changed), "world.drag is 0.5 and was 0");
    EXPECT_EQ(changes_text(cause({"world.drag=0.5"}).chosen), changes_text(cause().chosen));
    EXPECT_EQ(changes_text(cause({"camera.height=4"}).chosen), "");  // the scene gives it
    kept.golden->chosen.clear();
    EXPECT_EQ(changes_text(cause({"world.drag=0.5"}).chosen), "");
    kept.golden.reset();
    EXPECT_EQ(cause().kind, Kind::kUnrecorded);
}

}  // namespace
}  // namespace corda::golden
