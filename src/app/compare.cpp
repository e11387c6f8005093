#include "compare.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <exception>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/golden/cases.hpp"
#include "corda/golden/perceived.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/png/png.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

namespace fs = std::filesystem;

bool is_png(const fs::path& path) {
    return path.extension() == ".png";
}

/// Compares two pictures of files, the first of which is decoded. `keeps_b`: `b` is wanted in any case.
Difference difference_of(const std::string& path_a, const Picture& a, const std::string& path_b, Picture& b,
                         const PerceivedFigures& figures, const Image* mask, bool keeps_b) {
    Difference difference;
    if (mask == nullptr && media::have_same_picture_chunks(path_a, path_b)) {
        if (keeps_b) b = a;
    } else {
        b = read_picture(path_b);
        difference = compare(a, b, mask);
    }
    add_perceived(a.image, b.image, figures, difference, mask);
    return difference;
}

/// A picture against those that it may be equal to.
struct ComparedPicture {
    Difference difference;
    bool passed = false;
    std::string reference;  ///< the file that the figures are of
    std::string variant;    ///< the cause of the variant that passed; empty: none, or the first reference
    std::string words;
    std::vector<std::string> notes;  ///< on contents of the files that the comparison ignores
};

std::string words_of(const ComparedPicture& compared, const Image& a, const Image& b) {
    const Difference& difference = compared.difference;
    std::string words;
    if (!difference.same_size)
        words = fmt::format("different sizes: {}x{} and {}x{}", a.width(), a.height(), b.width(), b.height());
    else if (difference.equal)
        words = "equal";
    else
        words = fmt::format("{}: {}", compared.passed ? "within the limits" : "different",
                            figures_text(difference));
    if (!compared.variant.empty()) words += fmt::format(" (variant {})", compared.variant);
    return words;
}

/// Notes on colour chunks of the two files that the comparison ignores.
std::vector<std::string> notes_of(const std::string& a, const std::string& b) {
    std::vector<std::string> notes;
    for (const std::string& path : {a, b}) {
        const std::vector<std::string> chunks = media::color_chunks_beside_srgb(path);
        if (chunks.empty()) continue;
        notes.push_back(fmt::format("{}: {} {} ignored: the numbers in the file are compared as sRGB", path,
                                    fmt::join(chunks, ", "), chunks.size() == 1 ? "is" : "are"));
    }
    return notes;
}

/// Compares `picture` with `references`: the first that passes counts, or else the first of all. Writes the
/// picture of the difference to `diff`, if that is not empty. `threads` is for each comparison.
ComparedPicture compare_picture(const CompareOptions& options, const std::string& picture,
                                const std::vector<std::string>& references, const std::optional<Image>& mask,
                                const std::string& diff, int threads) {
    const Picture a = read_picture(picture);
    const Image* const its_mask = mask ? &*mask : nullptr;
    PerceivedFigures figures = figures_for(options);
    figures.threads = threads;
    std::optional<ComparedPicture> chosen;
    Picture chosen_picture;
    for (const std::string& path : references) {
        Picture b;
        // Small pictures have no SSIM; only an explicit request is refused.
        const bool is_small = std::min(a.image.width(), a.image.height()) < kMinSsimSidePx;
        if (is_small && !options.limits.ssim) figures.ssim = false;
        ComparedPicture compared;
        compared.difference = difference_of(picture, a, path, b, figures, its_mask, !diff.empty());
        compared.passed = compared.difference.within(options.limits);
        compared.reference = path;
        if (compared.passed && path != references.front()) compared.variant = golden::variant_cause(path);
        compared.words = words_of(compared, a.image, b.image);
        compared.notes = notes_of(picture, path);
        if (chosen && !compared.passed) continue;
        chosen = std::move(compared);
        chosen_picture = std::move(b);
        if (chosen->passed) break;
    }
    if (!diff.empty())
        write_png(diff, difference_image(a, chosen_picture, its_mask), {}, {.force = options.force});
    return *chosen;
}

nlohmann::json notes_json(const std::vector<std::string>& notes) {
    nlohmann::json json = nlohmann::json::array();
    for (const std::string& note : notes) json.push_back(printable(note));
    return json;
}

