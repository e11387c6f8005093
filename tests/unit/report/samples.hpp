#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Text with every character that one of the formats could misinterpret.
inline const std::string nasty = "a_b, \"q\" <b>&amp; | *x* 'y' `touch pwned` $(touch pwned) @m \\";

inline Table small_table() {
    return {"speed",
            "Speed & error",
            {{"method", "Method"}, {"step_s", "Step / s"}, {"error", "Error"}, {"failure", "Failure"}},
            {{"exact", 0.1, 1.0 / 3.0, std::monostate{}},
             {nasty, 1e-5, std::monostate{}, ""},
             {"rattle", 0.25, 12345.0, "it diverged"}},
            "A note."};
}

inline Plot small_plot() {
    Plot plot;
    plot.id = "error";
    plot.title = "Error, " + nasty;
    plot.x_title = "Step / s";
    plot.y_title = "Error / L";
    plot.series = {{"rattle " + nasty, {{1e-3, 1e-6}, {1e-2, 1e-4}, {1e-1, 0.0}}},
                   {"exact", {{1e-3, 1e-12}, {std::nan(""), 1.0}, {1e-1, 1e-11}}},
                   {"never", {{-1.0, 1.0}, {1.0, kInfinity}}},
                   {"empty", {}}};
    return plot;
}

inline Report small_report() {
    Report report{"A <report>", {{"Processor", "Some & any <CPU>"}, {"Build", "-O3 | -g"}}, {}};
    report.chapters.push_back(
        {"First & <foremost>", {"Plain " + nasty, "2. No list"}, {small_table()}, {small_plot()}});
    Plot linear = small_plot();
    linear.id = "linear";
    linear.log_x = linear.log_y = false;
    report.chapters.push_back({"Second", {}, {}, {linear}});
    return report;
}

}  // namespace corda::report
