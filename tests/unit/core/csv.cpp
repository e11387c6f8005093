#include "corda/core/csv.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace corda {
namespace {

TEST(CsvLine, QuotesTextsThatNeedItAndLeavesNanEmpty) {
    CsvLine line;
    line.add("a");
    line.add("b,c");
    line.add("say \"no\"");
    line.add(0.1);
    line.add(std::nan(""));
    line.add(-2.0);
    EXPECT_EQ(line.end(), "a,\"b,c\",\"say \"\"no\"\"\",0.10000000000000001,,-2\n");
    line.add(1.0);
    EXPECT_EQ(line.end(), "1\n");
    EXPECT_EQ(line.end(), "\n");
}

TEST(CsvLine, SeparatesCellsBySemicolonsIfNumbersHaveACommaAsDecimalSign) {
    CsvLine line(CsvStyle::kComma);
    line.add("a,b");
    line.add("c;d");
    line.add(-0.5);
    line.add(2.0);
    line.add(1e-30);
    EXPECT_EQ(line.end(), "a,b;\"c;d\";-0,5;2;1,0000000000000001e-30\n");
}

}  // namespace
}  // namespace corda
