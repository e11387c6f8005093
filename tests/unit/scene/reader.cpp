// Every key of a scene file arrives in its Def, and what a file does not say has its default.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "corda/core/cancel.hpp"
#include "support/failure.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(SceneReader, MinimalFileHasAllDefaults) {
    const Scene scene =
        parse_scene("schema = 1\n[[rope]]\nline = { particles = 2, step = [1, 0] }\n", "a/swing.toml");
    EXPECT_EQ(scene.name, "swing");
    EXPECT_EQ(scene.world.gravity_m_s2, (Vec2{0.0, -9.81}));
    EXPECT_EQ(scene.world.duration_s, 10.0);
    EXPECT_EQ(scene.world.drag_1_s, 0.0);
    ASSERT_EQ(scene.ropes.size(), 1U);
    ASSERT_EQ(scene.body_styles.size(), 1U);
    EXPECT_THAT(scene.ropes[0].mass_kg, ElementsAre(1.0, 1.0));
    EXPECT_THAT(scene.ropes[0].velocity_m_s, ElementsAre(Vec2{}, Vec2{}));
    EXPECT_THAT(scene.ropes[0].pinned, ElementsAre(0U));
    EXPECT_EQ(scene.ropes[0].payload_kg, 0.0);
    EXPECT_FALSE(scene.body_styles[0].color);
    EXPECT_FALSE(scene.body_styles[0].width_px);
    EXPECT_EQ(std::get<AutoDef>(scene.solver).tolerance_px, 0.1);
    EXPECT_EQ(scene.ropes[0].reach, 1);
    EXPECT_EQ(scene.video.width_px, 1920);
    EXPECT_EQ(scene.video.height_px, 1080);
    EXPECT_EQ(scene.video.fps.rational(), (Rational{60, 1}));
    EXPECT_EQ(scene.video.encoder.codec + scene.video.encoder.preset, "");
    EXPECT_FALSE(scene.video.encoder.crf);
    EXPECT_EQ(scene.video.encoder.pix, PixelChoice::kAuto);
    EXPECT_EQ(scene.style.theme, std::nullopt);
    EXPECT_FALSE(scene.style.background);
    EXPECT_TRUE(scene.style.palette.empty());
    EXPECT_FALSE(scene.camera.center_m);
    EXPECT_EQ(scene.camera.margin, 0.08);
}

TEST(SceneReader, World) {
    const Scene scene = parse_scene(with("[world]\ngravity = [1, -2.5]\nduration = 3\ndrag = 0.25\n"), "a");
    EXPECT_EQ(scene.world.gravity_m_s2, (Vec2{1.0, -2.5}));
    EXPECT_EQ(scene.world.duration_s, 3.0);
    EXPECT_EQ(scene.world.drag_1_s, 0.25);
    EXPECT_EQ(parse_scene(with("world.gravity = -1.5"), "a").world.gravity_m_s2, (Vec2{0.0, 1.5}));
    const Vec2 none = parse_scene(with("world.gravity = 0"), "a").world.gravity_m_s2;
    EXPECT_EQ(none, Vec2{});
    EXPECT_FALSE(std::signbit(none.y));
}

TEST(SceneReader, MethodAuto) {
    EXPECT_EQ(std::get<AutoDef>(parse_scene(with("solver.tolerance_px = 2"), "a").solver).tolerance_px, 2.0);
}

TEST(SceneReader, MethodExact) {
    const auto tolerance = [](const std::string& text) {
        const Scene scene = parse_scene(with("[solver]\nmethod = \"exact\"\n" + text), "a");
        EXPECT_EQ(scene.ropes[0].reach, 1);
        return std::get<ExactDef>(scene.solver).tolerance;
    };
    EXPECT_EQ(tolerance(""), ExactDef{}.tolerance);
    EXPECT_EQ(tolerance("tolerance = 1e-15"), 1e-15);
    EXPECT_EQ(tolerance("tolerance = 1e-2"), 1e-2);
}

TEST(SceneReader, MethodRattle) {
    const auto rattle = [](const std::string& text) {
        return std::get<RattleDef>(parse_scene(with("[solver]\nmethod = \"rattle\"\n" + text), "a").solver);
    };
    EXPECT_EQ(rattle("").order, 4);
    EXPECT_FALSE(rattle("").step_s);
    EXPECT_EQ(rattle("order = 8").order, 8);
    EXPECT_EQ(rattle("step = 0.002").step_s, 0.002);
}

