#include <algorithm>
#include <atomic>
#include <cerrno>
#include <exception>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "console.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/golden/compare.hpp"
#include "corda/golden/suite.hpp"
#include "corda/media/defs.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
    std::string a;
    std::string b;
    DifferenceLimits limits;
    std::string mask;
    std::string diff;
    bool force = false;
};

bool is_png(const fs::path& path) {
    return path.extension() == ".png";
}

nlohmann::json json_of(const Difference& difference) {
    nlohmann::json json = golden::figures_json(difference);
    json.update({{"equal", difference.equal}, {"same_size", difference.same_size}});
    return json;
}

/// A comparison of two pictures.
struct ComparedPicture {
    Difference difference;
    bool passed = false;
    PixelRect a;
    PixelRect b;
};

std::string text_of(const ComparedPicture& compared) {
    const auto& [difference, passed, a, b] = compared;
    if (!difference.same_size)
        return fmt::format("different sizes: {}x{} and {}x{}", a.width(), a.height(), b.width(), b.height());
    if (difference.equal) return "equal";
    return fmt::format("{}: {}", passed ? "within the limits" : "different", figures_text(difference));
}

/// Compares two pictures. Writes the picture of the difference to `diff`, if that is not empty.
ComparedPicture compare_picture(const CompareOptions& options, const std::string& path_a,
                                const std::string& path_b, const std::optional<Image>& mask,
                                const std::string& diff) {
    const Picture a = read_picture(path_a);
    const Picture b = read_picture(path_b);
    const Image* const mask_image = mask ? &*mask : nullptr;
    const Difference difference = compare(a, b, mask_image);
    if (!diff.empty()) write_png(diff, difference_image(a, b, mask_image), {}, {.force = options.force});
    return {difference, difference.within(options.limits), a.image.rect(), b.image.rect()};
}

ExitCode compare_pictures(const Console& console, const CompareOptions& options,
                          const std::optional<Image>& mask) {
    const ComparedPicture compared = compare_picture(options, options.a, options.b, mask, options.diff);
    console.result(text_of(compared));
    if (!options.diff.empty()) console.info(fmt::format("difference picture: {}", options.diff));
    nlohmann::json json = json_of(compared.difference);
    json["schema"] = 1;
    json["passed"] = compared.passed;
    console.report(json);
    return compared.passed ? ExitCode::kOk : ExitCode::kMismatch;
}

/// The PNG files in a folder and its subfolders except `diff`, by their paths relative to the folder.
std::set<std::string> pictures_in(const std::string& folder, const std::string& diff) {
    std::set<std::string> names;
    std::error_code failure;
    for (fs::recursive_directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
        std::error_code none;
        if (!diff.empty() && fs::equivalent(entry->path(), diff, none)) entry.disable_recursion_pending();
        const std::string extension = entry->path().extension().string();
        if (extension == ".png" || extension == ".PNG")
            names.insert(entry->path().lexically_relative(folder).string());
    }
    if (failure) fail_file("read", folder, failure.value());
    return names;
}

/// A name that stands in one of the folders at least.
struct Pair {
    std::string name;
    bool is_in_a = false;
    bool is_in_b = false;
    ComparedPicture compared = {};
    std::exception_ptr failure = {};
};

std::vector<Pair> pairs_of(const std::set<std::string>& a, const std::set<std::string>& b) {
    std::set<std::string> all = a;
    all.insert(b.begin(), b.end());
    std::vector<Pair> pairs;
    for (const std::string& name : all)
        pairs.push_back({.name = name, .is_in_a = a.contains(name), .is_in_b = b.contains(name)});
    return pairs;
}

void compare_pair(const CompareOptions& options, const std::optional<Image>& mask, Pair& pair) {
    const std::string a = options.a + "/" + pair.name;
    const std::string b = options.b + "/" + pair.name;
    pair.compared = compare_picture(options, a, b, mask, "");
    if (options.diff.empty() || pair.compared.difference.equal) return;
    const fs::path diff = fs::path(options.diff) / pair.name;
    make_folder(diff.parent_path().string());
    pair.compared = compare_picture(options, a, b, mask, diff.string());
}

/// Two pictures may take 512 MiB.
constexpr int kMaxThreads = 4;

/// Compares several pairs at a time.
void compare_all(const CompareOptions& options, const std::optional<Image>& mask, std::vector<Pair>& pairs) {
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> stops = false;
    const auto work = [&] {
        const CancelScope stopping([&stops] {
            stop_if_asked();
            return !stops;
        });
        for (std::size_t i = next++; i < pairs.size() && !stops; i = next++) {
            if (!pairs[i].is_in_a || !pairs[i].is_in_b) continue;
            try {
                compare_pair(options, mask, pairs[i]);
            } catch (...) {
                pairs[i].failure = std::current_exception();
                stops = true;
            }
        }
    };
    {
        const auto threads = std::min<std::size_t>(std::min(usable_cores(), kMaxThreads), pairs.size());
        const auto helpers = start_threads(static_cast<int>(threads) - 1, work);
        work();
    }
    for (const Pair& pair : pairs)
        if (pair.failure) std::rethrow_exception(pair.failure);
}