ExitCode compare_pictures(const Console& console, const CompareOptions& options,
                          const std::optional<Image>& mask) {
    std::vector<std::string> references{options.b};
    references.insert(references.end(), options.variants.begin(), options.variants.end());
    const ComparedPicture compared =
        compare_picture(options, options.a, references, mask, options.diff, usable_cores());
    for (const std::string& note : compared.notes) console.warning(note);
    console.result(compared.words);
    if (!options.diff.empty()) console.info(fmt::format("difference picture: {}", options.diff));
    nlohmann::json json = figures_json(compared.difference);
    json["schema"] = 1;
    json["passed"] = compared.passed;
    json["reference"] = printable(compared.reference);
    json["variant"] =
        compared.variant.empty() ? nlohmann::json() : nlohmann::json(printable(compared.variant));
    json["notes"] = notes_json(compared.notes);
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

/// The picture of which NAME.CAUSE.png is a variant, in the same folder; empty if it is none by its name.
std::string base_of(const std::string& name) {
    const std::string base = golden::base_of_variant(name);
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

void check_diff(const CompareOptions& options) {
    if (options.diff.empty()) return;
    if (!is_png(options.diff)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("--diff {}: the picture is written as .png; give such a name", options.diff));
    }
    check_output(options.diff, options.a, options.force);
    check_output(options.diff, options.b, options.force);
}

ExitCode compare(const Console& console, CompareOptions options) {
    options.json = console.json();
    std::optional<Image> mask;
    if (!options.mask.empty()) mask = read_png(options.mask);
    std::error_code none;  // the reader reports the problem
    for (const std::string& path : {options.a, options.b})
        if (!fs::exists(path, none)) fail_file("read", path, none ? none.value() : ENOENT);
    const bool is_folder = fs::is_directory(options.a, none);
    if (is_folder != fs::is_directory(options.b, none)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' is a folder and '{}' is none; name two pictures, or two folders",
                                is_folder ? options.a : options.b, is_folder ? options.b : options.a));
    }
    if (is_folder && !options.variants.empty())
        throw Error(ExitCode::kUsage,
                    "--variant is for files; in a folder NAME.CAUSE.png is a variant of NAME.png");
    if (is_folder) return compare_folders(console, options, mask);
    const bool is_video = is_video_name(options.a);
    for (const std::string& other : options.variants)
        if (golden::variant_cause(other).empty())
            throw Error(ExitCode::kUsage,
                        fmt::format("--variant {}: does not name its cause; call it NAME.CAUSE.png, e.g. "
                                    "swing.nvidia.png",
                                    other));
    if (is_video != is_video_name(options.b)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' is a video and '{}' is none; name two videos, or two pictures",
                                is_video ? options.a : options.b, is_video ? options.b : options.a));
    }
    check_diff(options);
    return is_video ? compare_videos(console, options, mask) : compare_pictures(console, options, mask);
}

}  // namespace

nlohmann::json figures_json(const Difference& difference) {
    const auto figure = [&](const nlohmann::json& value) {
        return difference.same_size ? value : nlohmann::json();
    };
    return {{"equal", difference.equal},           {"same_size", difference.same_size},
            {"max", figure(max_json(difference))}, {"mean", figure(difference.mean)},
            {"share", figure(difference.share)},   {"flip", or_null(difference.flip)},
            {"ssim", or_null(difference.ssim)}};
}

nlohmann::json max_json(const Difference& difference) {
    const auto whole = static_cast<int>(difference.max);
    return difference.max == whole ? nlohmann::json(whole) : nlohmann::json(difference.max);
}

PerceivedFigures figures_for(const CompareOptions& options) {
    return {.flip = options.json || options.limits.flip, .ssim = options.json || options.limits.ssim};
}

void add_compare(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "compare",
        "compare two PNG files, those of two folders, or the frames of two videos; exit 7 if they differ (by "
        "more than the limits). In folders NAME.CAUSE.png beside NAME.png in B may match, too",
        compare);
    command.add_option("A", options.a, "PNG file, folder, or video")->required();
    command.add_option("B", options.b, "PNG file, folder, or video: the reference")->required();
    command
        .add_option("--variant", options.variants,
                    "another reference that may match in place of B, named by its cause: NAME.CAUSE.png")
        ->type_name("FILE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
    command
        .add_option("--max", options.limits.max,
                    "largest difference of a channel that passes; with no limit only equal pictures pass")
        ->check(within(0.0, 255.0));
    command.add_option("--mean", options.limits.mean, "mean difference of all channels that passes")
        ->check(within(0.0, 255.0));
    command.add_option("--share", options.limits.share, "share of differing pixels that passes")
        ->check(within(0.0, 1.0));
    command
        .add_option("--flip", options.limits.flip,
                    "largest mean FLIP that passes (the visible difference at 67 pixels per degree)")
        ->check(within(0.0, 1.0));
    command
        .add_option("--ssim", options.limits.ssim,
                    "least structural similarity that passes; equal pictures have 1")
        ->check(within(-1.0, 1.0));
    command.add_option("--mask", options.mask,
                       "PNG file of the same size: its black pixels are not compared");
    command.add_option("--diff", options.diff,
                       "write a picture of the differences to this PNG file, of two videos that of the worst "
                       "frame, or of each pair that differs to this folder");
    command.add_flag("--force", options.force, "replace existing pictures of differences");
}

}  // namespace corda::app
