#include "corda/core/markup.hpp"

#include <gtest/gtest.h>

namespace corda {
namespace {

TEST(Markup, EscapesWhatTextAndAttributesCannotHold) {
    EXPECT_EQ(markup_text("a < b & \"c\" > 'd'"), "a &lt; b &amp; &quot;c&quot; &gt; 'd'");
    EXPECT_EQ(markup_text("\x1b[0m \xff ä"), "\\x1b[0m \\xff ä");
}

}  // namespace
}  // namespace corda
