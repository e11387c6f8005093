#include "corda/view/overlay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "corda/view/font.hpp"

namespace corda::view {
namespace {

constexpr double kFrameS = 1.0 / 60.0;

DrawList drawn(const OverlayDef& def, const Caption& caption, int width, int height,
               double pixels_per_metre = 100.0, const StyleDef& style = {}) {
    DrawList list;
    list.width = width;
    list.height = height;
    draw(make_overlay(def, style, width, height, kFrameS), caption, pixels_per_metre, list);
    return list;
}

using Words = std::vector<std::string>;

Words words(const DrawList& list) {
    Words all;
    for (const Text& text : list.texts) all.push_back(text.utf8);
    return all;
}

/// With everything but a scale bar off.
OverlayDef bar_alone() {
    OverlayDef def;
    def.time = false;
    return def;
}

TEST(Overlays, ShowTimeAndScaleByDefaultInFramesThatAreLargeEnough) {
    const Caption caption{1.2, {}, {}};
    EXPECT_EQ(words(drawn({}, caption, 640, 360)), (Words{"t = 1.20 s", "1 m"}));
    EXPECT_EQ(words(drawn({}, caption, 160, 160)), (Words{"t = 1.20 s", "20 cm"}));
    EXPECT_TRUE(words(drawn({}, caption, 320, 159)).empty());
    OverlayDef always;
    always.time = true;
    EXPECT_EQ(words(drawn(always, caption, 100, 50)), Words{"t = 1.20 s"});
    EXPECT_EQ(words(drawn(bar_alone(), caption, 640, 360)), Words{"1 m"});
    EXPECT_EQ(words(drawn({}, {}, 640, 360)), Words{"1 m"});  // a caption without a time
}

TEST(Overlays, HaveTextOfTheRequestedSize) {
    OverlayDef def;
    def.text_px = 33.0;
    const DrawList list = drawn(def, {1.2, {}, {}}, 1004, 565);
    ASSERT_EQ(list.texts.size(), 2U);
    for (const Text& text : list.texts) EXPECT_EQ(text.size_px, 33);
    EXPECT_EQ(drawn({}, {1.2, {}, {}}, 1004, 565).texts[0].size_px, 14);
}

TEST(Overlays, AreOffByDefaultOnATransparentGround) {
    StyleDef style;
    style.background = Ground{{0, 0, 0, 255}, {0, 0, 0, 0}};
    const Caption caption{1.2, {}, {}};
    EXPECT_TRUE(words(drawn({}, caption, 640, 360, 100.0, style)).empty());
    OverlayDef always;
    always.scale_bar = true;
    EXPECT_EQ(words(drawn(always, caption, 640, 360, 100.0, style)), Words{"1 m"});
}

TEST(Overlays, KeepTheirPlacesWhateverTheDuration) {
    OverlayDef def;
    def.energy = true;
    const auto texts = [&](double time_s) { return drawn(def, {time_s, 1e-9, {}}, 640, 360).texts; };
    EXPECT_EQ(texts(9.5)[0].utf8, "t = 9.50 s");
    EXPECT_EQ(texts(99.5)[0].utf8, "t = 99.50 s");
    EXPECT_EQ(texts(9.5)[0].x_px, texts(999.5)[0].x_px);
    // The energy, to the right of the time.
    ASSERT_EQ(texts(9.5).back().utf8, texts(99.5).back().utf8);
    EXPECT_EQ(texts(9.5).back().x_px, texts(99.5).back().x_px);
    EXPECT_LT(texts(9.5).back().x_px, texts(100.0).back().x_px);
    DrawList list;
    list.width = list.height = 400;
    draw(make_overlay({}, {}, 400, 400, 1.0 / 1500.0), {0.25, {}, {}}, 100.0, list);
    EXPECT_EQ(list.texts[0].utf8, "t = 0.2500 s");
}

TEST(Overlays, ShowEnergiesWithoutAnErrorInTheUnitOfTheScene) {
    OverlayDef def;
    def.scale_bar = false;
    def.energy = true;
    const auto text = [&](double kinetic_j, double potential_j, double scale_j) {
        const Overlay overlay = make_overlay(def, {}, 640, 360, 0.02, {.energy_scale_j = scale_j});
        DrawList list;
        list.width = 640;
        list.height = 360;
        draw(overlay, {1.0, {}, {}, {}, Energy{kinetic_j, potential_j, 0.0}}, 100.0, list);
        return list.texts.back().utf8;
    };
    EXPECT_EQ(text(1.2345, -0.5, 9.0), "kinetic 1.23 J, potential −0.50 J");
    EXPECT_EQ(text(0.0, 0.0, 9.0), "kinetic 0.00 J, potential 0.00 J");
    EXPECT_EQ(text(1234.5, -0.004, 2e4), "kinetic 1.2 kJ, potential 0.0 kJ");
    EXPECT_EQ(text(0.5, 0.25, 0.8), "kinetic 0.50 J, potential 0.25 J");
    EXPECT_EQ(drawn(def, {1.0, {}, {}}, 640, 360).texts.size(), 1U);
}

TEST(Overlays, HaveAScaleBarOfItsLength) {
    for (const auto& [scale, label, length_px] : {std::tuple{100.0, "1 m", 100},
                                                  {33.0, "2 m", 66},
                                                  {0.01, "10 km", 100},
                                                  {7e4, "1 mm", 70},
                                                  {1e10, "10 nm", 100},
                                                  {216.0, "50 cm", 108}}) {
        const DrawList list = drawn(bar_alone(), {}, 640, 360, scale);
        EXPECT_EQ(words(list), Words{label}) << scale;
        PixelRect bar;
        for (const Stamp& stamp : list.stamps) {
            if (stamp.first_coverage == Stamp::kSolid) bar = bar.united(stamp.box);
        }
        EXPECT_EQ(bar.width(), length_px) << scale;
        EXPECT_EQ(bar.x1, 640 - 11);
    }
}

/// With the longest strings, in frames of all shapes.
TEST(Overlays, AreNeverCutAndNeverMeet) {
    OverlayDef all;
    all.time = all.scale_bar = all.energy = all.method = true;
    all.title = "Ein Seil schwingt, Ägäis, und der Titel hört nicht auf: 中文 \u2212\u00b2 gjpqy";
    const Caption caption{123456.789, 1.23e-100, "exact, rattle, relaxation, error below 3.1·10⁻¹² px"};
    for (const auto& [width, height] : {std::pair{1920, 1080},
                                        {1080, 1920},
                                        {640, 360},
                                        {168, 94},
                                        {64, 64},
                                        {30, 200},
                                        {16, 16},
                                        {1, 1}}) {
        SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
        const DrawList list = drawn(all, caption, width, height, 0.37);
        Font font;
        for (const Text& text : list.texts) {
            const PixelRect ink = font.ink(text);
            EXPECT_EQ(ink.intersected({0, 0, width, height}), ink) << text.utf8;
        }
        for (std::size_t i = 0; i < list.stamps.size(); ++i) {
            for (std::size_t k = 0; k < i; ++k)
                EXPECT_TRUE(list.stamps[i].box.intersected(list.stamps[k].box).empty()) << i << ", " << k;
        }
        EXPECT_TRUE(width < 640 || list.texts.size() == 5U) << list.texts.size();
        // What the camera fits is clear of them.
        const Insets insets = make_overlay(all, {}, width, height, kFrameS).insets;
        EXPECT_LE(insets.top_px + insets.bottom_px, 0.5 * height + 1e-9);
        if (height < 200) continue;
        for (const Stamp& stamp : list.stamps)
            EXPECT_TRUE(stamp.box.y1 <= insets.top_px || stamp.box.y0 >= height - insets.bottom_px);
    }
}

TEST(Overlays, StandOutFromTheirGround) {
    for (const auto& [ground, is_dark] :
         {std::pair{Color{0xff, 0xff, 0xf0}, true}, {Color{0x10, 0x10, 0x30}, false}}) {
        StyleDef style;
        style.background = Ground{ground, ground};
        const DrawList list = drawn(bar_alone(), {}, 640, 360, 100.0, style);
        EXPECT_EQ(list.texts[0].color.g < 128, is_dark);
    }
}

StyleDef by_tension() {
    StyleDef style;
    style.color_by = ColorBy::kTension;
    return style;
}

ColorScale kilonewtons(double low = 0.0) {
    sim::Histogram histogram;
    histogram.add(20e3);
    if (low < 0.0) histogram.add(low);
    return scale_of(Quantity::kTension, histogram, by_tension());
}

DrawList with_legend(const ColorScale& scale, OverlayDef def, int width, int height) {
    DrawList list;
    list.width = width;
    list.height = height;
    def.time = def.scale_bar = false;
    def.legend = true;
    draw(make_overlay(def, by_tension(), width, height, kFrameS, {scale}), {}, 100.0, list);
    return list;
}

TEST(Legends, NameTheirUnitAndTheEndsOfTheScale) {
    EXPECT_EQ(words(with_legend(kilonewtons(), {}, 960, 540)), (Words{"tension (kN)", "0", "10", "20"}));
    EXPECT_EQ(words(with_legend(kilonewtons(-5e3), {}, 960, 540)), (Words{"tension (kN)", "−20", "0", "20"}));
    ColorScale cut = kilonewtons(-5e3);
    cut.is_cut_low = cut.is_cut_high = true;
    EXPECT_EQ(words(with_legend(cut, {}, 960, 540)), (Words{"tension (kN)", "≤ −20", "0", "≥ 20"}));
}

TEST(Legends, StayInTheirFrameAndKeepClearOfTheTitle) {
    OverlayDef def;
    def.title =
        "a title that is a good deal longer than the room to the left of the legend of a picture, even "
        "in the size of the other texts";
    for (const auto& [width, height] :
         {std::pair{128, 128}, {160, 90}, {960, 540}, {540, 960}, {3840, 2160}}) {
        const DrawList list = with_legend(kilonewtons(), def, width, height);
        ASSERT_GE(list.texts.size(), 4U) << width;
        Font font;
        PixelRect legend;
        for (std::size_t i = 0; i < 4; ++i) legend = legend.united(font.ink(list.texts[i]));
        for (const Text& text : list.texts) {
            const PixelRect ink = font.ink(text);
            EXPECT_EQ(ink, ink.intersected({0, 0, width, height})) << text.utf8;
        }
        for (std::size_t i = 4; i < list.texts.size(); ++i) {
            const PixelRect ink = font.ink(list.texts[i]);
            EXPECT_TRUE(ink.x1 < legend.x0 || ink.y0 >= legend.y1) << width;
        }
        OverlayDef alone;
        alone.legend = true;
        alone.time = false;
        const Insets insets = make_overlay(alone, by_tension(), width, height, kFrameS).insets;
        for (std::size_t i = 1; i < 4; ++i) EXPECT_LE(font.ink(list.texts[i]).y1, insets.top_px) << width;
    }
}

TEST(Overlays, ShortenATitleBetweenWordsAndAMethodBetweenItsParts) {
    OverlayDef def;
    def.title = "three ropes of very different masses that swing side by side";
    def.method = true;
    def.time = def.scale_bar = false;
    const Caption caption{0.0, {}, "exact, relaxation, error below 0.0012 px"};
    int shortened = 0;
    for (int width = 170; width < 700; width += 7) {
        for (const std::string& text : words(drawn(def, caption, width, 150))) {
            if (!text.ends_with("…")) continue;
            ++shortened;
            const std::string kept = text.substr(0, text.size() - std::string("…").size());
            const bool is_title =
                def.title.starts_with(kept + " ") || Font().width_px(text, em_of(150)) > width / 2;
            EXPECT_TRUE(is_title || caption.method.starts_with(kept + ", ")) << text;
        }
    }
    EXPECT_GE(shortened, 20);
}

TEST(Titles, UseTheirRoomBeforeTheyAreCut) {
    OverlayDef def;
    def.time = def.scale_bar = false;
    def.title = "A double pendulum of two ropes, released from 60 degrees, at a quarter of its speed";
    const auto title = [&def](int width) { return drawn(def, {}, width, 720).texts.at(0); };
    const Text whole = title(1920);
    const Text smaller = title(1100);
    EXPECT_EQ(smaller.utf8, def.title);
    EXPECT_LT(smaller.size_px, whole.size_px);
    EXPECT_GE(smaller.size_px, em_of(720));
    EXPECT_GT(Font().width_px(smaller.utf8, smaller.size_px + 1), 1100 - 2 * smaller.x_px);
    const auto lines = words(drawn(def, {}, 600, 600));
    EXPECT_EQ(lines, (Words{"A double pendulum of two ropes, released from 60",
                            "degrees, at a quarter of its speed"}));
    const auto cut = words(drawn(def, {}, 200, 200));
    ASSERT_EQ(cut.size(), 3U);
    EXPECT_TRUE(cut.back().ends_with("…"));
    EXPECT_EQ(drawn(def, {}, 150, 150).texts.size(), 1U);  // tiny frames are for the picture
    def.title = "Seile: Donaudampfschifffahrtsgesellschaftskapitaensmuetzenhalterungsbefestigung";
    const Text word = drawn(def, {}, 600, 720).texts.at(1);  // below "Seile:"
    EXPECT_TRUE(word.utf8.ends_with("…"));
    EXPECT_GT(Font().width_px(word.utf8, word.size_px), 450);
}

TEST(Titles, StandBelowALegendThatLeavesThemNoRoom) {
    OverlayDef def;
    def.title = "Zwei Seile, eine sehr lange Überschrift, die nicht in eine Zeile passt";
    const DrawList list = with_legend(kilonewtons(), def, 640, 720);
    EXPECT_EQ(list.texts.at(4).utf8, def.title);
    EXPECT_GT(Font().ink(list.texts[4]).y0, Font().ink(list.texts[1]).y1);
    EXPECT_EQ(with_legend(kilonewtons(), def, 450, 720).texts.size(), 7U);
    // Next to it, several lines as well, of which the last alone is shortened, if any.
    for (int width = 400; width < 1400; width += 50) {
        const Words all = words(with_legend(kilonewtons(), def, width, 500));
        for (std::size_t i = 4; i + 1 < all.size(); ++i) EXPECT_FALSE(all[i].ends_with("…")) << all[i];
    }
}

TEST(Methods, StandBelowALegendThatLeavesThemNoRoom) {
    OverlayDef def;
    def.method = true;
    def.legend = true;
    def.time = def.scale_bar = false;
    const Caption caption{0.0, {}, "exact, error below 0.0012 px"};
    for (const auto& [width, is_below] : {std::pair{500, true}, {1280, false}}) {
        DrawList list;
        list.width = width;
        list.height = 720;
        const Overlay overlay = make_overlay(def, by_tension(), width, 720, kFrameS, {kilonewtons()});
        draw(overlay, caption, 100.0, list);
        ASSERT_EQ(list.texts.size(), 5U);
        EXPECT_EQ(list.texts[4].utf8, caption.method);
        EXPECT_EQ(Font().ink(list.texts[4]).y0 > Font().ink(list.texts[1]).y1, is_below);
        EXPECT_GT(overlay.insets.top_px, list.texts[4].y_px);
    }
}

TEST(Titles, OfSeveralLinesMoveThePictureDown) {
    OverlayDef def;
    def.time = def.scale_bar = false;
    def.title = "short";
    const double one_px = make_overlay(def, {}, 600, 600, kFrameS).insets.top_px;
    def.title = "A double pendulum of two ropes, released from 60 degrees, at a quarter of its speed";
    const Insets insets = make_overlay(def, {}, 600, 600, kFrameS).insets;
    EXPECT_GT(insets.top_px, one_px);
    const DrawList list = drawn(def, {}, 600, 600);
    ASSERT_EQ(list.texts.size(), 2U);
    EXPECT_LT(Font().ink(list.texts[1]).y1, insets.top_px);
}

TEST(Overlays, ShowTextsForTheirTime) {
    OverlayDef def;
    def.time = def.scale_bar = false;
    def.texts = {{"released", {0.5, 0.1}, 0.0, 1.5}, {"free", {1.0, 0.5}, 1.5, {}}};
    EXPECT_EQ(words(drawn(def, {1.0, {}, {}}, 640, 360)), Words{"released"});
    EXPECT_EQ(words(drawn(def, {1.5, {}, {}}, 640, 360)), Words{"free"});
    EXPECT_TRUE(words(drawn(def, {}, 640, 360)).empty());  // a picture of several poses
    const Text released = drawn(def, {1.0, {}, {}}, 640, 360).texts.at(0);
    const PixelRect ink = Font().ink(released);
    EXPECT_NEAR(0.5 * (ink.x0 + ink.x1), 320.0, 1.0);
    EXPECT_NEAR(0.5 * (ink.y0 + ink.y1), 36.0, 1.0);
    EXPECT_LT(Font().ink(drawn(def, {2.0, {}, {}}, 640, 360).texts.at(0)).x1, 640);
}

TEST(Overlays, TextsHaveTheirSizeAndColourAndFade) {
    OverlayDef def;
    def.time = def.scale_bar = false;
    def.texts = {{.text = "a",
                  .from_s = 1.0,
                  .to_s = 3.0,
                  .fade_s = 0.5,
                  .size_px = 40.0,
                  .color = Color{9, 8, 7, 200}},
                 {.text = "b", .from_s = 1.0, .fade_s = 1.0}};
    const auto texts = [&](double time_s) { return drawn(def, {time_s, {}, {}}, 640, 360).texts; };
    EXPECT_EQ(texts(2.0)[0].size_px, 40);
    EXPECT_EQ(texts(2.0)[0].color, (Color{9, 8, 7, 200}));
    EXPECT_EQ(texts(1.25)[0].color.a, 100);
    EXPECT_EQ(texts(2.875)[0].color.a, 50);
    EXPECT_EQ(texts(1.5)[1].color.a, 128);
    EXPECT_EQ(texts(9.0)[0].color.a, 255);  // b stays
    EXPECT_LT(texts(2.0)[1].size_px, 20);
}

TEST(Overlays, TellThatMotionIsSlow) {
    const auto shown = [](Rational speed, Language language, bool has_time = true) {
        OverlayDef def;
        def.scale_bar = false;
        def.time = has_time;
        def.language = language;
        DrawList list;
        list.width = 640;
        list.height = 360;
        draw(make_overlay(def, {}, 640, 360, kFrameS, {.speed = speed}), {1.2, {}, {}}, 100.0, list);
        return words(list);
    };
    EXPECT_EQ(shown({1, 4}, Language::kEnglish), (Words{"t = 1.20 s", "1/4 speed"}));
    EXPECT_EQ(shown({1, 4}, Language::kGerman), (Words{"t = 1,20 s", "Tempo 1/4"}));
    EXPECT_EQ(shown({2, 1}, Language::kFrench), (Words{"t = 1,20 s", "vitesse 2×"}));
    EXPECT_EQ(shown({1, 1}, Language::kEnglish), Words{"t = 1.20 s"});
    EXPECT_TRUE(shown({1, 4}, Language::kEnglish, false).empty());
}

TEST(Overlays, PlaceTextsInTheWholePictureAndNeverCutThem) {
    OverlayDef def;
    def.time = def.scale_bar = false;
    def.plots = {LivePlot::kEnergy};
    std::string much = "much";
    for (int i = 0; i < 40; ++i) much += " more";
    def.texts = {
        {"middle", {0.5, 0.5}, 0.0, {}}, {"Ücg", {0.99, 0.01}, 0.0, {}}, {much, {0.5, 0.99}, 0.0, {}}};
    const DrawList list = drawn(def, {1.0, {}, {}}, 640, 360);
    ASSERT_EQ(list.texts.size(), 5U);
    for (const Text& text : list.texts) {
        const PixelRect ink = Font().ink(text);
        EXPECT_EQ(ink.intersected({0, 0, 640, 360}), ink) << text.utf8;
    }
    const PixelRect middle = Font().ink(list.texts[0]);
    EXPECT_NEAR(0.5 * (middle.x0 + middle.x1), 320.0, 1.0);
    EXPECT_TRUE(list.texts[4].utf8.ends_with("more…")) << list.texts[4].utf8;
}

TEST(Overlays, WrapLongTextsBesideThePlots) {
    OverlayDef def;
    def.time = def.scale_bar = false;
    def.plots = {LivePlot::kEnergy};
    const std::string text = "the rope is released from rest and swings through its lowest point";
    for (const auto& [width, height] : {std::pair{640, 360}, {360, 640}}) {
        def.texts = {{text, {0.5, 0.5}, 0.0, {}}};
        const PlotLayout room = lay_out_plots(1, width, height);
        const DrawList list = drawn(def, {1.0, {}, {}}, width, height);
        ASSERT_EQ(list.texts.size(), 2U) << width;
        EXPECT_EQ(list.texts[0].utf8 + " " + list.texts[1].utf8, text);
        EXPECT_GT(Font().ink(list.texts[1]).y0, Font().ink(list.texts[0]).y1);
        for (const Text& line : list.texts) {
            EXPECT_LT(Font().ink(line).x1, room.width_px) << width;
            EXPECT_LT(Font().ink(line).y1, room.height_px) << width;
        }
        def.texts[0].at = {0.9, 0.9};  // over the plot on purpose
        EXPECT_LT(drawn(def, {1.0, {}, {}}, 2 * width, 2 * height).texts.size(), 3U);
    }
}

TEST(Legends, AreLeftOutIfThereIsNoRoomOrNoScale) {
    EXPECT_TRUE(words(with_legend(kilonewtons(), {}, 60, 400)).empty());
    OverlayDef def = bar_alone();
    def.scale_bar = false;
    EXPECT_TRUE(words(drawn(def, {}, 960, 540, 100.0, by_tension())).empty());
    EXPECT_EQ(make_overlay(def, {}, 960, 540, kFrameS).insets.top_px, 0.0);
}

TEST(Titles, OfAMegabyteAreShortenedAtOnce) {
    OverlayDef def = bar_alone();
    def.scale_bar = false;
    def.title.assign(1 << 20, 'x');
    const Words all = words(drawn(def, {}, 640, 360));
    ASSERT_EQ(all.size(), 1U);
    EXPECT_LT(all.front().size(), 100U);
}

}  // namespace
}  // namespace corda::view
