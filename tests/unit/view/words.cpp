#include "corda/view/words.hpp"

#include <gtest/gtest.h>

#include "corda/view/font.hpp"
#include "corda/view/overlay.hpp"

namespace corda::view {
namespace {

constexpr Language kOthers[] = {Language::kGerman, Language::kPortuguese, Language::kSpanish,
                                Language::kFrench};

TEST(Words, KeepUnitsAndIndices) {
    EXPECT_EQ(translated("tension (kN)", Language::kGerman), "Zugkraft (kN)");
    EXPECT_EQ(translated("rope 12", Language::kPortuguese), "corda 12");
    EXPECT_EQ(translated("net 0", Language::kFrench), "filet 0");
    EXPECT_EQ(translated("Angle over time", Language::kSpanish), "Ángulo en el tiempo");
    EXPECT_EQ(translated("8 kg", Language::kGerman), "8 kg");
    EXPECT_EQ(translated("x (mm)", Language::kGerman), "x (mm)");
    EXPECT_EQ(translated("", Language::kGerman), "");
    EXPECT_EQ(translated("12", Language::kGerman), "12");
    EXPECT_EQ(translated("tension (kN)", Language::kEnglish), "tension (kN)");
    EXPECT_EQ(localized("3.1·10⁻¹²", Language::kFrench), "3,1·10⁻¹²");
    EXPECT_EQ(localized("0.5 m", Language::kEnglish), "0.5 m");
}

TEST(Words, AreTextsThatTheFontHasWithTheSamePlaces) {
    Font font;
    for (const char* const english : {"energy",
                                      "kinetic",
                                      "potential",
                                      "total",
                                      "energy error",
                                      "angle",
                                      "angular velocity",
                                      "distance of the tips",
                                      "distance",
                                      "position",
                                      "x of {}",
                                      "rope",
                                      "net",
                                      "speed",
                                      "tension",
                                      "strain",
                                      "error below {} px",
                                      "Report of {}",
                                      "Phase portrait",
                                      "Setting",
                                      "Largest figures, at frame times"}) {
        const auto places = [](const std::string& text) { return text.find("{}") != std::string::npos; };
        for (const Language language : kOthers) {
            const std::string text = translated(english, language);
            EXPECT_FALSE(text.empty()) << english;
            EXPECT_EQ(places(text), places(english)) << english;
            EXPECT_TRUE(font.missing(text).empty()) << text;
        }
        EXPECT_NE(translated(english, Language::kGerman) + translated(english, Language::kPortuguese),
                  std::string(english) + english);
    }
}

TEST(Words, AreThoseOfTheOverlay) {
    OverlayDef def;
    def.energy = true;
    def.language = Language::kGerman;
    StyleDef style;
    style.color_by = ColorBy::kTension;
    ColorScale scale = scale_of(Quantity::kTension, {}, style);
    scale.high = 0.5;
    const Overlay overlay = make_overlay(def, style, 1280, 720, 0.02, {scale, {}, 3.0});
    const auto words = [&](const Caption& caption) {
        DrawList list;
        list.width = 1280;
        list.height = 720;
        draw(overlay, caption, 700.0, list);
        std::string all;
        for (const Text& text : list.texts) all += text.utf8 + "|";
        return all;
    };
    EXPECT_EQ(words({1.25, 3.1e-12, {}}),
              "t = 1,25 s|20 cm|Energiefehler 3,1·10⁻¹²|Zugkraft (N)|0|0,25|0,5|");
    Caption caption{0.5, {}, {}};
    caption.energy = Energy{1.25, -0.5, 0.0};
    EXPECT_NE(words(caption).find("|kinetisch 1,25 J, potenziell −0,50 J|"), std::string::npos);
}

}  // namespace
}  // namespace corda::view
