#include "compare.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/perceived.hpp"
#include "corda/golden/variant.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/png/png.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

bool is_png(const std::filesystem::path& path) {
    return path.extension() == ".png";
}

/// Compares two pictures of files, the first of which is decoded. `keeps_b`: `b` is wanted in any case.
Difference difference_of(const std::string& path_a, const Picture& a, const std::string& path_b, Picture& b,
                         const PerceivedFigures& figures, const OnProgress& goes_on, const Image* mask,
                         bool keeps_b) {
    Difference difference;
    if (mask == nullptr && media::have_same_picture_chunks(path_a, path_b)) {
        if (keeps_b) b = a;
    } else {
        b = read_picture(path_b, goes_on);
        difference = compare(a, b, goes_on, mask);
    }
    add_perceived(a.image, b.image, figures, difference, goes_on, mask);
    return difference;
}

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
    if (!options.mask.empty()) mask = read_png(options.mask, stopping_if_asked());
    std::error_code none;  // the reader reports the problem
    for (const std::string& path : {options.a, options.b})
        if (!std::filesystem::exists(path, none)) fail_file("read", path, none ? none.value() : ENOENT);
    const bool is_folder = std::filesystem::is_directory(options.a, none);
    if (is_folder != std::filesystem::is_directory(options.b, none)) {
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
        if (variant_cause(other).empty())
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
    nlohmann::json json{{"equal", difference.equal},
                        {"same_size", difference.same_size},
                        {"max", nullptr},
                        {"mean", nullptr},
                        {"share", nullptr},
                        {"flip", nullptr},
                        {"ssim", nullptr}};
    if (!difference.same_size) return json;
    json["max"] = max_json(difference);
    json["mean"] = difference.mean;
    json["share"] = difference.share;
    if (difference.flip) json["flip"] = *difference.flip;
    if (difference.ssim) json["ssim"] = *difference.ssim;
    return json;
}

nlohmann::json max_json(const Difference& difference) {
    const auto whole = static_cast<int>(difference.max);
    return difference.max == whole ? nlohmann::json(whole) : nlohmann::json(difference.max);
}

nlohmann::json notes_json(const std::vector<std::string>& notes) {
    nlohmann::json json = nlohmann::json::array();
    for (const std::string& note : notes) json.push_back(printable(note));
    return json;
}

PerceivedFigures figures_for(const CompareOptions& options) {
    return {.flip = options.json || options.limits.flip, .ssim = options.json || options.limits.ssim};
}

ComparedPicture compare_picture(const CompareOptions& options, const std::string& picture,
                                const std::vector<std::string>& references, const std::optional<Image>& mask,
                                const std::string& diff, int threads) {
    const OnProgress goes_on = stopping_if_asked();
    const Picture a = read_picture(picture, goes_on);
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
        compared.difference = difference_of(picture, a, path, b, figures, goes_on, its_mask, !diff.empty());
        compared.passed = compared.difference.within(options.limits);
        compared.reference = path;
        if (compared.passed && path != references.front()) compared.variant = variant_cause(path);
        compared.words = words_of(compared, a.image, b.image);
        compared.notes = notes_of(picture, path);
        if (chosen && !compared.passed) continue;
        chosen = std::move(compared);
        chosen_picture = std::move(b);
        if (chosen->passed) break;
    }
    if (!diff.empty())
        write_png(diff, difference_image(a, chosen_picture, goes_on, its_mask), {},
                  {.force = options.force, .on_progress = goes_on});
    return *chosen;
}

void add_compare(CLI::App& app, Action& action) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand(
        "compare",
        "compare two PNG files, those of two folders, or the frames of two videos; exit 7 if they differ (by "
        "more than the limits). In folders NAME.CAUSE.png beside NAME.png in B may match, too");
    command->add_option("A", options->a, "PNG file, folder, or video")->required();
    command->add_option("B", options->b, "PNG file, folder, or video: the reference")->required();
    command
        ->add_option("--variant", options->variants,
                     "another reference that may match in place of B, named by its cause: NAME.CAUSE.png")
        ->type_name("FILE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
    command
        ->add_option("--max", options->limits.max,
                     "largest difference of a channel that passes; with no limit only equal pictures pass")
        ->check(within(0.0, 255.0));
    command->add_option("--mean", options->limits.mean, "mean difference of all channels that passes")
        ->check(within(0.0, 255.0));
    command->add_option("--share", options->limits.share, "share of differing pixels that passes")
        ->check(within(0.0, 1.0));
    command
        ->add_option("--flip", options->limits.flip,
                     "mean FLIP, what one sees who flips between both at 67 pixels per degree, that passes")
        ->check(within(0.0, 1.0));
    command
        ->add_option("--ssim", options->limits.ssim,
                     "least structural similarity that passes; equal pictures have 1")
        ->check(within(-1.0, 1.0));
    command->add_option("--mask", options->mask,
                        "PNG file of the same size: what is black in it is not compared");
    command->add_option(
        "--diff", options->diff,
        "write a picture of the differences to this PNG file, of two videos that of the worst "
        "frame, or of each pair that differs to this folder");
    command->add_flag("--force", options->force, "replace existing pictures of differences");
    command->callback([options, &action] {
        action = [options](const Console& console) { return compare(console, *options); };
    });
}

}  // namespace corda::app
