// The record in a golden picture of how it was made, and the causes and frozen values that follow from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "corda/core/text.hpp"
#include "corda/golden/record.hpp"
#include "support/command.hpp"

namespace corda::golden {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

Film swing(int links = 5, const std::vector<Setting>& settings = {}) {
    const std::string text =
        "schema = 1\n[world]\nduration = 0.5\n[[rope]]\nhang = { links = " + std::to_string(links) +
        ", length = 1.0, angle_deg = 40.0 }\n";
    return Film(parse_scene(text, "swing.toml", settings));
}

GoldenRecord made_of(Film film, double time_s) {
    return record_of(film, time_s);
}

TEST(GoldenRecords, SurvivesARoundTrip) {
    Film film = swing(5, {"style.color_by=\"speed\""});
    const GoldenRecord made = record_of(film, 0.25);
    EXPECT_EQ(made.color_scale, "speed (m/s) 0 .. 3");
    const Provenance read = provenance_in(to_png_info(made, film, 0.25));
    EXPECT_EQ(read.name, "swing");
    ASSERT_TRUE(read.golden);
    EXPECT_EQ(read.golden->state, made.state);
    EXPECT_EQ(read.golden->positions_m, made.positions_m);
    EXPECT_EQ(read.golden->color_scale, made.color_scale);
    EXPECT_TRUE(read.golden->is_frozen_as(made));
    EXPECT_EQ(cause_of(read, made, {}).text, "same positions, camera and version, but pixels differ");
}

TEST(GoldenRecords, NamesTheKeyOfTheSceneThatChanged) {
    const test::ScratchFolder folder;
    const std::string kept = folder.file("kept.png");
    Film film = swing();
    write_png(kept, Image(2, 2), to_png_info(record_of(film, 0.25), film, 0.25));
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
    write_png(folder.file("plain.png"), Image(2, 2));
    EXPECT_EQ(scene_change(folder.file("plain.png"), film.scene()), "");
}

TEST(GoldenRecords, KeepsSomeParticlesOfALongRope) {
    const GoldenRecord short_one = made_of(swing(255), 0.0);
    EXPECT_THAT(short_one.positions_m, SizeIs(512));
    Film film = swing(600);
    const GoldenRecord long_one = record_of(film, 0.0);
    EXPECT_THAT(long_one.positions_m, SizeIs(2 * 201));  // every third of 601
    EXPECT_EQ(long_one.positions_m[2], film.state_at(0.0).x_m[3]);
}

TEST(GoldenRecords, FitWithTheMostParticlesBesideAScene) {
    Film film = swing(255);
    Provenance origin = corda::provenance_of(film.scene());
    origin.golden = record_of(film, 0.0);
    const std::string text = provenance_text(origin);
    EXPECT_LE(text.size(), Provenance::kMaxBytes);  // 9.0 KiB
    std::mt19937 random(1);
    while (origin.scene.size() < 3 * Provenance::kMaxBytes) origin.scene += fmt::format("#{:08x}", random());
    const std::string longest = provenance_text(origin);
    EXPECT_LE(longest.size(), Provenance::kMaxBytes);
    for (const std::string& one : {text, longest}) {
        const Provenance read = provenance_in({.text = {{kProvenanceKeyword, one}}});
        EXPECT_EQ(read.golden->positions_m, origin.golden->positions_m);
        EXPECT_EQ(read.scene.empty(), one == longest);
    }
}

TEST(GoldenRecords, FreezesTheOpenChoicesOfTheScene) {
    const GoldenRecord made = made_of(swing(), 0.0);
    EXPECT_THAT(freezing(swing().scene(), made), SizeIs(3));
    EXPECT_THAT(freezing(swing(5, {"camera.height=3"}).scene(), made), SizeIs(2));
    EXPECT_THAT(freezing(swing(5, {"solver.method=\"rattle\""}).scene(), made), SizeIs(2));
    EXPECT_THAT(freezing(swing().scene(), std::nullopt), SizeIs(0));
    const GoldenRecord again = made_of(swing(5, freezing(swing().scene(), made)), 0.0);
    EXPECT_TRUE(again.is_frozen_as(made));
    EXPECT_EQ(again.state, made.state);
}

TEST(GoldenRecords, ReportTheFirstDifference) {
    const GoldenRecord made = made_of(swing(), 0.25);
    Provenance kept{.corda = std::string(version()), .golden = made};
    GoldenRecord& other = *kept.golden;
    other.renderer = "Voodoo";
    EXPECT_THAT(cause_of(kept, made, {}).text, HasSubstr("another OpenGL: Voodoo"));
    kept.corda = "0.0.1";
    EXPECT_THAT(cause_of(kept, made, {}).text, HasSubstr("another version of Corda: 0.0.1"));
    kept.fonts = {"Song 1.000", "Han 2.000"};
    EXPECT_EQ(
        cause_of(kept, made, {"Song 1.100"}).text,
        "same positions and camera, other fonts besides DejaVu Sans: Song 1.000, Han 2.000, now Song 1.100");
    EXPECT_THAT(cause_of(kept, made, {}).text, HasSubstr("Han 2.000, now none"));
    EXPECT_THAT(cause_of(kept, made, kept.fonts).text, HasSubstr("another version of Corda"));
    other.color_scale = "speed (m/s) 0 .. 2";
    EXPECT_EQ(cause_of(kept, made, {}).text,
              "same positions and camera, another scale of colours: speed (m/s) 0 .. 2, now none");
    other.height_m = 9.0;
    EXPECT_EQ(cause_of(kept, made, {}).text, "same positions, other camera");
    other.state = "0";
    EXPECT_EQ(cause_of(kept, made, {}).text, "positions differ, if not those of the particles that are kept");
    other.positions_m[2] += 3e-4;
    EXPECT_EQ(cause_of(kept, made, {}).text, "positions differ by 0.0003 m");
    EXPECT_EQ(cause_of(kept, made, {}).group, "positions differ");
    other.solver = "solver={method = \"rattle\"}";
    EXPECT_EQ(cause_of(kept, made, {}).text, "positions differ by 0.0003 m, by another solver");
    other.positions_m.pop_back();
    EXPECT_THAT(cause_of(kept, made, {}).text, HasSubstr("another number of particles"));
    EXPECT_THAT(cause_of({}, made, {}).text, HasSubstr("does not say how it was made"));
}

TEST(GoldenRecords, AreReadOnlyIfTheyAreSound) {
    Film film = swing();
    const auto read = [&](const std::string& key, const nlohmann::json& value) {
        PngInfo info = to_png_info(record_of(film, 0.0), film, 0.0);
        std::string& text = info.text.back().second;
        auto json = nlohmann::json::parse(text);
        json["golden"][key] = value;
        text = json.dump();
        return provenance_in(info).golden;
    };
    const std::string one = "3ff0000000000000";
    EXPECT_EQ(read("positions", one + "4000000000000000")->positions_m, (std::vector<double>{1.0, 2.0}));
    for (const char* const bad : {"zz", "7ff00000000000003ff0000000000000", "3ff000000000000g", "3ff0"})
        EXPECT_FALSE(read("positions", bad)) << bad;
    EXPECT_FALSE(read("positions", 1.0));
    EXPECT_FALSE(read("solver", "camera.height=3"));
    EXPECT_FALSE(read("center", {1.0}));
    EXPECT_FALSE(read("height", "3"));
}

}  // namespace
}  // namespace corda::golden
