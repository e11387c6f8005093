#include "corda/film/film.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <string>

#include "corda/render/frame_renderer.hpp"
#include "corda/scene/scene.hpp"
#include "support/cancel.hpp"
#include "support/command.hpp"
#include "support/draw_list_of.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using test::equal_images;
using test::failure_of;

const std::string kFigureRope = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 8, length = 1.0, angle_deg = 80.0 }
[solver]
method = "relaxation"
step = 0.005
reach = 1
sweeps = 30
[video]
size = [160, 120]
fps = 30
)";

Scene scene_of(const std::string& more = {}) {
    return parse_scene(kFigureRope + more, "figure.toml");
}

ExitCode code_of(const Film& film, const FigureDef& def) {
    return test::code_of([&] { static_cast<void>(draw_figure(film, def)); });
}

TEST(Strobe, OfOneTimeEqualsTheStill) {
    for (const char* const style : {"", "[style]\ntrail_s = 0.4\n"}) {
        Film film(scene_of(style));
        EXPECT_TRUE(equal_images(draw_figure(film, {.times_s = {0.5}}), film.still(0.5))) << style;
    }
}

TEST(Strobe, ShowsEarlierPosesFainter) {
    Film film(scene_of("[style]\nbackground = \"#000000\"\nsupports = false\npalette = [\"#ffffff\"]\n"));
    const Image strobe = draw_figure(film, {.times_s = {0.0, 0.3, 0.6}});
    const Image first = film.still(0.0);
    const Image second = film.still(0.3);
    const Image last = film.still(0.6);
    int faintest = 255;
    int fainter = 255;
    for (int y = 0; y < strobe.height(); ++y) {
        for (int x = 0; x < strobe.width(); ++x) {
            const int level = strobe.pixel(x, y)[0];
            const bool in_first = first.pixel(x, y)[0] == 255;
            const bool in_second = second.pixel(x, y)[0] == 255;
            const bool in_last = last.pixel(x, y)[0] > 0;
            EXPECT_GE(level, last.pixel(x, y)[0]);
            if (in_first && !in_second && !in_last) faintest = std::min(faintest, level);
            if (in_second && !in_first && !in_last) fainter = std::min(fainter, level);
        }
    }
    EXPECT_EQ(faintest, 51);  // 0.2
    EXPECT_EQ(fainter, 166);  // 0.65
}

TEST(Strobe, EqualsTheReferenceByteForByte) {
    for (const char* const ground : {"#203040", "transparent"}) {
        Film film(scene_of(std::string("[style]\nbackground = \"") + ground + "\"\n"));
        const std::vector<double> times_s{0.0, 0.2, 0.4};
        EXPECT_TRUE(equal_images(draw_figure(film, {.times_s = times_s}),
                                 render::render_reference(test::poses_of(film, times_s))));
    }
}