TEST(SceneReader, MethodRelaxation) {
    const Scene scene =
        parse_scene(rope_with("[[rope]]\npoints = [[0, 0], [1, 0]]\n"
                              "[solver]\nmethod = \"relaxation\"\nstep = 0.002\nreach = 9\nsweeps = 3\n"
                              "delta = 0.001\nforce = [0.0, -9.8]\n"),
                    "a");
    const auto& def = std::get<RelaxationDef>(scene.solver);
    EXPECT_EQ(def.step_s, 0.002);
    EXPECT_EQ(def.sweeps, 3);
    EXPECT_EQ(def.delta, 0.001);
    EXPECT_EQ(def.force_n, (Vec2{0.0, -9.8}));
    for (const RopeDef& rope : scene.ropes) EXPECT_EQ(rope.reach, 9);  // also for fewer particles
}

TEST(SceneReader, RelaxationHasTheReachOfTheSourceReport) {
    const Scene scene = parse_scene(with("solver.method = \"relaxation\""), "a");
    EXPECT_EQ(scene.ropes[0].reach, 7);
    EXPECT_FALSE(std::get<RelaxationDef>(scene.solver).step_s);
    EXPECT_FALSE(std::get<RelaxationDef>(scene.solver).force_n);
    EXPECT_EQ(solver_name(scene.solver), "relaxation");
}

TEST(SceneReader, Video) {
    const Scene scene = parse_scene(
        with("[video]\nsize = [641, 359]\nfps = \"30000/1001\"\ncodec = \"libx264\"\n"
             "preset = \"slow\"\ncrf = 23\npix = \"444\"\nthreads = 4\nshutter = 0.5\nsubframes = 64\n"),
        "a");
    EXPECT_EQ(scene.video.width_px, 641);
    EXPECT_EQ(scene.video.height_px, 359);
    EXPECT_EQ(scene.video.fps.rational(), (Rational{30000, 1001}));
    EXPECT_EQ(scene.video.encoder.codec, "libx264");
    EXPECT_EQ(scene.video.encoder.preset, "slow");
    EXPECT_EQ(scene.video.encoder.crf, 23);
    EXPECT_EQ(scene.video.encoder.pix, PixelChoice::k444);
    EXPECT_EQ(scene.video.encoder.threads, 4);
    EXPECT_EQ(scene.video.shutter, 0.5);
    EXPECT_EQ(scene.video.subframes, 64);
}

TEST(SceneReader, FrameRates) {
    const auto rate = [](const std::string& fps) {
        return parse_scene(with("video.fps = " + fps), "a").video.fps.rational();
    };
    EXPECT_EQ(rate("25"), (Rational{25, 1}));
    EXPECT_EQ(rate("25.0"), (Rational{25, 1}));
    EXPECT_EQ(rate("\"50/2\""), (Rational{25, 1}));
    EXPECT_EQ(rate("\"1/2\""), (Rational{1, 2}));
    EXPECT_EQ(rate("100000"), (Rational{100000, 1}));
}

TEST(SceneReader, Overlay) {
    const OverlayDef by_default = parse_scene(with(""), "a").overlay;
    EXPECT_FALSE(by_default.time || by_default.scale_bar);
    EXPECT_TRUE(by_default.title.empty() && !by_default.energy && !by_default.method);
    const OverlayDef overlay =
        parse_scene(with("[overlay]\ntime = false\nscale_bar = true\ntitle = \"Schwünge µ\"\nenergy = true\n"
                         "method = true\ntext_px = 33\n"),
                    "a")
            .overlay;
    EXPECT_EQ(overlay.time, false);
    EXPECT_EQ(overlay.scale_bar, true);
    EXPECT_EQ(overlay.title, "Schwünge µ");
    EXPECT_TRUE(overlay.energy && overlay.method);
    EXPECT_EQ(overlay.text_px, 33.0);
    const OverlayTextDef text =
        parse_scene(
            with("[overlay]\ntexts = [{ text = \"a\", fade = 0.5, size = 40, color = \"#010203\" }]\n"), "a")
            .overlay.texts.at(0);
    EXPECT_EQ(text.fade_s, 0.5);
    EXPECT_EQ(text.size_px, 40.0);
    EXPECT_EQ(text.color, (Color{1, 2, 3, 255}));
}

