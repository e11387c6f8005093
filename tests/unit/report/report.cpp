#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "samples.hpp"

namespace corda::report {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Report, NumbersForPeopleHaveThreeDigits) {
    EXPECT_EQ(short_number(1.0 / 3.0), "0.333");
    EXPECT_EQ(short_number(1.23456e-5), "1.23e-5");
    EXPECT_EQ(short_number(-1.23456e-105), "-1.23e-105");
    EXPECT_EQ(short_number(2.5e12), "2.5e+12");
    EXPECT_EQ(short_number(123456.0), "123456");
    EXPECT_EQ(short_number(1234.5), "1230");
    EXPECT_EQ(short_number(999.7), "1000");
    EXPECT_EQ(short_number(-99950.5), "-100000");
    EXPECT_EQ(short_number(999600.5), "1e+6");
    EXPECT_EQ(short_number(1e6), "1e+6");
    EXPECT_EQ(short_number(-0.0), "0");
    EXPECT_EQ(short_number(kInfinity), "∞");
    EXPECT_EQ(short_number(-kInfinity), "−∞");
    EXPECT_EQ(short_number(std::nan("")), "NaN");
}

TEST(Report, FailureColumnIsShownIfARowFailed) {
    Table table = small_table();
    EXPECT_THAT(html_text({"R", {}, {{"C", {}, {table}, {}}}}, {}), HasSubstr("Failure"));
    table.rows.pop_back();
    EXPECT_THAT(html_text({"R", {}, {{"C", {}, {table}, {}}}}, {}), Not(HasSubstr("Failure")));
    EXPECT_THAT(csv_text(table), HasSubstr(",failure\n"));  // programs find every key
}

TEST(Report, TablesFillTheirRows) {
    Table table{"t", "", {{"method", ""}, {"error", ""}, failure_column()}, {}, ""};
    table.add({"exact", 1e-9});
    table.add_failed({"rattle"}, "it diverged");
    EXPECT_EQ(csv_text(table), "method,error,failure\nexact,1.0000000000000001e-09,\nrattle,,it diverged\n");
    EXPECT_FALSE(is_failed(table, 0));
    EXPECT_TRUE(is_failed(table, 1));
}

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

TEST(Report, CellsOfMissingNumbersAreEmpty) {
    EXPECT_EQ(cell_of(2.0), Cell(2.0));
    EXPECT_EQ(cell_of(std::nullopt), Cell());
    EXPECT_EQ(cell_of(std::nan("")), Cell());
    EXPECT_EQ(cell_of(kInfinity), Cell(kInfinity));
}

}  // namespace
}  // namespace corda::report
