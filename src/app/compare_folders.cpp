#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/threads.hpp"
#include "corda/golden/variant.hpp"

namespace corda::app {
namespace {

namespace fs = std::filesystem;

/// The PNG files in a folder and the folders in it, but for `diff`, which may be one of them; by their paths
/// from the folder on.
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

/// The picture of which NAME.CAUSE.png is a variant, in the same folder; empty if it is none by its name.
std::string base_of(const std::string& name) {
    const std::string base = base_of_variant(name);
    return base.empty() ? "" : (fs::path(name).parent_path() / base).string();
}

/// A name that stands in one of the folders at least.
struct Pair {
    std::string name;
    bool is_in_a = false;
    bool is_in_b = false;
    std::vector<std::string> variants;  ///< names in B
    ComparedPicture compared = {};
    std::exception_ptr failure = {};
};

/// NAME.CAUSE.png beside NAME.png in B is a variant of it, unless A has a picture of that name.
std::vector<Pair> pairs_of(const std::set<std::string>& a, const std::set<std::string>& b) {
    std::map<std::string, std::vector<std::string>> variants;
    std::set<std::string> all = a;
    for (const std::string& name : b) {
        const std::string base = base_of(name);
        if (!base.empty() && b.contains(base) && !a.contains(name))
            variants[base].push_back(name);
        else
            all.insert(name);
    }
    std::vector<Pair> pairs;
    for (const std::string& name : all)
        pairs.push_back({.name = name,
                         .is_in_a = a.contains(name),
                         .is_in_b = b.contains(name),
                         .variants = variants[name]});
    return pairs;
}

void compare_pair(const CompareOptions& options, const std::optional<Image>& mask, Pair& pair) {
    const std::string picture = options.a + "/" + pair.name;
    std::vector<std::string> references{options.b + "/" + pair.name};
    for (const std::string& variant : pair.variants) references.push_back(options.b + "/" + variant);
    pair.compared = compare_picture(options, picture, references, mask, "", 1);
    if (options.diff.empty() || pair.compared.difference.equal) return;
    const fs::path diff = fs::path(options.diff) / pair.name;
    make_folder(diff.parent_path().string());
    pair.compared = compare_picture(options, picture, references, mask, diff.string(), 1);
}

/// Two pictures may take 512 MiB.
constexpr int kMaxThreads = 4;

/// Compares several pairs at a time.
void compare_all(const CompareOptions& options, const std::optional<Image>& mask, std::vector<Pair>& pairs) {
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> stops = false;
    const auto work = [&] {
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

/// Makes the folder of the differences, which must not take the place of what is compared.
void check_diff_folder(const CompareOptions& options) {
    if (options.diff.empty()) return;
    make_folder(options.diff);
    std::error_code none;
    for (const std::string& folder : {options.a, options.b})
        if (fs::equivalent(options.diff, folder, none))
            throw Error(ExitCode::kUsage, fmt::format("--diff {}: holds the pictures that are compared; name "
                                                      "another folder",
                                                      options.diff));
}

/// The figures of the worst.
void take_worst(const Difference& difference, Difference& worst) {
    worst.equal &= difference.equal;
    worst.same_size &= difference.same_size;
    worst.max = std::max(worst.max, difference.max);
    worst.mean = std::max(worst.mean, difference.mean);
    worst.share = std::max(worst.share, difference.share);
    if (difference.flip) worst.flip = std::max(worst.flip.value_or(0.0), *difference.flip);
    if (difference.ssim) worst.ssim = std::min(worst.ssim.value_or(1.0), *difference.ssim);
}

}  // namespace

ExitCode compare_folders(const Console& console, const CompareOptions& options,
                         const std::optional<Image>& mask) {
    std::vector<Pair> pairs =
        pairs_of(pictures_in(options.a, options.diff), pictures_in(options.b, options.diff));
    if (pairs.empty())
        throw Error(ExitCode::kUsage,
                    fmt::format("neither '{}' nor '{}' has a PNG file", options.a, options.b));
    check_diff_folder(options);
    compare_all(options, mask, pairs);
    Difference worst;
    std::int64_t failed = 0;
    nlohmann::json files = nlohmann::json::array();
    std::vector<std::string> notes;
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
        if (!compared.difference.equal || !compared.variant.empty())
            console.result(fmt::format("{}: {}", pair.name, compared.words));
        failed += compared.passed ? 0 : 1;
        take_worst(compared.difference, worst);
        file.update(figures_json(compared.difference));
        file["passed"] = compared.passed;
        file["notes"] = notes_json(compared.notes);
        notes.insert(notes.end(), compared.notes.begin(), compared.notes.end());
        file["variant"] =
            compared.variant.empty() ? nlohmann::json() : nlohmann::json(printable(compared.variant));
        files.push_back(file);
    }
    if (!notes.empty())
        console.warning(notes.front() +
                        (notes.size() > 1 ? fmt::format("; and so of {} more", notes.size() - 1) : ""));
    console.result(fmt::format("{}: {}", counted(std::ssize(pairs), "picture"),
                               worst.equal   ? "all equal"
                               : failed == 0 ? "all within the limits"
                                             : fmt::format("{} failed", failed)));
    nlohmann::json json = figures_json(worst);
    json.update({{"schema", 1}, {"passed", failed == 0}, {"files", files}, {"notes", notes_json(notes)}});
    console.report(json);
    return failed == 0 ? ExitCode::kOk : ExitCode::kMismatch;
}

}  // namespace corda::app