TEST(SceneReader, EmptyListsOfEventsAreNone) {
    const Scene scene =
        parse_scene(rope_with("release = []\ncut = []\nmoves = []\n[overlay]\ntexts = []"), "a");
    EXPECT_TRUE(scene.ropes[0].releases.empty() && scene.ropes[0].cuts.empty() &&
                scene.ropes[0].moves.empty());
}

TEST(SceneReader, Style) {
    const Scene scene = parse_scene(
        with("[style]\nbackground = \"#010203\"\npalette = [\"#ff0000\", \"#00ff0080\"]\nrope_width_px = 3\n"
             "markers = \"all\"\ntrail_s = 1.5\nmarker_radius_px = 5.5\npinned_color = "
             "\"#111111\"\nfree_color = "
             "\"#222222\"\n"
             "bars = \"real\"\nbar_width_px = 1.5\nreal_bar_color = \"#333333\"\n"
             "imaginary_bar_color = \"#44444444\"\n"),
        "a");
    const StyleDef& style = scene.style;
    EXPECT_EQ(style.background, (Ground{{1, 2, 3}, {1, 2, 3}}));
    EXPECT_THAT(style.palette, ElementsAre(Color{255, 0, 0, 255}, Color{0, 255, 0, 128}));
    EXPECT_EQ(style.rope_width_px, 3.0);
    EXPECT_EQ(style.markers, Markers::kAll);
    EXPECT_EQ(style.trail_s, 1.5);
    EXPECT_EQ(style.marker_radius_px, 5.5);
    EXPECT_EQ(style.pinned_color, (Color{0x11, 0x11, 0x11, 255}));
    EXPECT_EQ(style.free_color, (Color{0x22, 0x22, 0x22, 255}));
    EXPECT_EQ(style.bars, Bars::kReal);
    EXPECT_EQ(style.bar_width_px, 1.5);
    EXPECT_EQ(style.real_bar_color, (Color{0x33, 0x33, 0x33, 255}));
    EXPECT_EQ(style.imaginary_bar_color, (Color{0x44, 0x44, 0x44, 0x44}));
    EXPECT_TRUE(style.payload && style.supports && style.halo);
    const StyleDef other =
        parse_scene(with("[style]\ntheme = \"paper\"\nbackground = [\"#010203\", \"#040506\"]\n"
                         "net_width_px = 7\npayload = false\nsupports = false\nhalo = false"),
                    "a")
            .style;
    EXPECT_EQ(other.theme, Theme::kPaper);
    EXPECT_EQ(other.background, (Ground{{1, 2, 3}, {4, 5, 6}}));
    EXPECT_EQ(other.net_width_px, 7.0);
    EXPECT_FALSE(other.payload || other.supports || other.halo);
    EXPECT_EQ(parse_scene(with("style.markers = \"none\""), "a").style.markers, Markers::kNone);
    EXPECT_EQ(parse_scene(with("style.markers = \"pinned\""), "a").style.markers, Markers::kPinned);
    EXPECT_EQ(parse_scene(with("style.bars = \"none\""), "a").style.bars, Bars::kNone);
    EXPECT_EQ(parse_scene(with("style.bars = \"all\""), "a").style.bars, Bars::kAll);
}

TEST(SceneReader, Camera) {
    const Scene scene = parse_scene(with("[camera]\ncenter = [1, -2]\nheight = 4\nmargin = 0.1\n"), "a");
    EXPECT_EQ(scene.camera.center_m, (Vec2{1.0, -2.0}));
    EXPECT_EQ(scene.camera.height_m, 4.0);
    EXPECT_EQ(scene.camera.margin, 0.1);
}

TEST(SceneReader, WindowsLineEndsAndByteOrderMark) {
    const Scene scene =
        parse_scene("\xef\xbb\xbfschema = 1\r\n[[rope]]\r\nline = { particles = 2, step = [1, 0] }\r\n", "a");
    EXPECT_EQ(scene.ropes.size(), 1U);
}

class SceneFile : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  testing::UnitTest::GetInstance()->current_test_info()->name();
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

    static SceneError load_error(const std::string& path) {
        try {
            static_cast<void>(load_scene(path));
            return {};
        } catch (const Error& error) {
            return {error.code(), error.what()};
        }
    }

  private:
    std::filesystem::path folder_;
};

TEST_F(SceneFile, IsReadUnderItsName) {
    std::ofstream(path("my.swing.toml")) << with("video.fps = 24");
    const Scene scene = load_scene(path("my.swing.toml"), {"video.crf=20"});
    EXPECT_EQ(scene.name, "my.swing");
    EXPECT_EQ(scene.video.fps.rational(), (Rational{24, 1}));
    EXPECT_EQ(scene.video.encoder.crf, 20);
}