TEST(Strobe, CanHaveTenThousandPoses) {
    Film film(scene_of());
    FigureDef def;
    for (int k = 0; k < 10'000; ++k) def.times_s.push_back(film.time_s(k % 30));
    std::sort(def.times_s.begin(), def.times_s.end());
    EXPECT_EQ(draw_figure(film, def).width(), 160);
}

TEST(Strobe, RefusesTooManyLines) {
    Scene scene = parse_scene(
        "schema = 1\n[[net]]\ngrid = { columns = 120, rows = 100, spacing = 0.1, diagonals = true "
        "}\n[world]\nduration = 0.1\n"
        "[solver]\nmethod = \"relaxation\"\n[video]\nsize = [64, 64]\nfps = 30\n",
        "net.toml");
    Film film(scene);
    const auto failure = failure_of(
        [&] { static_cast<void>(draw_figure(film, {.times_s = std::vector<double>(10'000, 0.0)})); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_NE(failure.message.find("ask for fewer times"), std::string::npos) << failure.message;
}

TEST(Strobe, RefusesInvalidTimes) {
    for (const char* const style : {"", "[style]\ntrail_s = 0.4\n"}) {
        Film film(scene_of(style));
        for (const std::vector<double>& times_s :
             {std::vector<double>{}, {0.5, 0.2}, {0.0, 1.1}, {-0.1, 0.2}, {0.0, 1e9}, {HUGE_VAL}})
            EXPECT_EQ(code_of(film, {.times_s = times_s}), ExitCode::kUsage);
    }
}

TEST(ContactSheet, ContainsTheStills) {
    Scene scene = scene_of();
    scene.video.width_px = 500;
    scene.video.height_px = 301;
    const FigureDef def = contact_sheet(scene, {0.0, 0.2, 0.4, 0.6, 0.8}, 3);
    EXPECT_EQ(def.columns, 3);
    EXPECT_EQ(scene.video.width_px, (500 - 4 * 3) / 3);
    EXPECT_EQ(scene.video.height_px, (301 - 3 * 3) / 2 - 12);  // 12 for the time
    Film film(scene);
    const Image sheet = draw_figure(film, def);
    EXPECT_EQ(sheet.width(), 500);
    EXPECT_EQ(sheet.height(), 301);
    const Image cell = film.still(0.8);  // the fifth: in the middle of the second row
    const int x0 = 162 + 2 * 3 + (500 - 3 * 162 - 4 * 3) / 2;
    const int y0 = 146 + 2 * 3;
    for (int y = 0; y < cell.height(); ++y)
        EXPECT_TRUE(
            std::equal(cell.pixel(0, y), cell.pixel(0, y) + cell.row_bytes(), sheet.pixel(x0, y0 + y)))
            << y;
}

TEST(ContactSheet, ChoosesColumns) {
    const auto columns = [](int width_px, int height_px, std::size_t count) {
        Scene scene = scene_of();
        scene.video.width_px = width_px;
        scene.video.height_px = height_px;
        return contact_sheet(scene, std::vector<double>(count, 0.0)).columns;
    };
    EXPECT_EQ(columns(1920, 1080, 1), 1);
    EXPECT_EQ(columns(1920, 1080, 2), 2);
    EXPECT_EQ(columns(1920, 1080, 3), 3);
    EXPECT_EQ(columns(1920, 1080, 4), 2);
    EXPECT_EQ(columns(1920, 1080, 6), 3);
    EXPECT_EQ(columns(1920, 1080, 12), 4);
    EXPECT_EQ(columns(1080, 1920, 6), 2);
}

TEST(ContactSheet, RefusesCellsThatDoNotFit) {
    Scene scene = scene_of();
    EXPECT_EQ(
        failure_of([&] { static_cast<void>(contact_sheet(scene, std::vector<double>(500, 0.0))); }).code,
        ExitCode::kUsage);
    EXPECT_EQ(failure_of([&] { static_cast<void>(contact_sheet(scene, {0.0}, -1)); }).code, ExitCode::kUsage);
    Film film(scene);
    for (const FigureDef& def : {FigureDef{{0.0}, -1, 160, 120}, FigureDef{{0.0, 0.1}, 2, 319, 120},
                                 FigureDef{{0.0, 0.1}, 1, 160, 239}, FigureDef{{0.0}, 1, 99999, 120}})
        EXPECT_EQ(code_of(film, def), ExitCode::kUsage);
}

TEST(FigureFiles, AreNotWrittenIfInterrupted) {
    const test::ScratchFolder folder;
    Film film(scene_of());
    for (const char* const name : {"a.png", "a.svg", "a.pdf"}) {
        for (const int enough : {0, 1, 4}) {
            const CancelScope stop = test::cancel_after(enough);
            const auto write = [&] { write_figure(folder.file(name), film, {.times_s = {0.0, 0.1, 0.2}}); };
            EXPECT_EQ(test::code_of(write), ExitCode::kInterrupted) << name << ' ' << enough;
        }
    }
    EXPECT_TRUE(folder.files().empty());
}

TEST(FigureFiles, RefuseOtherEndings) {
    Film film(scene_of());
    EXPECT_EQ(failure_of([&] { write_figure("x.gif", film, {.times_s = {0.0}}); }).code, ExitCode::kUsage);
}

TEST(ContactSheet, RefusesTooManyColumns) {
    for (const int columns : {std::numeric_limits<int>::max(), 100'000}) {
        Scene scene = scene_of();
        EXPECT_EQ(test::code_of([&] {
                      static_cast<void>(contact_sheet(scene, {0.0, 0.1}, columns));
                  }),
                  ExitCode::kUsage);
        Film film(scene_of());
        EXPECT_EQ(
            code_of(film, {.times_s = {0.0, 0.1}, .columns = columns, .width_px = 640, .height_px = 480}),
            ExitCode::kUsage);
    }
}

}  // namespace
}  // namespace corda
