#include "corda/core/markup.hpp"

#include <gtest/gtest.h>

#include <string>

namespace corda {
namespace {

TEST(Markup, EscapesWhatTextAndAttributesCannotHold) {
    EXPECT_EQ(markup_text("a < b & \"c\" > 'd'"), "a &lt; b &amp; &quot;c&quot; &gt; 'd'");
    EXPECT_EQ(markup_text("\x1b[0m \xff ä"), "\\x1b[0m \\xff ä");
}

TEST(Base64, IsReadAsItWasWritten) {
    EXPECT_EQ(base64("foob"), "Zm9vYg==");  // RFC 4648
    std::string bytes;
    for (int i = 0; i < 256; ++i) {
        EXPECT_EQ(from_base64(base64(bytes)), bytes) << i;
        bytes += static_cast<char>(255 - i);
    }
    EXPECT_EQ(from_base64("Zm9v Zm9v"), "");
}

}  // namespace
}  // namespace corda
