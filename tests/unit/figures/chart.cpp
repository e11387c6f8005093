#include "corda/figures/chart.hpp"

#include <gtest/gtest.h>

namespace corda::figures {
namespace {

TEST(QuantityText, HasThreeDigitsAndAPrefix) {
    EXPECT_EQ(quantity_text(27345.0, "N"), "27.3 kN");
    EXPECT_EQ(quantity_text(5.0, "m/s"), "5 m/s");
    EXPECT_EQ(quantity_text(0.0, "N"), "0 N");
    EXPECT_EQ(quantity_text(4.9512e-8, "N"), "49.5 nN");
    EXPECT_EQ(quantity_text(-0.5, "J"), "-0.5 J");
}

TEST(QuantityText, OfBareNumbersIsAPower) {
    EXPECT_EQ(quantity_text(0.25123, ""), "0.251");
    EXPECT_EQ(quantity_text(3.04e-12, ""), "3.1·10⁻¹²");
    EXPECT_EQ(quantity_text(0.0, ""), "0");
}

TEST(QuantityText, OfATimeHasFourDigits) {
    EXPECT_EQ(time_text(1.0 / 60.0), "0.01667 s");
    EXPECT_EQ(time_text(10.0), "10 s");
}

Scene styled(const std::string& style, const std::string& rope = "") {
    return parse_scene("schema = 1\n[style]\n" + style + "\n[[rope]]\nhang = { links = 2, length = 1.0 }\n" +
                           rope + "[[rope]]\nhang = { links = 2, length = 1.0 }\n",
                       "scene.toml");
}

std::optional<Theme> theme_on_paper(Scene scene) {
    prefer_paper(scene);
    return scene.style.theme;
}

TEST(Paper, IsTheThemeUnlessTheSceneSaysOtherwise) {
    EXPECT_EQ(theme_on_paper(styled("")), Theme::kPaper);
    EXPECT_EQ(theme_on_paper(styled("theme = \"dark\"")), Theme::kDark);
    EXPECT_EQ(theme_on_paper(styled("background = \"#0e1320\"")), std::nullopt);
    EXPECT_EQ(theme_on_paper(styled("background = \"#fffff0\"")), Theme::kPaper);
    EXPECT_EQ(theme_on_paper(styled("background = \"transparent\"")), Theme::kPaper);
    EXPECT_EQ(theme_on_paper(styled("palette = [\"#c026d3\"]")), Theme::kPaper);
    EXPECT_EQ(theme_on_paper(styled("palette = [\"#c026d3\", \"#fff2a8\"]")), std::nullopt);
    EXPECT_EQ(theme_on_paper(styled("", "color = \"white\"\n")), std::nullopt);
}

TEST(Paper, DetectsContrast) {
    EXPECT_TRUE(shows_on_white({0, 0, 0}));
    EXPECT_TRUE(shows_on_white({0x56, 0xb4, 0xe9}));   // 2.3
    EXPECT_FALSE(shows_on_white({0xfd, 0xb8, 0x40}));  // 1.7
    EXPECT_FALSE(shows_on_white({0, 0, 0, 40}));
}

TEST(Paper, GivesCurvesTheColoursOfTheirBodies) {
    Scene scene = styled("", "color = \"#123456\"\n");
    prefer_paper(scene);
    EXPECT_EQ(curve_colors(scene, {0, 1}), (std::vector<std::string>{"#123456", "#0072b2"}));
    EXPECT_EQ(curve_colors(scene, {1}), std::vector<std::string>{"#0072b2"});
    EXPECT_EQ(curve_colors(styled("palette = [\"#123456\"]"), {0, 1}), (std::vector<std::string>{"", ""}));
    EXPECT_EQ(curve_colors(styled("color_by = \"speed\""), {0}), std::vector<std::string>{""});
}

}  // namespace
}  // namespace corda::figures
