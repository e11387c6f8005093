// The chapter "Predicted and observed horizons": random chaotic ropes by method auto, held against a motion
// in extended precision.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "benchmark/study/chapters.hpp"
#include "corda/core/basics.hpp"
#include "support/estimate_families.hpp"

namespace corda::benchmark {
namespace {

/// Results of the scenes of a family.
struct Observed {
    std::string name;
    std::vector<std::pair<double, double>> points;  ///< claimed horizon in s, observed over claimed
    int without_horizon = 0;
    int not_passed = 0;  ///< the scene ends first
    int not_judged = 0;
    int is_false = 0;  ///< the error passes the estimate before the horizon
};

test::EstimateFamily family_of(std::string_view name) {
    const auto families = test::rope_families();
    return *std::find_if(families.begin(), families.end(),
                         [&](const test::EstimateFamily& family) { return family.name == name; });
}

void judge(test::EstimateCase given, Observed& observed) {
    const test::Verdict verdict = test::judge_estimate(given, true);
    if (!verdict.ratio) {
        ++observed.not_judged;
    } else if (!verdict.horizon_s || *verdict.horizon_s == 0.0) {
        ++observed.without_horizon;
    } else if (!verdict.passes_s) {
        ++observed.not_passed;
    } else {
        if (*verdict.passes_s <= *verdict.horizon_s) ++observed.is_false;
        observed.points.emplace_back(*verdict.horizon_s, *verdict.passes_s / *verdict.horizon_s);
    }
}

double share(const std::vector<double>& sorted, double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

report::Chapter horizons_chapter(const Options& options) {
    report::Chapter chapter;
    chapter.title = "Predicted and observed horizons";
    report::Table table{"horizons", chapter.title, {}, {}, {}};
    table.columns = {{"family", "ropes"},
                     {"scenes", "scenes"},
                     {"horizons", "passed their estimate after the horizon"},
                     {"false", "before it"},
                     {"without", "no horizon"},
                     {"not_passed", "not passed at the end"},
                     {"least", "observed / claimed: least"},
                     {"tenth", "a tenth"},
                     {"median", "median"},
                     {"nine_tenths", "nine tenths"},
                     {"largest", "largest"}};
    report::Plot plot;
    plot.id = "horizons";
    plot.title = "The time at which the true error passes the estimate, over the claimed horizon";
    plot.x_title = "claimed horizon [s]";
    plot.y_title = "observed / claimed";
    plot.log_y = false;
    const std::pair<const char*, const char*> kFamilies[] = {{"chaos_few", "2 to 8 links"},
                                                             {"chaos_many", "10 to 30 links"}};
    for (const auto& [family, name] : kFamilies) {
        Observed observed{name, {}};
        for (unsigned n = 0; n < options.scenes / 2; ++n) {
            judge(family_of(family).scene(n), observed);
            std::fprintf(stderr, "\r%s: %u of %u", name, n + 1, options.scenes / 2);
        }
        std::fprintf(stderr, "\n");
        std::vector<double> ratios;
        for (const auto& point : observed.points) ratios.push_back(point.second);
        std::sort(ratios.begin(), ratios.end());
        if (ratios.empty()) throw Error(ExitCode::kInternal, std::string(name) + ": no scene has a horizon");
        table.add({name, double(options.scenes / 2), double(observed.points.size() - observed.is_false),
                   double(observed.is_false), double(observed.without_horizon), double(observed.not_passed),
                   ratios.front(), share(ratios, 0.1), share(ratios, 0.5), share(ratios, 0.9),
                   ratios.back()});
        report::Series series{.name = name, .points = observed.points};
        series.form = report::Series::Form::kPoints;
        plot.series.push_back(std::move(series));
    }
    chapter.tables = {std::move(table)};
    chapter.plots = {std::move(plot)};
    return chapter;
}

}  // namespace corda::benchmark