/// Makes the folder of the differences, which must not be one of the compared folders.
void check_diff_folder(const CompareOptions& options) {
    if (options.diff.empty()) return;
    make_folder(options.diff);
    std::error_code none;
    for (const std::string& folder : {options.a, options.b})
        if (fs::equivalent(options.diff, folder, none))
            throw_usage("--diff {}: holds the pictures that are compared; name another folder", options.diff);
}

/// The figures of the worst.
void take_worst(const Difference& difference, Difference& worst) {
    worst.equal &= difference.equal;
    worst.same_size &= difference.same_size;
    worst.max = std::max(worst.max, difference.max);
    worst.mean = std::max(worst.mean, difference.mean);
    worst.share = std::max(worst.share, difference.share);
}

ExitCode compare_folders(const Console& console, const CompareOptions& options,
                         const std::optional<Image>& mask) {
    std::vector<Pair> pairs =
        pairs_of(pictures_in(options.a, options.diff), pictures_in(options.b, options.diff));
    if (pairs.empty()) throw_usage("neither '{}' nor '{}' has a PNG file", options.a, options.b);
    check_diff_folder(options);
    compare_all(options, mask, pairs);
    Difference worst;
    std::int64_t failed = 0;
    nlohmann::json files = nlohmann::json::array();
    for (const Pair& pair : pairs) {
        nlohmann::json file{{"name", printable(pair.name)}};
        if (!pair.is_in_a || !pair.is_in_b) {
            const std::string& where = pair.is_in_a ? options.b : options.a;
            console.result(fmt::format("{}: missing in {}", pair.name, where));
            file["missing_in"] = printable(where);
            file["passed"] = false;
            worst.equal = false;
            ++failed;
            files.push_back(file);
            continue;
        }
        const ComparedPicture& compared = pair.compared;
        if (!compared.difference.equal) console.result(fmt::format("{}: {}", pair.name, text_of(compared)));
        failed += compared.passed ? 0 : 1;
        take_worst(compared.difference, worst);
        file.update(json_of(compared.difference));
        file["passed"] = compared.passed;
        files.push_back(file);
    }
    console.result(fmt::format("{}: {}", counted(std::ssize(pairs), "picture"),
                               worst.equal   ? "all equal"
                               : failed == 0 ? "all within the limits"
                                             : fmt::format("{} failed", failed)));
    nlohmann::json json = json_of(worst);
    json.update({{"schema", 1}, {"passed", failed == 0}, {"files", files}});
    console.report(json);
    return failed == 0 ? ExitCode::kOk : ExitCode::kMismatch;
}

void check_diff(const CompareOptions& options) {
    if (options.diff.empty()) return;
    if (!is_png(options.diff))
        throw_usage("--diff {}: the picture is written as .png; give such a name", options.diff);
    check_output(options.diff, options.a, options.force);
    check_output(options.diff, options.b, options.force);
}

ExitCode compare(const Console& console, const CompareOptions& options) {
    std::optional<Image> mask;
    if (!options.mask.empty()) mask = read_png(options.mask);
    std::error_code none;  // the reader reports the problem
    for (const std::string& path : {options.a, options.b})
        if (!fs::exists(path, none)) fail_file("read", path, none ? none.value() : ENOENT);
    const bool is_folder = fs::is_directory(options.a, none);
    if (is_folder != fs::is_directory(options.b, none)) {
        throw_usage("'{}' is a folder and '{}' is none; name two pictures, or two folders",
                    is_folder ? options.a : options.b, is_folder ? options.b : options.a);
    }
    if (is_folder) return compare_folders(console, options, mask);
    check_diff(options);
    return compare_pictures(console, options, mask);
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "compare",
        "compare two PNG files, or those of two folders; exit 7 if they differ (by more than the limits)",
        compare);
    command.add_option("A", options.a, "PNG file or folder")->required();
    command.add_option("B", options.b, "PNG file or folder: the reference")->required();
    command
        .add_option("--max", options.limits.max,
                    "largest difference of a channel that passes; with no limit only equal pictures pass")
        ->check(within(0.0, 255.0));
    command.add_option("--mean", options.limits.mean, "mean difference of all channels that passes")
        ->check(within(0.0, 255.0));
    command.add_option("--share", options.limits.share, "share of differing pixels that passes")
        ->check(within(0.0, 1.0));
    command.add_option("--mask", options.mask,
                       "PNG file of the same size: its black pixels are not compared");
    command.add_option(
        "--diff", options.diff,
        "write a picture of the differences to this PNG file, or of each pair that differs to this "
        "folder");
    command.add_flag("--force", options.force, "replace existing pictures of differences");
}

}  // namespace corda::app
