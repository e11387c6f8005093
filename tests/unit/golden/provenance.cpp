// The record in a golden picture of how it was made, and the causes and frozen values that follow from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "corda/golden/provenance.hpp"
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

Provenance made_of(Film film, double time_s) {
    return provenance_of(film, time_s);
}

TEST(SuiteProvenance, SurvivesARoundTrip) {
    Film film = swing();
    const Provenance made = provenance_of(film, 0.25);
    const Provenance read = from_png_info(to_png_info(made, film, 0.25));
    EXPECT_TRUE(read.is_golden());
    EXPECT_EQ(read.scene, "swing");
    EXPECT_EQ(read.state, made.state);
    EXPECT_EQ(read.positions_m, made.positions_m);
    EXPECT_TRUE(read.is_frozen_as(made));
    EXPECT_EQ(cause_of(read, made), "same positions, camera and version, but pixels differ");
}

TEST(SuiteProvenance, NamesTheKeyOfTheSceneThatChanged) {
    const test::ScratchFolder folder;
    const std::string kept = folder.file("kept.png");
    Film film = swing();
    write_png(kept, Image(2, 2), to_png_info(provenance_of(film, 0.25), film, 0.25));
    EXPECT_EQ(scene_change(kept, swing().scene()), "");
    EXPECT_EQ(scene_change(kept, swing(5, {"world.drag=0.5"}).scene()), "world.drag is 0.5 and was 0");
    EXPECT_EQ(scene_change(kept, swing(5, {"rope[0].hang.links=6", "world.drag=0.5"}).scene()),
              "rope[0].hang.links is 6 and was 5, world.drag is 0.5 and was 0");
    EXPECT_EQ(scene_change(kept, swing(5, {"video.crf=30"}).scene()), "");  // affects videos only
    EXPECT_EQ(scene_change(kept, swing(5, {"video.shutter=0.5"}).scene()), "video.shutter is 0.5 and was 0");
    write_png(folder.file("plain.png"), Image(2, 2));
    EXPECT_EQ(scene_change(folder.file("plain.png"), film.scene()), "");
}

TEST(SuiteProvenance, KeepsSomeParticlesOfALongRope) {
    const Provenance short_one = made_of(swing(255), 0.0);
    EXPECT_THAT(short_one.positions_m, SizeIs(512));
    Film film = swing(600);
    const Provenance long_one = provenance_of(film, 0.0);
    EXPECT_THAT(long_one.positions_m, SizeIs(2 * 201));  // every third of 601
    EXPECT_EQ(long_one.positions_m[2], film.state_at(0.0).x_m[3]);
}

TEST(SuiteProvenance, FreezesTheOpenChoicesOfTheScene) {
    const Provenance made = made_of(swing(), 0.0);
    EXPECT_THAT(freezing(swing().scene(), made), SizeIs(3));
    EXPECT_THAT(freezing(swing(5, {"camera.height=3"}).scene(), made), SizeIs(2));
    EXPECT_THAT(freezing(swing(5, {"solver.method=\"rattle\""}).scene(), made), SizeIs(2));
    EXPECT_THAT(freezing(swing().scene(), {}), SizeIs(0));
    const Provenance again = made_of(swing(5, freezing(swing().scene(), made)), 0.0);
    EXPECT_TRUE(again.is_frozen_as(made));
    EXPECT_EQ(again.state, made.state);
}

TEST(SuiteProvenance, ReportsTheFirstDifference) {
    const Provenance made = made_of(swing(), 0.25);
    Provenance other = made;
    other.renderer = "Voodoo";
    EXPECT_THAT(cause_of(other, made), HasSubstr("another OpenGL: Voodoo"));
    other.version = "0.0.1";
    EXPECT_THAT(cause_of(other, made), HasSubstr("another version of Corda: 0.0.1"));
    other.height = "camera.height=9";
    EXPECT_EQ(cause_of(other, made), "same positions, other camera");
    other.state = "0";
    EXPECT_EQ(cause_of(other, made), "positions differ, if not those of the particles that are kept");
    other.positions_m[2] += 3e-4;
    EXPECT_EQ(cause_of(other, made), "positions differ by 0.0003 m");
    other.solver = "solver={method = \"rattle\"}";
    EXPECT_EQ(cause_of(other, made), "positions differ by 0.0003 m, by another solver");
    other.positions_m.pop_back();
    EXPECT_THAT(cause_of(other, made), HasSubstr("another number of particles"));
    EXPECT_THAT(cause_of({}, made), HasSubstr("does not say how it was made"));
}

TEST(SuiteProvenance, AcceptsOnlyNumbersAsPositions) {
    PngInfo info;
    for (const char* const text : {"zz", "7ff00000000000003ff0000000000000", "3ff000000000000g", ""}) {
        info.text = {{"Corda-Positions", text}};
        EXPECT_THAT(from_png_info(info).positions_m, SizeIs(0)) << text;
    }
    info.text = {{"Corda-Positions", "3ff00000000000004000000000000000"}};
    EXPECT_EQ(from_png_info(info).positions_m, (std::vector<double>{1.0, 2.0}));
    EXPECT_FALSE(from_png_info(info).is_golden());
}

}  // namespace
}  // namespace corda::golden
