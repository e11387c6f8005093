#include "corda/golden/cases.hpp"

#include <fnmatch.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/timeline.hpp"
#include "corda/media/format/file_kind.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;

/// Files of a folder with this ending, and links to nothing, sorted; with Iterator also those of the folders
/// in it.
template <class Iterator = fs::directory_iterator>
std::vector<std::string> files_in(const std::string& folder, const std::string& ending) {
    std::vector<std::string> paths;
    std::error_code failure;
    std::error_code none;  // the reader reports the error
    for (Iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure))
        if (entry->path().extension() == ending && (entry->is_regular_file(none) || !entry->exists(none)))
            paths.push_back(entry->path().string());
    if (failure) fail_file("read", folder, failure.value());
    std::ranges::sort(paths);
    return paths;
}

std::string name_of(const std::string& scene, double time_s) {
    std::string name = fmt::format("{}_t{:011.6f}", scene, time_s);
    std::replace(name.end() - 7, name.end(), '.', '_');
    return name;
}

/// The picture golden.mask of a scene. Throws corda::Error (kInvalidScene).
std::optional<Image> mask_of(const std::string& scene, const GoldenDef& golden) {
    if (golden.mask.empty()) return std::nullopt;
    const std::string path = (fs::path(scene).parent_path() / golden.mask).string();
    try {
        const Image mask = read_png(path);
        const Image blank(golden.width_px, golden.height_px);
        static_cast<void>(compare(blank, blank, &mask));
        return mask;
    } catch (const Error& error) {
        const Problem& problem = error.problems().front();
        throw Error(ExitCode::kInvalidScene, Problem{{.source = scene, .key = "golden.mask"},
                                                     fmt::format("'{}': {}", path, problem.what),
                                                     problem.remedy,
                                                     fmt::format("\"{}\"", golden.mask)});
    }
}

Case make_case(const std::string& path, const SuiteDef& def, std::set<std::string>& names) {
    Case made{.path = path, .scene = load_scene(path, def.settings), .pictures = {}, .mask = {}};
    if (!made.scene.golden) return made;
    made.mask = mask_of(path, *made.scene.golden);
    for (const double at_s : made.scene.golden->at_s) {
        const auto within_s = time_within(at_s, made.scene.world.duration_s);
        if (!within_s)
            throw Error(ExitCode::kInvalidScene,
                        Problem{{.source = path, .key = "golden.at"},
                                fmt::format("{} s is after the end of the motion, {} s", at_s,
                                            made.scene.world.duration_s),
                                "give an earlier time or a longer world.duration",
                                fmt::format("{}", at_s)});
        const double time_s = *within_s;
        made.pictures.push_back(
            {.scene = made.scene.name, .name = name_of(made.scene.name, time_s) + kEnding, .time_s = time_s});
        if (!names.insert(made.pictures.back().name).second)
            throw_usage(
                "two pictures would both be {}; rename '{}', or give times that differ by 1e-6 s or more",
                made.pictures.back().name, path);
    }
    return made;
}

/// True for a key `schema` of the root whose value is a number. Another value belongs to another program, for
/// instance the address of a JSON Schema. Files of a folder are judged by this before they are read as
/// scenes; a file that is named is always read.
bool has_schema(std::string_view text) {
    for (std::size_t at = 0; at < text.size(); at = std::min(text.find('\n', at), text.size() - 1) + 1) {
        const std::size_t word = text.find_first_not_of(" \t\"'", at);
        if (word == std::string_view::npos || text[word] == '[') return false;
        if (!text.substr(word).starts_with("schema")) continue;
        const std::size_t sign = text.find_first_not_of(" \t\"'", word + 6);
        if (sign == std::string_view::npos || text[sign] != '=') continue;
        const std::size_t value = text.find_first_not_of(" \t", sign + 1);
        return value != std::string_view::npos && text[value] >= '0' && text[value] <= '9';
    }
    return false;
}

