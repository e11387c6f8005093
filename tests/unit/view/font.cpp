#include "corda/view/font.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "support/failure.hpp"

namespace corda::view {
namespace {

DrawList frame_of(int width, int height) {
    DrawList list;
    list.width = width;
    list.height = height;
    return list;
}

/// A text as pixels.
DrawList written(const std::string& utf8, int size_px) {
    DrawList list = frame_of(2000, 200);
    Font font;
    font.write({20, 150, size_px, {}, utf8}, list);
    return list;
}

TEST(Font, NamesEveryCharacterThatItLacks) {
    const Font font;
    EXPECT_EQ(font.missing("Pendel · ½ m, φ = 30° − 1.2·10⁻³"), U"");
    EXPECT_EQ(font.missing("a ball of yarn \U0001f9f6, क \U0001f9f6"), U"\U0001f9f6\u0915");
    EXPECT_EQ(font.missing("two\nlines"), U"\n");
}

constexpr const char* kSerif = "/usr/share/fonts/truetype/dejavu/DejaVuSerif.ttf";

TEST(Fonts, AreReadFromFiles) {
    Font sans;
    Font serif(kSerif);
    EXPECT_NE(serif.width_px("pendulum", 32), sans.width_px("pendulum", 32));
    DrawList list = frame_of(400, 100);
    serif.write({50, 50, 30, {}, "text"}, list);
    EXPECT_EQ(list.texts[0].font, kSerif);
    sans.write({50, 50, 30, {}, "text"}, list);
    EXPECT_EQ(list.texts[1].font, "");
    for (const char* const bad : {"none.ttf", "/dev/null", "/usr", "/proc/self/exe"})
        EXPECT_EQ(test::code_of([&] { const Font font(bad); }), ExitCode::kInvalidScene) << bad;
}

TEST(Fonts, NameAllThatTheyLackAtOnce) {
    EXPECT_FALSE(missing_glyphs({"", ""}, "", ""));
    EXPECT_FALSE(missing_glyphs({"a", "φ"}, "", ""));
    EXPECT_EQ(missing_glyphs({"漢a", "漢字"}, "", "")->text(),
              "DejaVu Sans has no U+6F22, U+5B57; name a font that has all characters (overlay.font = "
              "\"file.ttf\"), or leave these characters out");
    EXPECT_THAT(missing_glyphs({"漢"}, kSerif, "serif.ttf")->text(),
                testing::StartsWith("'serif.ttf' has no U+6F22;"));
    // DejaVu Sans has the Arabic letters.
    EXPECT_EQ(
        missing_glyphs({"world \u0633\u0644"}, "", "")->text(),
        "the letters of U+0633, U+0644 change next to others, which is not done; leave these characters "
        "out");
    for (const char32_t character : {0x05d0, 0x0628, 0x0915, 0x0e01}) EXPECT_TRUE(needs_shaping(character));
    for (const char32_t character : {0x0041, 0x0416, 0x6f22, 0x10d0}) EXPECT_FALSE(needs_shaping(character));
}

TEST(Fonts, HaveDigitsOfOneWidth) {
    Font font;
    for (const int size_px : {8, 11, 16, 27, 54}) {
        for (char digit = '0'; digit <= '9'; ++digit)
            EXPECT_EQ(font.width_px(std::string(1, digit), size_px), font.width_px("0", size_px)) << size_px;
        EXPECT_EQ(font.width_px("12.34", size_px),
                  4 * font.width_px("0", size_px) + font.width_px(".", size_px));
    }
}

TEST(Fonts, PaintAllThatTheirInkHolds) {
    for (const int size_px : {9, 16, 48}) {
        Font font;
        const PixelRect ink = font.ink({20, 150, size_px, {}, "Ägypten"});
        const DrawList list = written("Ägypten", size_px);
        ASSERT_EQ(list.stamps.size(), 1U);
        EXPECT_EQ(list.stamps[0].box, ink);
        EXPECT_LT(ink.y0, 150);
        EXPECT_GT(ink.y1, 150);  // descenders
        EXPECT_GE(ink.x0, 20);
        // Every edge of the box has something on it.
        const auto at = [&](int x, int y) {
            return list.coverage[static_cast<std::size_t>(y - ink.y0) * ink.width() + (x - ink.x0)];
        };
        int top = 0;
        int right = 0;
        for (int x = ink.x0; x < ink.x1; ++x) top = std::max<int>(top, at(x, ink.y0));
        for (int y = ink.y0; y < ink.y1; ++y) right = std::max<int>(right, at(ink.x1 - 1, y));
        EXPECT_GT(top, 0);
        EXPECT_GT(right, 0);
        ASSERT_EQ(list.texts.size(), 1U);
        EXPECT_EQ(list.texts[0].utf8, "Ägypten");
    }
}

TEST(Fonts, HaveMinusSignsSuperscriptsAndGreekLetters) {
    const DrawList box = written("\uffff", 32);
    for (const char* text :
         {"\u2212", "\u00b2", "\u207b", "\u2077", "\u00b5", "\u03b1", "\u00b0", "\u0416", "\u00b7"})
        EXPECT_NE(written(text, 32).coverage, box.coverage) << text;
}

TEST(Fonts, ShowUnknownCharactersAsBoxes) {
    const DrawList box = written("\uffff", 32);
    ASSERT_EQ(box.stamps.size(), 1U);
    EXPECT_EQ(written("\U0001f9f6", 32).coverage, box.coverage);  // a ball of yarn
    EXPECT_EQ(written("\n", 32).coverage, box.coverage);
    const DrawList replaced = written("\ufffd", 32);
    for (const char* bytes : {"\xff", "\x80", "\xe2\x88", "\xc3"}) {
        const DrawList list = written(bytes, 32);
        ASSERT_FALSE(list.stamps.empty()) << bytes;
    }
    EXPECT_EQ(written("\xff", 32).coverage, replaced.coverage);
    EXPECT_EQ(written("\xc3", 32).coverage, replaced.coverage);
    // A character after a cut one is drawn.
    EXPECT_EQ(written("\xc3z", 32).coverage, written("\ufffdz", 32).coverage);
}

TEST(Fonts, ClipTextToTheFrame) {
    Font font;
    DrawList whole = frame_of(400, 100);
    font.write({50, 50, 30, {}, "text"}, whole);
    const PixelRect box = whole.stamps[0].box;
    DrawList cut = frame_of(box.x0 + 20, 50);
    font.write({50, 50, 30, {}, "text"}, cut);
    ASSERT_EQ(cut.stamps.size(), 1U);
    EXPECT_EQ(cut.stamps[0].box, (PixelRect{box.x0, box.y0, box.x0 + 20, std::min(box.y1, 50)}));
    EXPECT_EQ(cut.coverage[20], whole.coverage[static_cast<std::size_t>(box.width())]);
    for (const auto& [x, y] : {std::pair{-500, 50}, {50, -500}, {500, 50}, {50, 500}}) {
        DrawList list = frame_of(400, 100);
        font.write({x, y, 30, {}, "text"}, list);
        EXPECT_TRUE(list.stamps.empty());
    }
    DrawList list = frame_of(400, 100);
    font.write({50, 50, 30, {}, ""}, list);
    font.write({50, 50, 30, {}, "  "}, list);
    EXPECT_TRUE(list.stamps.empty() && list.texts.empty());
}

}  // namespace
}  // namespace corda::view