TEST_F(SceneFile, ThatIsMissingGivesTheReasonOfTheSystem) {
    const SceneError error = load_error(path("none.toml"));
    EXPECT_EQ(error.code, ExitCode::kIo);
    EXPECT_THAT(error.message, StartsWith(path("none.toml") + ": "));
    EXPECT_THAT(error.message, HasSubstr("No such file or directory"));
}

TEST_F(SceneFile, ThatIsAFolderGivesTheReasonOfTheSystem) {
    const SceneError error = load_error(path(""));
    EXPECT_EQ(error.code, ExitCode::kIo);
    EXPECT_THAT(error.message, HasSubstr("Is a directory"));
}

TEST_F(SceneFile, WithoutEndIsRefusedAtTheLimit) {
    const SceneError error = load_error("/dev/zero");
    EXPECT_EQ(error.code, ExitCode::kInvalidScene);
    EXPECT_THAT(error.message, HasSubstr("over the limit of 16777216 bytes"));
}

TEST(SceneReader, ColoursOfLinks) {
    const Scene scene = parse_scene(
        "schema = 1\n[style]\ncolor_by = \"link\"\n[overlay]\nlegend = true\n[[rope]]\nhang = { links = 2, "
        "length = 1 }\ncolor = [\"#ff000080\", \"#00ff0080\"]\n[[rope]]\nhang = { links = 2, length = 1 }\n",
        "a");
    EXPECT_EQ(scene.style.color_by, ColorBy::kLink);
    EXPECT_EQ(scene.overlay.legend, true);
    EXPECT_THAT(scene.body_styles[0].link_colors, ElementsAre(Color{255, 0, 0, 128}, Color{0, 255, 0, 128}));
    EXPECT_FALSE(scene.body_styles[0].color);
    EXPECT_TRUE(scene.body_styles[1].link_colors.empty());
}

TEST(SceneReader, PalettesOfAnyNumberOfColours) {
    std::string colors;
    for (int i = 0; i < 1000; ++i) colors += "\"red\", ";
    EXPECT_EQ(parse_scene(with("[style]\npalette = [" + colors + "]"), "a").style.palette.size(), 1000U);
}

// Longer than the blocks in which the parser gets a text, and with a byte order mark, after which it goes
// back.
TEST(SceneReader, LongFilesAreReadUntilCancelled) {
    std::string points;
    for (int i = 0; i < 20'000; ++i) points += "[" + std::to_string(i) + ".25, 1.5],\n";
    const std::string text = "\xef\xbb\xbfschema = 1\n[[rope]]\nstring = true\npoints = [" + points + "]\n";
    ASSERT_GT(text.size(), 200'000U);
    int asked = 0;
    const auto parse_until = [&](int last) {
        const CancelScope stop([&] { return ++asked != last; });
        return parse_scene(text, "a");
    };
    const Scene scene = parse_until(0);
    EXPECT_EQ(scene.ropes[0].points_m.size(), 20'000U);
    EXPECT_EQ(scene.ropes[0].points_m.back().x - scene.ropes[0].points_m.front().x, 19'999.0);
    EXPECT_GE(asked, 7);
    for (int last = asked; last > 0; --last) {
        asked = 0;
        EXPECT_EQ(test::code_of([&] { std::ignore = parse_until(last); }), ExitCode::kInterrupted) << last;
    }
}

TEST(SceneReader, FrameRatesOfUpToThreeDecimalsAreExact) {
    const auto rate_of = [](const std::string& fps) {
        return parse_scene(with("[video]\nfps = " + fps), "a").video.fps.rational();
    };
    EXPECT_EQ(rate_of("12.5"), (Rational{25, 2}));
    EXPECT_EQ(rate_of("\"12.5\""), (Rational{25, 2}));
    EXPECT_EQ(rate_of("0.5"), (Rational{1, 2}));
    EXPECT_EQ(rate_of("7.25"), (Rational{29, 4}));
    EXPECT_EQ(rate_of("0.001"), (Rational{1, 1000}));
    EXPECT_EQ(rate_of("99999.999"), (Rational{99'999'999, 1000}));
    EXPECT_EQ(rate_of("60.0"), (Rational{60, 1}));
    EXPECT_EQ(rate_of("\"60.000\""), (Rational{60, 1}));
}

}  // namespace
}  // namespace corda::scene
