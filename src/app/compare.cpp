#include "corda/golden/compare.hpp"

#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/media/defs.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct CompareOptions {
    std::string a;
    std::string b;
    DifferenceLimits limits;
    std::string diff;
    bool force = false;
};

nlohmann::json report(const Difference& comparison, bool passed) {
    nlohmann::json json = {{"schema", 1},      {"equal", comparison.equal},
                           {"passed", passed}, {"same_size", comparison.same_size},
                           {"max", nullptr},   {"mean", nullptr},
                           {"share", nullptr}};
    if (comparison.same_size) {
        json["max"] = comparison.max;
        json["mean"] = comparison.mean;
        json["share"] = comparison.share;
    }
    return json;
}

ExitCode compare(const Console& console, const CompareOptions& options) {
    if (!options.diff.empty()) {
        if (std::filesystem::path(options.diff).extension() != ".png") {
            throw Error(
                ExitCode::kUsage,
                fmt::format("--diff {}: the picture is written as .png; give such a name", options.diff));
        }
        check_output(options.diff, options.a, options.force);
        check_output(options.diff, options.b, options.force);
    }
    const OnProgress goes_on = stopping_if_asked();
    const Image a = read_png(options.a, goes_on);
    const Image b = read_png(options.b, goes_on);
    const Difference comparison = compare(a, b, goes_on);
    const bool passed = comparison.within(options.limits);
    if (!comparison.same_size) {
        console.result(
            fmt::format("different sizes: {}x{} and {}x{}", a.width(), a.height(), b.width(), b.height()));
    } else if (comparison.equal) {
        console.result("equal");
    } else {
        console.result(fmt::format("{}: max {}, mean {:.6g}, share {:.6g}",
                                   passed ? "within the limits" : "different", comparison.max,
                                   comparison.mean, comparison.share));
    }
    if (!options.diff.empty() && comparison.same_size) {
        write_png(options.diff, difference_image(a, b, goes_on), {},
                  {.force = options.force, .on_progress = goes_on});
        console.info(fmt::format("difference picture: {}", options.diff));
    }
    console.report(report(comparison, passed));
    return passed ? ExitCode::kOk : ExitCode::kMismatch;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand(
        "compare", "compare two PNG files; exit 7 if they differ (by more than the limits)");
    command->add_option("A", options->a, "PNG file")->required();
    command->add_option("B", options->b, "PNG file")->required();
    command
        ->add_option("--max", options->limits.max,
                     "largest difference of a channel that passes; with no limit only equal pictures pass")
        ->check(within(0.0, 255.0));
    command->add_option("--mean", options->limits.mean, "mean difference of all channels that passes")
        ->check(within(0.0, 255.0));
    command->add_option("--share", options->limits.share, "share of differing pixels that passes")
        ->check(within(0.0, 1.0));
    command->add_option("--diff", options->diff, "write a picture of the differences to this PNG file");
    command->add_flag("--force", options->force, "replace an existing difference picture");
    command->callback([options, &action] {
        action = [options](const Console& console) { return compare(console, *options); };
    });
}

}  // namespace corda::app
