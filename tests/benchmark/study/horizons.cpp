// The chapter "Predicted and observed horizons": random chaotic ropes by method auto, held against a motion
// in extended precision.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "benchmark/study/chapters.hpp"
#include "support/estimate_families.hpp"

namespace corda::study {
namespace {

/// Results of the scenes of a family.
struct Observed {
    std::vector<std::pair<double, double>> points;  ///< claimed horizon in s, observed over claimed
    int without_horizon = 0;
    int not_passed = 0;  ///< the scene ends first
    int not_judged = 0;
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
        observed.points.emplace_back(*verdict.horizon_s, *verdict.passes_s / *verdict.horizon_s);
    }
}

}  // namespace

nlohmann::json measure_horizons(const Options& options, const OnRun& on_run) {
    const unsigned scenes = options.quick ? 4 : 100;
    const std::pair<const char*, const char*> kFamilies[] = {{"chaos_few", "2 to 8 links"},
                                                             {"chaos_many", "10 to 30 links"}};
    nlohmann::json families = nlohmann::json::array();
    for (const auto& [family, name] : kFamilies) {
        Observed observed;
        for (unsigned n = 0; n < scenes; ++n) {
            on_run(fmt::format("{}: {} of {}", name, n + 1, scenes));
            judge(family_of(family).scene(n), observed);
        }
        nlohmann::json points = nlohmann::json::array();
        for (const auto& [claimed_s, ratio] : observed.points) points.push_back({claimed_s, ratio});
        families.push_back({{"ropes", name},
                            {"scenes", scenes},
                            {"not_judged", observed.not_judged},
                            {"without_horizon", observed.without_horizon},
                            {"not_passed", observed.not_passed},
                            {"claimed_s_and_observed_over_claimed", std::move(points)}});
    }
    return {{"families", std::move(families)}};
}

}  // namespace corda::study
