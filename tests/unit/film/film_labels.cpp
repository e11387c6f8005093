#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"
#include "corda/film/look.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using test::code_of;

Scene rope() {
    return parse_scene(R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[video]
fps = 30
[solver]
method = "exact"
)",
                       "rope.toml");
}

TEST(FilmEnergy, NeedsVelocities) {
    Film film(rope());
    EXPECT_EQ(code_of([&] { static_cast<void>(film.energy_of(film.state(3))); }), ExitCode::kUsage);
}

TEST(FilmEnergy, OfAnExactRunIsConserved) {
    FilmDef def;
    def.readings.velocities = true;
    const Film film(rope(), def);
    const Energy energy = film.energy_of(film.state(25));
    EXPECT_GT(energy.kinetic_j, 0.9);
    EXPECT_EQ(energy.elastic_j, 0.0);
    EXPECT_NEAR(energy.kinetic_j + energy.potential_j(), 0.0, 1e-12);  // measured 9e-14
}

/// The ink of the label and the camera of a film at a time.
std::pair<PixelRect, double> label_at(const Film& film, double time_s) {
    view::DrawList list;
    film::draw(film.look(), film.motion(), time_s, list);
    for (const view::Text& text : list.texts)
        if (text.utf8 == "label")
            return {view::Font().ink(text), film.look().map_at(time_s).pixels_per_metre()};
    return {};
}

Scene labelled(const std::string& rope, const std::string& more = "") {
    return parse_scene("schema = 1\n[world]\nduration = 2.0\n[[rope]]\nlabel = \"label\"\n" + rope +
                           "[video]\nsize = [320, 180]\nfps = 30\n" + more,
                       "labelled.toml");
}

TEST(FilmLabels, OfAPinKeepClearOfWhatRisesAboveIt) {
    const char* const kWhirling = "hang = { links = 1, length = 1.0 }\nvelocity = [8.0, 0.0]\n";
    const Film film(labelled(kWhirling));
    const auto [label, scale] = label_at(film, 0.5);
    ASSERT_FALSE(label.empty());
    const view::Camera map = film.look().map_at(0.0);
    const State start = film.state(0);
    const view::PixelPoint pin = map.at(start, 0);
    EXPECT_LT(label.y1, pin.y - scale);  // the mass comes by at 1 m
    EXPECT_GE(label.y0, 0);
    EXPECT_EQ(label_at(film, 1.5).first, label);
    // A scene that gives this camera has the same pictures.
    Scene frozen = film.scene();
    frozen.camera = film.camera();
    EXPECT_TRUE(test::equal_images(Film(frozen).still(0.5), film.still(0.5)));
    // A hanging rope leaves its label at the pin, and so does a given camera without room above the circle.
    const Film low(labelled("hang = { links = 1, length = 1.0, angle_deg = 60.0 }\n"));
    EXPECT_EQ(low.look().overlay.labels.at(0).raise_px, 0.0);
    const Film narrow(labelled(kWhirling, "[camera]\ncenter = [0, 0]\nheight = 2.0\n"));
    EXPECT_EQ(narrow.look().overlay.labels.at(0).raise_px, 0.0);
    const Film wide(labelled(kWhirling, "[camera]\ncenter = [0, 0]\nheight = 4.0\n"));
    EXPECT_GT(wide.look().overlay.labels.at(0).raise_px, 30.0);
}

TEST(FilmLabels, LeaveRoomForARopeThatStandsOnItsPin) {
    const std::string rope = "hang = { links = 1, length = 1.0, angle_deg = 180.0 }\n";
    const Film film(labelled(rope));
    const Film plain(
        parse_scene("schema = 1\n[world]\nduration = 2.0\n[[rope]]\n" + rope + "[video]\nsize = [320, 180]\n",
                    "plain.toml"));
    EXPECT_LT(*film.camera().height_m, 1.3 * *plain.camera().height_m);
    const auto [label, scale] = label_at(film, 0.5);
    EXPECT_FALSE(label.empty());
    EXPECT_GE(label.y0, 0);
    // A scene that gives this camera has the same pictures.
    Scene frozen = film.scene();
    frozen.camera = film.camera();
    EXPECT_TRUE(test::equal_images(Film(frozen).still(0.5), film.still(0.5)));
}