/// SCENE of a name SCENE_tSSSS_FFFFFF.png, as name_of() makes it; empty for other names.
std::string scene_in_name(const std::string& name) {
    constexpr std::string_view kPattern = "_tdddd_dddddd.png";
    if (name.size() <= kPattern.size()) return "";
    const std::size_t begin = name.size() - kPattern.size();
    for (std::size_t i = 0; i < kPattern.size(); ++i) {
        const char c = name[begin + i];
        const bool is_digit = c >= '0' && c <= '9';
        // The d of a pattern is a digit.
        if (kPattern[i] == 'd' ? !is_digit : c != kPattern[i]) return "";
    }
    return name.substr(0, begin);
}

/// References that `corda golden` made and no scene asks for; if scenes are named one by one, of these alone.
/// Made by it are those that say so, and those without a record whose names are SCENE_tSSSS_FFFFFF.png.
std::vector<std::string> stale_ones(const SuiteDef& def, const Suite& suite) {
    std::set<std::string> used;
    std::set<std::string> scenes;
    for (const Case& one : suite.cases) {
        scenes.insert(printable(one.scene.name));
        for (const Checked& picture : one.pictures)
            for (const std::string& path : variants_of(suite.references, picture.name)) used.insert(path);
    }
    std::error_code none;
    const bool has_folder =
        std::ranges::any_of(def.paths, [&](const std::string& path) { return fs::is_directory(path, none); });
    std::vector<std::string> stale;
    for (const std::string& path : suite.references) {
        if (used.contains(path)) continue;
        const auto made = provenance_of_file(path);
        const std::string scene =
            made && made->golden ? made->name : printable(scene_in_name(fs::path(path).filename().string()));
        if (!scene.empty() && (has_folder || scenes.contains(scene))) stale.push_back(path);
    }
    return stale;
}

}  // namespace

Scene Case::drawn() const {
    Scene sized = scene;
    VideoDef& video = sized.video;
    video.width_px = scene.golden->width_px;
    video.height_px = scene.golden->height_px;
    sized.settings.push_back(fmt::format("video.size=[{}, {}]", video.width_px, video.height_px));
    return sized;
}

Suite load_suite(const SuiteDef& def) {
    Suite suite;
    std::set<std::string> names;
    std::error_code none;  // the reader reports the error
    const auto add = [&](const std::string& file, bool is_named) {
        if (fs::status(file, none).type() == fs::file_type::not_found && fs::is_symlink(file, none))
            throw_error(ExitCode::kInvalidScene,
                        "{}: a link to nothing; restore that file, or remove the link", file);
        if (!is_named && !has_schema(file_bytes(file))) {
            suite.passed_over.push_back(file);
            return;
        }
        Case made = make_case(file, def, names);
        if (made.scene.golden)
            suite.cases.push_back(std::move(made));
        else if (is_named)
            throw_usage("'{}' has no table [golden]; add one, for instance [golden] with at = [0.0, 1.0]",
                        file);
    };
    for (const std::string& path : def.paths) {
        const bool is_folder = fs::is_directory(path, none);
        for (const std::string& file :
             is_folder ? files_in<fs::recursive_directory_iterator>(path, ".toml") : std::vector{path}) {
            try {
                add(file, !is_folder);
            } catch (const Error& error) {
                const bool changes_references = def.update || !def.accepted.empty();
                if (error.code() != ExitCode::kInvalidScene || changes_references) throw;
                suite.invalid.push_back({.scene = fs::path(file).stem().string(),
                                         .name = file,
                                         .cause = {.kind = Cause::Kind::kInvalidScene,
                                                   .message = error.what(),
                                                   .problems = error.problems()}});
            }
        }
    }
    if (suite.cases.empty() && suite.invalid.empty())
        throw_usage(
            "no scene in '{}' has a table [golden]; add one, for instance [golden] with at = [0.0, 1.0]",
            def.paths.front());
    if (!def.accepted.empty()) return suite;
    suite.references = references_in(def.folder);
    if (suite.invalid.empty()) suite.stale = stale_ones(def, suite);
    return suite;
}

