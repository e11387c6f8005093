#include "corda/core/text.hpp"

#include <gtest/gtest.h>
#include <array>
#include <string>

namespace corda {
namespace {

TEST(Text, OfUtf8IsUnchanged) {
    for (const char* text :
         {"", "swing", "caf\xc3\xa9 \xe2\x88\x9e \xf0\x9f\xaa\xa2", "\xc2\xa0 \xed\x9f\xbf \xee\x80\x80",
          "\xef\xbf\xbd \xf0\x90\x80\x80 \xf4\x8f\xbf\xbf", "back\\slash \\x1b"}) {
        EXPECT_EQ(utf8(text), text);
        EXPECT_EQ(printable(text), text);
    }
}

TEST(Text, CountsInWords) {
    EXPECT_EQ(counted(1, "bar"), "1 bar");
    EXPECT_EQ(counted(0, "bar"), "0 bars");
    EXPECT_EQ(counted(12, "column"), "12 columns");
}

TEST(Text, OfOtherBytesIsEscaped) {
    EXPECT_EQ(utf8("caf\xe9.toml"), "caf\\xe9.toml");  // Latin-1
    EXPECT_EQ(utf8("\xc3"), "\\xc3");                  // truncated
    EXPECT_EQ(utf8("\xe2\x88"), "\\xe2\\x88");
    EXPECT_EQ(utf8("\xc3\xa9\xa9"), "\xc3\xa9\\xa9");        // no lead byte
    EXPECT_EQ(utf8("\xc0\xaf\xe0\x80\xaf\xf0\x80\x80\xaf"),  // overlong
              "\\xc0\\xaf\\xe0\\x80\\xaf\\xf0\\x80\\x80\\xaf");
    EXPECT_EQ(utf8("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // a surrogate
    EXPECT_EQ(utf8("\xf4\x90\x80\x80\xff"), "\\xf4\\x90\\x80\\x80\\xff");
    EXPECT_EQ(utf8("\xef\xbf\xbe\xef\xbf\xbf"), "\\xef\\xbf\\xbe\\xef\\xbf\\xbf");
}

TEST(Text, ThatCanBePrintedHasNoControlCharacters) {
    EXPECT_EQ(printable("\x1b[31mred\x07\n\t\x7f"), "\\x1b[31mred\\x07\\x0a\\x09\\x7f");
    EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m\x9b"),
              "\\xc2\\x9b31m\\x9b");  // CSI, as a character and as a byte
    EXPECT_EQ(utf8("\x1b\n\xc2\x9b"), "\x1b\n\xc2\x9b");
    EXPECT_EQ(printable("gnp.\xe2\x80\xae!\xe2\x80\xa8"), "gnp.\\xe2\\x80\\xae!\\xe2\\x80\\xa8");
    EXPECT_EQ(printable("\xe2\x81\xa7\xe2\x81\xaa\xe2\x80\xa7\xe2\x80\xaf"),
              "\\xe2\\x81\\xa7\xe2\x81\xaa\xe2\x80\xa7\xe2\x80\xaf");
}

TEST(Text, HashIsFnv1a) {
    // Test vectors by Noll, http://www.isthe.com/chongo/tech/comp/fnv/
    EXPECT_EQ(hash_text(""), "cbf29ce484222325");
    EXPECT_EQ(hash_text("a"), "af63dc4c8601ec8c");
    EXPECT_EQ(hash_text("foobar"), "85944171f73967e8");
}

}  // namespace

namespace {

constexpr std::array<std::string_view, 6> kWords{"mass",      "points",       "particles",
                                                 "tolerance", "tolerance_px", "fps"};

TEST(EditDistance, CountsSingleEdits) {
    EXPECT_EQ(edit_distance("mass", "mass"), 0U);
    EXPECT_EQ(edit_distance("masss", "mass"), 1U);
    EXPECT_EQ(edit_distance("mas", "mass"), 1U);
    EXPECT_EQ(edit_distance("moss", "mass"), 1U);
    EXPECT_EQ(edit_distance("msas", "mass"), 1U);  // two neighbours swapped
    EXPECT_EQ(edit_distance("MASS", "mass"), 0U);
    EXPECT_EQ(edit_distance("", "mass"), 4U);
    EXPECT_EQ(edit_distance("mass", ""), 4U);
    EXPECT_EQ(edit_distance("saturday", "sunday"), 3U);
}

TEST(Nearest, FindsTheNearestWord) {
    EXPECT_EQ(nearest("masss", kWords), "mass");
    EXPECT_EQ(nearest("Mass", kWords), "mass");
    EXPECT_EQ(nearest("point", kWords), "points");
    EXPECT_EQ(nearest("tolerence", kWords), "tolerance");
    EXPECT_EQ(nearest("tolerance_p", kWords), "tolerance_px");
    EXPECT_EQ(nearest("partcles", kWords), "particles");
    EXPECT_EQ(nearest("part", kWords), "particles");
    EXPECT_EQ(nearest("fbs", kWords), "fps");
    EXPECT_EQ(nearest("fp", kWords), "fps");
}

TEST(Nearest, IsEmptyIfNoneIsClose) {
    EXPECT_FALSE(nearest("", kWords));
    EXPECT_FALSE(nearest("weight", kWords));
    EXPECT_FALSE(nearest("mass_of_balls", kWords));
    EXPECT_FALSE(nearest("ab", kWords));
    EXPECT_FALSE(nearest("it", std::array<std::string_view, 2>{"en", "pt"}));  // half of its letters
    EXPECT_FALSE(nearest(std::string(100'000, 'm'), kWords));
    EXPECT_FALSE(nearest("mass", {}));
}

}  // namespace

}  // namespace corda