TEST(FilmLabels, OfAPinFarAboveTheFrameStay) {
    const Film film(labelled("hang = { links = 1, length = 1.0, angle_deg = 170.0 }\n",
                             "[camera]\ncenter = [0, -1e9]\nheight = 0.01\n"));
    EXPECT_EQ(film.look().overlay.labels.at(0).raise_px, 0.0);
}

TEST(FilmLabels, OfAPinThatMovesKeepClearOfTrails) {
    for (const char* const more : {"", "[[rope]]\nhang = { links = 1, length = 1.0, from = [1.5, 2.0] }\n"}) {
        const Film film(
            labelled("hang = { links = 1, length = 1.0, angle_deg = 180.0 }\n"
                     "moves = [{ pin = 0, waves = [{ amplitude = [0.0, 0.06], frequency = 2.0 }] }]\n" +
                         std::string(more),
                     "[style]\ntrail_s = 0.4\n"));
        int points = 0;
        for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
            const PixelRect label = label_at(film, film.time_s(k)).first;
            ASSERT_FALSE(label.empty());
            EXPECT_GE(label.y0, 0);
            const view::Camera map = film.look().map_at(film.time_s(k));
            for (const view::Trail& trail : film.look().paths.to(film.state(k))) {
                for (const view::TrailPoint& point : trail) {
                    const double y_px = map.y_px(point.at_m.y);
                    EXPECT_TRUE(y_px < label.y0 || y_px > label.y1) << k;
                    ++points;
                }
            }
        }
        EXPECT_GT(points, 300);
    }
}

TEST(FilmLabels, OfNeighbouringPinsAreInRows) {
    std::string ropes;
    for (const char* const from : {"0.2", "0.4", "3.0"})
        ropes += fmt::format(
            "[[rope]]\nlabel = \"label of {}\"\nhang = {{ links = 1, length = 1.0, from = [{}, 0.0] }}\n",
            from, from);
    const Film film(labelled("hang = { links = 1, length = 1.0 }\n" + ropes));
    std::vector<int> rows;
    for (const view::BodyLabel& label : film.look().overlay.labels) rows.push_back(label.row);
    EXPECT_EQ(rows, (std::vector<int>{0, 1, 2, 0}));
    view::DrawList list;
    film::draw(film.look(), film.motion(), 0.0, list);
    std::vector<PixelRect> inks;
    for (const view::Text& text : list.texts) {
        if (!text.utf8.starts_with("label")) continue;
        const PixelRect ink = view::Font().ink(text);
        for (const PixelRect& other : inks) EXPECT_TRUE(ink.intersected(other).empty()) << text.utf8;
        EXPECT_GE(ink.y0, 0);
        inks.push_back(ink);
    }
    EXPECT_EQ(inks.size(), 4U);
}

TEST(FilmLabels, OfAPinKeepClearOfOtherRopes) {
    // The second rope swings by above the pin of the first one; it passes 0.1 m above it.
    const Film film(
        labelled("hang = { links = 1, length = 0.5 }\n",
                 "[[rope]]\nhang = { links = 1, length = 1.0, angle_deg = 80.0, from = [0, 1.1] }\n"));
    const auto [label, scale] = label_at(film, 0.0);
    EXPECT_GT(film.look().overlay.labels.at(0).raise_px, 0.0);
    const State& start = film.state(0);
    const view::PixelPoint other_pin = film.look().map_at(0.0).at(start, 2);
    for (const double time_s : {0.3, 0.5, 0.55, 0.6}) {
        const State state = film.state_at(time_s);
        const view::PixelPoint tip = film.look().map_at(0.0).at(state, 3);
        // The lowest point of the rope over the middle of the label is above or below the label's ink.
        const double share = (0.5 * (label.x0 + label.x1) - other_pin.x) / (tip.x - other_pin.x);
        if (!(share >= 0.0 && share <= 1.0)) continue;
        const double y_px = other_pin.y + share * (tip.y - other_pin.y);
        EXPECT_TRUE(y_px < label.y0 || y_px > label.y1) << time_s;
    }
}

TEST(FilmMask, RefusesMoreBodiesThanItCanDistinguish) {
    std::string scene = "schema = 1\n[world]\nduration = 0.1\n";
    for (int i = 0; i < 256; ++i) scene += "[[rope]]\nhang = { links = 1, length = 1.0 }\n";
    Film film(parse_scene(scene, "bodies.toml"));
    EXPECT_EQ(code_of([&] { static_cast<void>(film.mask(0)); }), ExitCode::kUsage);
}

}  // namespace
}  // namespace corda
