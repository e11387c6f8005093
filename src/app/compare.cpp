#include "corda/golden/compare.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/defs.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct CompareOptions {
    std::string a;
    std::string b;
    DifferenceLimits limits;
    std::string mask;
    std::string diff;
    bool force = false;
};

bool is_png(const std::filesystem::path& path) {
    return path.extension() == ".png";
}

nlohmann::json to_json(const Difference& difference) {
    nlohmann::json json{{"equal", difference.equal},
                        {"same_size", difference.same_size},
                        {"max", nullptr},
                        {"mean", nullptr},
                        {"share", nullptr}};
    if (!difference.same_size) return json;
    json["max"] = difference.max;
    json["mean"] = difference.mean;
    json["share"] = difference.share;
    return json;
}

/// Two pictures that were compared.
struct Compared {
    Difference difference;
    bool passed = false;
    std::string words;
};

/// Compares two files; writes the picture of their difference to `diff`, if it is not empty.
Compared compare_files(const CompareOptions& options, const std::string& path_a, const std::string& path_b,
                       const std::optional<Image>& mask, const std::string& diff) {
    const OnProgress goes_on = stopping_if_asked();
    const Image a = read_png(path_a, goes_on);
    const Image b = read_png(path_b, goes_on);
    const Image* const its_mask = mask ? &*mask : nullptr;
    Compared compared;
    compared.difference = compare(a, b, goes_on, its_mask);
    const Difference& difference = compared.difference;
    compared.passed = difference.within(options.limits);
    if (!difference.same_size)
        compared.words =
            fmt::format("different sizes: {}x{} and {}x{}", a.width(), a.height(), b.width(), b.height());
    else if (difference.equal)
        compared.words = "equal";
    else
        compared.words = fmt::format("{}: max {}, mean {:.6g}, share {:.6g}",
                                     compared.passed ? "within the limits" : "different", difference.max,
                                     difference.mean, difference.share);
    if (!diff.empty())
        write_png(diff, difference_image(a, b, goes_on, its_mask), {},
                  {.force = options.force, .on_progress = goes_on});
    return compared;
}

ExitCode compare_pictures(const Console& console, const CompareOptions& options,
                          const std::optional<Image>& mask) {
    if (!options.diff.empty()) {
        if (!is_png(options.diff)) {
            throw Error(
                ExitCode::kUsage,
                fmt::format("--diff {}: the picture is written as .png; give such a name", options.diff));
        }
        check_output(options.diff, options.a, options.force);
        check_output(options.diff, options.b, options.force);
    }
    const Compared compared = compare_files(options, options.a, options.b, mask, options.diff);
    console.result(compared.words);
    if (!options.diff.empty()) console.info(fmt::format("difference picture: {}", options.diff));
    nlohmann::json json = to_json(compared.difference);
    json["schema"] = 1;
    json["passed"] = compared.passed;
    console.report(json);
    return compared.passed ? ExitCode::kOk : ExitCode::kMismatch;
}

/// The names of the PNG files in a folder.
std::set<std::string> pictures_in(const std::string& folder) {
    std::set<std::string> names;
    std::error_code failure;
    for (std::filesystem::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure))
        if (is_png(entry->path())) names.insert(entry->path().filename().string());
    if (failure) fail_file("read", folder, failure.value());
    return names;
}

ExitCode compare_folders(const Console& console, const CompareOptions& options,
                         const std::optional<Image>& mask) {
    const std::set<std::string> of_a = pictures_in(options.a);
    const std::set<std::string> of_b = pictures_in(options.b);
    std::set<std::string> all = of_a;
    all.insert(of_b.begin(), of_b.end());
    if (all.empty())
        throw Error(ExitCode::kUsage,
                    fmt::format("neither '{}' nor '{}' has a PNG file", options.a, options.b));
    if (!options.diff.empty()) make_folder(options.diff);
    Difference worst;
    std::int64_t failed = 0;
    nlohmann::json files = nlohmann::json::array();
    for (const std::string& name : all) {
        const std::string path_a = options.a + "/" + name;
        const std::string path_b = options.b + "/" + name;
        nlohmann::json file{{"name", printable(name)}};
        if (!of_a.contains(name) || !of_b.contains(name)) {
            const std::string& where = of_a.contains(name) ? options.b : options.a;
            console.result(fmt::format("{}: missing in {}", name, where));
            file["missing_in"] = printable(where);
            file["passed"] = false;
            worst.equal = false;
            ++failed;
            files.push_back(file);
            continue;
        }
        Compared compared = compare_files(options, path_a, path_b, mask, "");
        if (!options.diff.empty() && !compared.difference.equal)
            compared = compare_files(options, path_a, path_b, mask, options.diff + "/" + name);
        const Difference& difference = compared.difference;
        if (!difference.equal) console.result(fmt::format("{}: {}", name, compared.words));
        failed += compared.passed ? 0 : 1;
        worst.equal &= difference.equal;
        worst.same_size &= difference.same_size;
        worst.max = std::max(worst.max, difference.max);
        worst.mean = std::max(worst.mean, difference.mean);
        worst.share = std::max(worst.share, difference.share);
        file.update(to_json(difference));
        file["passed"] = compared.passed;
        files.push_back(file);
    }
    console.result(fmt::format("{}: {}", counted(std::ssize(all), "picture"),
                               worst.equal   ? "all equal"
                               : failed == 0 ? "all within the limits"
                                             : fmt::format("{} failed", failed)));
    nlohmann::json json = to_json(worst);
    json.update({{"schema", 1}, {"passed", failed == 0}, {"files", files}});
    console.report(json);
    return failed == 0 ? ExitCode::kOk : ExitCode::kMismatch;
}

ExitCode compare(const Console& console, const CompareOptions& options) {
    std::optional<Image> mask;
    if (!options.mask.empty()) mask = read_png(options.mask, stopping_if_asked());
    const bool is_folder = std::filesystem::is_directory(options.a);
    if (is_folder != std::filesystem::is_directory(options.b)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' is a folder and '{}' is none; name two pictures, or two folders",
                                is_folder ? options.a : options.b, is_folder ? options.b : options.a));
    }
    return is_folder ? compare_folders(console, options, mask) : compare_pictures(console, options, mask);
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand(
        "compare",
        "compare two PNG files, or those of two folders; exit 7 if they differ (by more than the limits)");
    command->add_option("A", options->a, "PNG file, or folder")->required();
    command->add_option("B", options->b, "PNG file, or folder")->required();
    command
        ->add_option("--max", options->limits.max,
                     "largest difference of a channel that passes; with no limit only equal pictures pass")
        ->check(within(0.0, 255.0));
    command->add_option("--mean", options->limits.mean, "mean difference of all channels that passes")
        ->check(within(0.0, 255.0));
    command->add_option("--share", options->limits.share, "share of differing pixels that passes")
        ->check(within(0.0, 1.0));
    command->add_option("--mask", options->mask,
                        "PNG file of the same size: what is black in it is not compared");
    command->add_option(
        "--diff", options->diff,
        "write a picture of the differences to this PNG file, or of each pair that differs to this folder");
    command->add_flag("--force", options->force, "replace existing pictures of differences");
    command->callback([options, &action] {
        action = [options](const Console& console) { return compare(console, *options); };
    });
}

}  // namespace corda::app
