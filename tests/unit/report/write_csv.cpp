#include <gtest/gtest.h>

#include "samples.hpp"

namespace corda::report {
namespace {

TEST(Csv, QuotesAndKeepsEveryDigit) {
    const std::string text = csv_text(small_table());
    EXPECT_EQ(text,
              "method,step_s,error,failure\n"
              "exact,0.10000000000000001,0.33333333333333331,\n"
              "\"a_b, \"\"q\"\" <b>&amp; | *x* 'y' `touch pwned` $(touch pwned) @m \\\","
              "1.0000000000000001e-05,,\n"
              "rattle,0.25,12345,it diverged\n");
    const Table lines{"t", "", {{"k", ""}}, {{"a\nb"}, {"a\rb"}, {""}}, ""};
    EXPECT_EQ(csv_text(lines), "k\n\"a\nb\"\n\"a\rb\"\n\n");
}

}  // namespace
}  // namespace corda::report
