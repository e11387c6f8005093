#include "corda/view/plot_panel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "corda/view/number_text.hpp"
#include "corda/view/overlay.hpp"

namespace corda::view {
namespace {

constexpr int kSamples = 1000;

/// A cosine and its half, over ten seconds.
PlotData waves(double size = 1.0, double shift = 0.0) {
    PlotData data{{"t", "s"}, {"energy", "J"}, 10.0, {{"kinetic"}, {"potential"}}};
    for (int i = 0; i <= kSamples; ++i) {
        const double t = 10.0 * i / kSamples;
        data.curves[0].points.push_back({t, t, shift + size * std::cos(t)});
        data.curves[1].points.push_back({t, t, shift + 0.5 * size * std::cos(t)});
    }
    return data;
}

/// A panel of that data at the time of sample `k`.
DrawList panel_of(const PlotData& data, int width, int height, std::size_t k = kSamples) {
    DrawList list;
    list.width = width;
    list.height = height;
    Font font;
    const StyleDef style;
    const PlotLayout layout = lay_out_plots(1, width, height);
    for (const PixelRect& box : layout.panels) {
        const PlotPanel panel(data, {style, {0, 0, width, height}, box, layout.em_px, {}, font, font});
        panel.draw_curves(data.curves.front().points[k].time_s, list);
        panel.draw_axes(list, font, font);
    }
    return list;
}

std::vector<PixelRect> inks(const DrawList& list) {
    Font font;
    std::vector<PixelRect> boxes;
    for (const Text& text : list.texts) boxes.push_back(font.ink(text));
    return boxes;
}

TEST(PlotPanel, KeepsItsTextsApartAndInTheFrame) {
    int shown = 0;
    for (const auto& [width, height] : {std::pair{3840, 2160},
                                        {1920, 1080},
                                        {1280, 720},
                                        {640, 360},
                                        {256, 144},
                                        {720, 1280},
                                        {180, 320},
                                        {500, 500},
                                        {641, 640},
                                        {2000, 100}}) {
        for (const double size : {1.0, 3e-12, 4.7e9, 1e-280, 1e280}) {
            for (const double shift : {0.0, -40.0 * size, 1e6 * size}) {
                const DrawList list = panel_of(waves(size, shift), width, height);
                const std::vector<PixelRect> boxes = inks(list);
                shown += boxes.empty() ? 0 : 1;
                const PlotLayout room = lay_out_plots(1, width, height);
                for (std::size_t i = 0; i < boxes.size(); ++i) {
                    const std::string what =
                        list.texts[i].utf8 + " at " + std::to_string(width) + "x" + std::to_string(height);
                    EXPECT_TRUE(boxes[i].x0 >= 0 && boxes[i].y0 >= 0) << what;
                    EXPECT_TRUE(boxes[i].x1 <= width && boxes[i].y1 <= height) << what;
                    EXPECT_TRUE(boxes[i].x0 >= room.width_px || boxes[i].y0 >= room.height_px) << what;
                    for (std::size_t k = 0; k < i; ++k) {
                        EXPECT_TRUE(boxes[i].intersected(boxes[k]).empty())
                            << what << " and " << list.texts[k].utf8;
                    }
                }
            }
        }
    }
    EXPECT_GE(shown, 100);
}

TEST(PlotPanel, TakesNoRoomWithoutAPlot) {
    for (int width = 100; width <= 700; width += 37) {
        for (int height = 100; height <= 700; height += 37) {
            const PlotLayout room = lay_out_plots(1, width, height);
            const bool is_reserved = room.width_px < width || room.height_px < height;
            PlotData data = waves();
            data.curves.push_back(data.curves.front());
            data.curves.back().name = "total";
            EXPECT_EQ(panel_of(data, width, height).texts.empty(), !is_reserved) << width << "x" << height;
        }
    }
}

TEST(PlotPanel, DistinguishesLabelsFarFromZero) {
    for (const double shift : {0.0, 1e3, -1e6, 4e8}) {
        const DrawList list = panel_of(waves(0.5, shift), 1280, 720);
        std::vector<std::string> labels;
        for (const Text& text : list.texts) labels.push_back(text.utf8);
        ASSERT_GT(labels.size(), 6U) << shift;
        // Both axes may have a 0.
        labels.erase(std::remove(labels.begin(), labels.end(), "0"), labels.end());
        std::sort(labels.begin(), labels.end());
        EXPECT_EQ(std::adjacent_find(labels.begin(), labels.end()), labels.end()) << shift;
    }
}

TEST(PlotPanel, BreaksCurvesInGaps) {
    PlotData data = waves();
    data.curves.pop_back();
    const auto capsules_at = [&](std::size_t k) { return panel_of(data, 1280, 720, k).capsules; };
    const std::size_t whole = capsules_at(kSamples).size();
    for (std::size_t k = 400; k < 600; ++k)
        data.curves[0].points[k].x = data.curves[0].points[k].y = std::nan("");
    const auto broken = capsules_at(kSamples);
    EXPECT_LT(broken.size(), whole);
    EXPECT_EQ(capsules_at(550).size(), capsules_at(450).size());
    EXPECT_EQ(capsules_at(399).size(), capsules_at(450).size() + 1);  // the gap has no dot
    for (const Capsule& capsule : broken) EXPECT_FALSE(std::isnan(capsule.ax) || std::isnan(capsule.length));
}

TEST(PlotPanel, OmitsAxesThatCannotBeDivided) {
    for (const double size : {1e-305, 1e305}) EXPECT_TRUE(panel_of(waves(size), 1280, 720).texts.empty());
}

TEST(PlotPanel, HasNoRoomInATinyFrame) {
    for (const auto& [width, height] : {std::pair{128, 128}, {64, 64}, {168, 94}, {1, 1}, {16384, 1}}) {
        EXPECT_TRUE(panel_of(waves(), width, height).texts.empty()) << width << "x" << height;
        const PlotLayout room = lay_out_plots(1, width, height);
        if (width < 16384) {
            EXPECT_TRUE(room.width_px == width && room.height_px == height);
        }
    }
}

TEST(PlotPanel, DrawsCurvesUpToNow) {
    const auto last_x = [](std::size_t k) {
        const DrawList list = panel_of(waves(), 1280, 720, k);
        float last = 0.0F;
        for (std::size_t l = 1; l < list.layers.size(); ++l) {  // the first one is the grid
            const Layer& layer = list.layers[l];
            EXPECT_TRUE(layer.is_note);
            for (std::size_t c = 0; c < layer.capsule_count; ++c) {
                const Capsule& capsule = list.capsules[layer.first_capsule + c];
                last = std::max(last, capsule.ax + std::max(0.0F, capsule.ux * capsule.length));
            }
        }
        return last;
    };
    const float start = last_x(0);
    const float end = last_x(kSamples);
    for (const std::size_t k : {100U, 250U, 777U}) {
        EXPECT_NEAR(last_x(k), start + (end - start) * static_cast<float>(k) / kSamples, 0.01F);
    }
}

TEST(PlotPanel, HasTheRangeThatIsGivenAndCutsCurvesThere) {
    PlotData data = waves();
    data.y.range = Interval{-0.3, 0.7};
    const DrawList list = panel_of(data, 1280, 720);
    std::vector<std::string> texts;
    for (const Text& text : list.texts) texts.push_back(text.utf8);
    for (const char* const label : {"−0.2", "0.6"})
        EXPECT_NE(std::ranges::find(texts, label), texts.end()) << label;
    // The horizontal lines of the grid, of which those of -0.2 and 0.6 are 0.8 of the range apart.
    std::vector<float> grid;
    for (std::size_t c = 0; c < list.layers[0].capsule_count; ++c)
        if (list.capsules[c].uy == 0.0F) grid.push_back(list.capsules[c].ay);
    const auto [top, bottom] = std::ranges::minmax(grid);
    const float range = (bottom - top) / 0.8F;
    std::size_t pieces = 0;
    for (std::size_t l = 1; l < list.layers.size(); ++l) {
        const Layer& layer = list.layers[l];
        pieces += layer.capsule_count;
        for (std::size_t c = 0; c < layer.capsule_count; ++c) {
            const Capsule& piece = list.capsules[layer.first_capsule + c];
            for (const float y : {piece.ay, piece.ay + piece.uy * piece.length}) {
                EXPECT_GE(y, top - 0.1F * range - 1.5F);
                EXPECT_LE(y, bottom + 0.1F * range + 1.5F);
            }
        }
    }
    EXPECT_GT(pieces, 300U);
    EXPECT_LT(pieces, panel_of(waves(), 1280, 720).capsules.size());
    // Nothing is left of a curve that stays beyond.
    data.y.range = Interval{2.0, 3.0};
    EXPECT_EQ(panel_of(data, 1280, 720).layers.back().capsule_count, 0U);
}

TEST(PlotPanel, RoundsTheRangeOfALogarithmicAxisOutwards) {
    PlotData data{{"t", "s"}, {"distance", "m"}, 1.0, {{.points = {{0, 0, 1e-3}, {1, 1, 2e-3}}}}};
    data.y.is_log = true;
    data.y.range = Interval{2e-5, 0.3};
    std::vector<std::string> texts;
    for (const Text& text : panel_of(data, 1280, 720, 1).texts) texts.push_back(text.utf8);
    for (const char* const label : {"10⁻⁵", "10⁰"})
        EXPECT_NE(std::ranges::find(texts, label), texts.end()) << label;
}

TEST(PlotPanel, KeepsTheOutlineOfALongMotion) {
    PlotData data{{"t", "s"}, {"x", "m"}, 1000.0, {{""}}};
    for (int i = 0; i <= 100'000; ++i) {
        const double t = 0.01 * i;
        data.curves[0].points.push_back({t, t, i == 50'001 ? 3.0 : std::cos(20.0 * t)});
    }
    const DrawList list = panel_of(data, 1920, 1080, 100'000);
    const Layer& curve = list.layers[1];
    EXPECT_LE(curve.capsule_count, 4U * 691U);
    float highest = 1e9F;
    for (std::size_t c = 0; c < curve.capsule_count; ++c)
        highest = std::min(highest, list.capsules[curve.first_capsule + c].ay);
    // The single point of 3 is drawn at its place: a quarter of the axis from -1 to 3 above 2.
    const DrawList whole =
        panel_of({{"t", "s"}, {"x", "m"}, 1000.0, {{.points = {{0, 0, -1}, {1, 0, 3}}}}}, 1920, 1080, 1);
    float top = 1e9F;
    for (std::size_t c = 0; c < whole.layers[1].capsule_count; ++c)
        top = std::min(top, whole.capsules[whole.layers[1].first_capsule + c].ay);
    EXPECT_EQ(highest, top);
}

/// The colours of the curves, the first in front.
std::vector<Color> colors_of(const PlotData& data, const std::vector<Color>& body_colors, Theme theme) {
    DrawList list;
    list.width = 640;
    list.height = 360;
    Font font;
    StyleDef style;
    style.theme = theme;
    const PlotLayout layout = lay_out_plots(1, list.width, list.height);
    const PlotPanel panel(
        data,
        {style, {0, 0, list.width, list.height}, layout.panels.at(0), layout.em_px, body_colors, font, font});
    panel.draw_curves(10.0, list);
    std::vector<Color> colors;
    for (auto layer = list.layers.rbegin(); layer + 1 != list.layers.rend(); ++layer)
        colors.push_back(layer->color);
    return colors;
}

TEST(PlotPanel, HasOneColorPerQuantityAndThoseOfBodies) {
    using Hue = PlotData::Hue;
    const std::vector<Color> bodies{{0xe6, 0x9f, 0x00}, {0xf0, 0xe4, 0x42}, {0xcc, 0x79, 0xa7}};
    PlotData data = waves();
    for (const Hue hue : {Hue::kX, Hue::kY, Hue::kText}) {
        data.curves.push_back(data.curves.front());
        data.curves.back().hue = hue;
    }
    data.curves[0].hue = Hue::kKinetic;
    data.curves[1].hue = Hue::kPotential;
    for (const Theme theme : {Theme::kDark, Theme::kPaper}) {
        const std::vector<Color> colors = colors_of(data, bodies, theme);
        ASSERT_EQ(colors.size(), 5U);
        for (const Color color : colors) EXPECT_EQ(std::count(colors.begin(), colors.end(), color), 1);
        EXPECT_EQ(colors, colors_of(data, {}, theme));
    }
    data.curves.resize(2);
    data.curves[0].body = 1;
    data.curves[1].body = 0;
    EXPECT_EQ(colors_of(data, bodies, Theme::kDark), (std::vector<Color>{bodies[1], bodies[0]}));
    // Bodies of one colour have curves of two.
    const std::vector<Color> grey(3, Color{0x80, 0x80, 0x80});
    const std::vector<Color> apart = colors_of(data, grey, Theme::kDark);
    EXPECT_FALSE(apart[0] == apart[1]);
}

TEST(PlotPanel, HasARowPerPowerOf10OfALogarithm) {
    PlotData data{{"t", "s"}, {"distance", "m", 0.0, "", true}, 1.0, {{}}};
    for (int i = 0; i <= 8; ++i) data.curves[0].points.push_back({0.125 * i, 0.125 * i, power_of_10(i - 8)});
    const DrawList list = panel_of(data, 1280, 720, 8);
    for (const char* const label : {"10⁻⁸", "10⁻⁶", "10⁰"})
        EXPECT_EQ(std::count_if(list.texts.begin(), list.texts.end(),
                                [&](const Text& text) { return text.utf8 == label; }),
                  1)
            << label;
    // The powers of 10 are evenly apart: the curve is a straight line.
    const Layer& curve = list.layers[1];
    for (std::size_t c = 0; c + 1 < curve.capsule_count; ++c) {
        const Capsule& capsule = list.capsules[curve.first_capsule + c];
        EXPECT_NEAR(capsule.uy / capsule.ux,
                    list.capsules[curve.first_capsule].uy / list.capsules[curve.first_capsule].ux, 1e-4);
    }
}

TEST(PlotPanel, NamesEveryCurveInSmallerLettersIfItMust) {
    PlotData data = waves();
    data.curves[0].name = "kinetisch";
    data.curves[1].name = "potenziell";
    data.curves.push_back(data.curves[0]);
    data.curves[2].name = "gesamt";
    const PlotLayout layout = lay_out_plots(5, 640, 360);
    DrawList list;
    list.width = 640;
    list.height = 360;
    Font font;
    const StyleDef style;
    const PlotPanel panel(data, {style, {0, 0, 640, 360}, layout.panels[0], layout.em_px, {}, font, font});
    panel.draw_axes(list, font, font);
    for (const PlotData::Curve& curve : data.curves) {
        const auto is_name = [&](const Text& text) { return text.utf8 == curve.name; };
        EXPECT_TRUE(std::any_of(list.texts.begin(), list.texts.end(), is_name)) << curve.name;
    }
}

TEST(PlotPanel, LeavesOutNamesThatTakeTooMuchRoom) {
    PlotData data = waves();
    data.curves.resize(1);
    for (int i = 0; i < 15; ++i) {
        data.curves.push_back(data.curves.front());
        data.curves.back().name = "rope with a long name " + std::to_string(i);
    }
    const DrawList list = panel_of(data, 640, 360);
    const auto is_name = [](const Text& text) { return text.utf8.find("rope") != std::string::npos; };
    EXPECT_GT(std::count_if(list.texts.begin(), list.texts.end(), is_name), 0);
    EXPECT_LT(std::count_if(list.texts.begin(), list.texts.end(), is_name), 15);
    EXPECT_EQ(list.layers.size(), 17U);  // the grid and the curves
}

TEST(PlotLayout, PanelsAreApartAndBesideThePicture) {
    for (const auto& [width, height] : {std::pair{3840, 2160},
                                        {1280, 720},
                                        {640, 360},
                                        {320, 180},
                                        {1080, 1920},
                                        {1080, 1080},
                                        {100, 100}}) {
        std::size_t shown = 0;
        for (std::size_t count = 0; count <= 5; ++count) {
            const PlotLayout layout = lay_out_plots(count, width, height);
            EXPECT_LE(layout.panels.size(), count);
            EXPECT_GE(layout.panels.size(), shown) << "at " << width << "x" << height;
            shown = layout.panels.size();
            EXPECT_GE(2 * layout.width_px * layout.height_px, width * height);
            for (std::size_t i = 0; i < layout.panels.size(); ++i) {
                const PixelRect& panel = layout.panels[i];
                EXPECT_EQ(panel.intersected({0, 0, width, height}).width(), panel.width());
                EXPECT_EQ(panel.intersected({0, 0, width, height}).height(), panel.height());
                EXPECT_TRUE(panel.intersected({0, 0, layout.width_px, layout.height_px}).empty());
                for (std::size_t k = 0; k < i; ++k) EXPECT_TRUE(panel.intersected(layout.panels[k]).empty());
            }
        }
        EXPECT_EQ(shown, std::min(width, height) < 180   ? 0U
                         : std::min(width, height) < 360 ? 2U
                                                         : 5U)
            << width << "x" << height;
    }
}

TEST(PlotLayout, EveryPanelHasRoomForItsPlot) {
    for (const auto& [width, height] :
         {std::pair{1280, 720}, {640, 360}, {320, 180}, {1080, 1920}, {1080, 1080}}) {
        for (std::size_t count = 1; count <= 5; ++count) {
            OverlayDef def;
            def.time = def.scale_bar = false;
            def.plots.resize(count);
            PlotData data = waves(123.4, -40.0);
            data.curves.push_back(data.curves.front());
            const std::vector<PlotData> all(count, data);
            const Overlay overlay = make_overlay(def, {}, width, height, 0.02, {.plots = all});
            DrawList list;
            list.width = width;
            list.height = height;
            draw(overlay, {}, 100.0, list);
            const auto titles = std::count_if(list.texts.begin(), list.texts.end(),
                                              [](const Text& text) { return text.utf8 == "energy (J)"; });
            EXPECT_EQ(titles, lay_out_plots(count, width, height).panels.size()) << width << "x" << height;
            const std::vector<PixelRect> boxes = inks(list);
            for (std::size_t i = 0; i < boxes.size(); ++i)
                for (std::size_t k = 0; k < i; ++k)
                    EXPECT_TRUE(boxes[i].intersected(boxes[k]).empty())
                        << list.texts[i].utf8 << " and " << list.texts[k].utf8;
        }
    }
}

TEST(PlotPanel, ShowsConstantValuesAsALine) {
    PlotData data{{"t", "s"}, {"x", "m", 0.5}, 1.0, {{.points = {{0, 0, 3.0}, {1, 1, 3.0 + 1e-9}}}}};
    const auto has = [](const DrawList& list, const std::string& label) {
        return std::any_of(list.texts.begin(), list.texts.end(),
                           [&](const Text& text) { return text.utf8 == label; });
    };
    const DrawList list = panel_of(data, 640, 360, 1);
    EXPECT_TRUE(has(list, "2.8") && has(list, "3") && has(list, "3.2"));
    for (CurvePoint& point : data.curves[0].points) point.y = 0.0;
    const DrawList none = panel_of(data, 640, 360, 1);
    EXPECT_TRUE(has(none, "0.5") && !has(none, "−0.5"));
}

TEST(PlotPanel, ShowsNothingOfTheScene) {
    const DrawList list = panel_of(waves(), 1280, 720);
    EXPECT_GT(list.capsules.size(), 100U);
    EXPECT_TRUE(list.shows_nothing());
}

TEST(PlotPanel, LeavesTheCameraTheRest) {
    OverlayDef def;
    def.plots = {LivePlot::kTip};
    const Insets beside = make_overlay(def, {}, 1280, 720, 0.02).insets;
    EXPECT_EQ(beside.right_panel_px, 461.0);
    EXPECT_EQ(beside.bottom_panel_px, 0.0);
    const Insets below = make_overlay(def, {}, 720, 1280, 0.02).insets;
    EXPECT_EQ(below.right_panel_px, 0.0);
    EXPECT_EQ(below.bottom_panel_px, 461.0);
    MotionBounds bounds;
    bounds.include(-1.0, -1.0);
    bounds.include(1.0, 0.0);
    const std::vector<Drawn> drawn{{.bounds = bounds}};
    const CameraDef fitted = fit_camera({}, {}, drawn, 1280, 720, beside);
    const Camera camera(fitted, {}, 1280, 720);
    EXPECT_NEAR(camera.x_px(-1.0), 0.08 * 720, 1e-9);
    EXPECT_NEAR(camera.x_px(1.0), 1280 - 461 - 0.08 * 720, 1e-9);
}

TEST(PlotPanel, DrawsWhatDoesNotMove) {
    PlotData data{{"x", "m"}, {"vx", "m/s"}, 0.0, {{.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}}}};
    const DrawList list = panel_of(data, 1280, 720, 1);
    EXPECT_GE(list.texts.size(), 4U);
    EXPECT_EQ(list.layers[1].capsule_count, 2U);  // the point, and the dot on it
}

}  // namespace
}  // namespace corda::view
