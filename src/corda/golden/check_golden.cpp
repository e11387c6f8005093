#include "corda/golden/check_golden.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/golden/cases.hpp"
#include "corda/golden/record.hpp"
#include "corda/media/defs.hpp"

namespace corda::testing {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
    const char* const value = std::getenv(name);
    return value == nullptr ? "" : value;
}

bool is_update() {
    const std::string value = environment("CORDA_UPDATE_GOLDENS");
    return !value.empty() && value != "0";
}

fs::path folder_of(const GoldenOptions& options) {
    if (!options.folder.empty()) return options.folder;
    const std::string folder = environment("CORDA_GOLDEN_DIR");
    return folder.empty() ? "." : folder;
}

/// Writes the pictures that show a failure; says where.
std::string keep_artifacts(const std::string& name, const fs::path& golden_folder, const Image& drawn,
                           const std::optional<Picture>& golden) {
    const std::string folder = environment("CORDA_GOLDEN_ARTIFACTS");
    if (folder.empty())
        return "; set CORDA_GOLDEN_ARTIFACTS to a folder for the new picture and the difference";
    // A name that begins with / is put inside the folder, too.
    const fs::path stem = (fs::path(folder) / fs::path(name).relative_path()).replace_extension();
    make_folder(stem.parent_path().string());
    std::error_code none;
    if (fs::equivalent(stem.parent_path(), golden_folder, none))
        throw_usage(
            "CORDA_GOLDEN_ARTIFACTS is '{}', where the golden pictures are, and the next run would take "
            "{}.new.png for one of them; name another folder",
            folder, stem.filename().string());
    const std::string drawn_path = stem.string() + ".new.png";
    write_png(drawn_path, drawn, {}, {.force = true});
    if (!golden) return "; see " + drawn_path;
    const std::string difference_path = stem.string() + ".difference.png";
    write_png(difference_path, difference_image(*golden, {.image = drawn}), {}, {.force = true});
    return fmt::format("; see {} and {}", drawn_path, difference_path);
}

GoldenOutcome failure(const std::string& message) {
    return {.matches = false, .written = false, .message = message};
}

/// The probable cause of a difference from a kept picture: "; world.drag is 0.2 and was 0".
std::string cause_text(const std::string& path, const Film* film) {
    const PngInfo info = read_png_info(path);
    const Provenance made = provenance_in(info);
    const auto changes =
        film == nullptr ? std::vector<KeyChange>{} : golden::scene_changes(made, film->scene());
    if (!changes.empty()) return "; " + changes_text(changes);
    for (const auto& [keyword, text] : info.text) {
        const std::string now = fmt::format("corda {}", version());
        if (keyword == "Software" && text.starts_with("corda ") && text != now)
            return fmt::format("; {} drew it, and this is {}", text, now);
    }
    return film == nullptr || made.scene.empty() ? "" : "; its scene and its version of corda are the same";
}

/// How to repeat the test, and to accept the picture.
std::string remedy_text(const std::string& path, const std::string& rerun) {
    const auto made = golden::provenance_of_file(path);
    const std::string repeat = rerun.empty() ? "" : "; repeat the test: " + rerun;
    if (made && made->golden)
        return repeat + fmt::format("; accept it: corda golden SCENES --dir {} --only {} --update",
                                    fs::path(path).parent_path().string(), fs::path(path).stem().string());
    return repeat + "; accept it: CORDA_UPDATE_GOLDENS=1 " + (rerun.empty() ? "with the same test" : rerun);
}

GoldenOutcome update(const std::string& path, const Image& drawn, const std::string& why, const Film* film) {
    if (const auto made = golden::provenance_of_file(path); made && made->golden)
        return failure(why + "; update it by corda golden --update, which made it");
    if (golden::is_no_png(path))
        return failure(why + "; the file is no PNG and stays; remove it to have the picture written");
    make_folder(fs::path(path).parent_path().string());
    PngInfo info;
    if (film != nullptr)
        info = picture_info(film->scene().name, "", "", provenance_text(provenance_of(film->scene())));
    else
        info.text = {{"Software", fmt::format("corda {}", version())}};
    write_png(path, drawn, info, {.force = true});
    return {.matches = true, .written = true, .message = fmt::format("{}: written: {}", path, why)};
}

}  // namespace

GoldenOutcome check_golden(const Image& drawn, const std::string& name, const GoldenOptions& options) {
    if (!name.ends_with(golden::kEnding))
        throw_usage("a golden picture's name ends in .png, and '{}' does not", name);
    const fs::path path = folder_of(options) / name;
    const fs::path folder = path.parent_path().empty() ? "." : path.parent_path();
    const std::string file = path.filename().string();
    if (golden::has_one_color(drawn))
        return failure("the picture has one colour alone: nothing is in view" +
                       keep_artifacts(name, folder, drawn, std::nullopt));
    std::string why = fmt::format("there is no golden picture '{}'", path.string());
    std::optional<Picture> golden;
    for (const std::string& variant : golden::variants_of(golden::references_in(folder.string()), file)) {
        Picture one;
        try {
            one = read_picture(variant);
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo) throw;
            if (!golden) why = error.what();
            continue;
        }
        const Difference difference = compare(one, {.image = drawn});
        if (difference.within(options.limits)) return {.matches = true, .written = false, .message = {}};
        if (golden && fs::path(variant).filename() != file) continue;
        why = fmt::format("differs from '{}': {}{}", variant,
                          difference.same_size
                              ? figures_text(difference)
                              : fmt::format("{}x{} pixels, the golden picture {}x{}", drawn.width(),
                                            drawn.height(), one.image.width(), one.image.height()),
                          cause_text(variant, options.film));
        golden = std::move(one);
    }
    if (is_update()) return update(path.string(), drawn, why, options.film);
    why += remedy_text(path.string(), options.rerun);
    return failure(why + keep_artifacts(name, folder, drawn, golden));
}

}  // namespace corda::testing