void select(const SuiteDef& def, Suite& suite) {
    std::vector<bool> is_used(def.only.size());
    std::set<std::string> known;
    const auto names_of = [](const std::string& file, const std::string& scene) {
        return std::array{file, fs::path(file).stem().string(), scene};
    };
    for (const Case& one : suite.cases)
        for (const Checked& picture : one.pictures)
            for (const std::string& name : names_of(picture.name, picture.scene)) known.insert(name);
    const auto is_named = [&](const std::string& file, const std::string& scene) {
        bool is = def.only.empty();
        for (std::size_t i = 0; i < def.only.size(); ++i)
            for (const std::string& name : names_of(file, scene))
                // A name that exists is no pattern, even if it has characters of one.
                if (name == def.only[i] ||
                    (!known.contains(def.only[i]) && fnmatch(def.only[i].c_str(), name.c_str(), 0) == 0))
                    is = is_used[i] = true;
        return is;
    };
    std::int64_t count = 0;
    const auto is_in_shard = [&] { return count++ % def.shard.count == def.shard.index; };
    for (Case& one : suite.cases) {
        const bool is_drawn = is_in_shard() && !def.stale_only;
        for (Checked& picture : one.pictures)
            picture.selected = is_named(picture.name, picture.scene) && is_drawn;
    }
    count = 0;
    std::erase_if(suite.stale, [&](const std::string& path) {
        const std::string name = fs::path(path).filename().string();
        return !is_named(name, scene_in_name(name)) || !is_in_shard();
    });
    count = 0;
    std::erase_if(suite.invalid,
                  [&](const Checked& scene) { return !is_named(scene.name, scene.scene) || !is_in_shard(); });
    for (std::size_t i = 0; i < def.only.size(); ++i) {
        if (is_used[i]) continue;
        const auto likely = nearest(def.only[i], std::vector<std::string_view>(known.begin(), known.end()));
        throw_usage("--only {}: no picture and no scene has this name{}", def.only[i],
                    likely ? fmt::format("; did you mean {}?", *likely) : "");
    }
}

void report_skipped_files(const Suite& suite, SuiteResult& result) {
    for (const std::string& file : suite.passed_over) {
        const bool has_stale = std::ranges::any_of(suite.stale, [&](const std::string& path) {
            return scene_in_name(fs::path(path).filename().string()) == fs::path(file).stem();
        });
        if (has_stale)
            result.notes.push_back(fmt::format(
                "{}: passed over, and its pictures are stale: it has no schema = 1; add this line", file));
        else
            result.details.push_back(file + ": passed over: no scene, as it has no schema = 1");
    }
}

std::optional<Provenance> provenance_of_file(const std::string& path) {
    try {
        return provenance_in(read_png_info(path));
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::string listed(std::vector<std::string> names, std::size_t most) {
    if (names.size() > most) {
        names.resize(most);
        names.emplace_back("...");
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

bool is_no_png(const std::string& path) {
    std::error_code none;
    return fs::is_regular_file(path, none) && !media::is_png(path);
}

bool lacks_record(const std::string& path) {
    const auto made = provenance_of_file(path);
    return made && !made->golden;
}

std::vector<std::string> references_in(const std::string& folder) {
    std::error_code failure;
    const bool is_missing = fs::status(folder, failure).type() == fs::file_type::not_found;
    return is_missing ? std::vector<std::string>{} : files_in(folder, kEnding);
}

std::vector<std::string> variants_of(const std::vector<std::string>& references, const std::string& name) {
    std::vector<std::string> variants;
    for (const std::string& path : references) {
        const fs::path file = fs::path(path).filename();
        const bool has_cause = file.stem().extension().string().size() > 1;
        if (file == name || (has_cause && file.stem().stem().string() + file.extension().string() == name))
            variants.push_back(path);
    }
    return variants;
}

bool has_one_color(const Image& image) {
    for (std::size_t i = 4; i < image.size_bytes(); i += 4)
        if (std::memcmp(image.data(), image.data() + i, 4) != 0) return false;
    return true;
}

}  // namespace corda::golden
