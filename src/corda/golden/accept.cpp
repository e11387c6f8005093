#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/cases.hpp"
#include "corda/golden/record.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kManifest = "golden.json";

std::string join(const std::string& folder, const std::string& name) {
    return (fs::path(folder) / name).string();
}

/// The hash of a file; empty if there is none.
std::string hash_of(const std::string& path) {
    return is_there(path) ? hash_text(file_bytes(path)) : "";
}

/// The hash of what a picture shows.
std::string hash_of(const Case& one, const Checked& picture) {
    std::string text =
        fmt::format("{} {}x{}\n", picture.time_s, one.scene.golden->width_px, one.scene.golden->height_px);
    for (const auto& [key, value] : pixel_values(one.scene)) text += fmt::format("{}={}\n", key, value);
    return hash_text(text);
}

/// A picture in a folder that write_new() has written.
struct NewPicture {
    Checked picture;
    std::string hash;            ///< of its bytes
    std::string scene_hash;      ///< see hash_of()
    std::string reference_hash;  ///< of the file that it is to replace; empty: there was none
};

/// Throws corda::Error (kUsage) for any other folder.
std::vector<NewPicture> new_pictures_in(const std::string& folder) {
    std::vector<NewPicture> pictures;
    try {
        const Json manifest = Json::parse(file_bytes(join(folder, kManifest)));
        for (const Json& json : manifest.at("pictures")) {
            const auto text = [&](const char* key) { return json.at(key).get<std::string>(); };
            Checked picture{.scene = text("scene"), .name = text("name")};
            if (fs::path(picture.name).filename() != picture.name || !picture.name.ends_with(kEnding) ||
                picture.name.find('\0') != std::string::npos)
                throw Error(ExitCode::kUsage, printable(picture.name) + " is no name of a picture");
            picture.verdict =
                text("result") == word_of(Verdict::kMissing) ? Verdict::kMissing : Verdict::kDifferent;
            picture.difference.same_size = false;  // its figures are not read
            picture.drawn_path = join(folder, picture.name);
            picture.cause = printable(text("cause"));
            picture.group = printable(text("group"));
            pictures.push_back({picture, text("hash"), text("scene_hash"), text("reference_hash")});
        }
    } catch (const std::exception& error) {  // of Json, and kIo
        throw_usage("'{}' is no folder that corda golden --new has written: {}", folder,
                    printable(error.what()));
    }
    return pictures;
}

/// Why a picture of these bytes does not belong to this scene and reference; empty if it does.
std::string problem_of(const NewPicture& one, const std::string& bytes, const Case& scene,
                       const SuiteDef& def) {
    const Checked& picture = one.picture;
    if (hash_text(bytes) != one.hash) return "it was changed after corda golden --new wrote it";
    try {
        static_cast<void>(read_png(picture.drawn_path));
    } catch (const Error& error) {
        return fmt::format("it is no picture: {}", error.what());
    }
    if (one.scene_hash != hash_of(scene, picture)) {
        return "it is of another scene; " + scene_change(provenance_in(read_png_info(picture.drawn_path)),
                                                         load_scene(scene.path, scene.settings),
                                                         def.settings);
    }
    const std::string reference = hash_of(picture.reference);
    const bool is_known = reference == one.reference_hash || reference == one.hash;
    return is_known ? "" : fmt::format("'{}' has changed since, or is another one", picture.reference);
}

/// Why no picture was accepted, although none was refused. `left_out`: those that the folders have.
std::string nothing_text(const SuiteDef& def, std::vector<std::string> left_out) {
    const std::string folders = fmt::format("{}", fmt::join(def.accepted, "', '"));
    if (left_out.empty())
        return fmt::format(
            "nothing to accept: '{}' has no picture, as after a corda golden --new without failures",
            folders);
    constexpr std::size_t kMaxNamed = 10;
    const bool has_more = left_out.size() > kMaxNamed;
    if (has_more) left_out.resize(kMaxNamed);
    return fmt::format(
        "nothing to accept: '{}' has other pictures than those of --only or --shard; leave that out, or name "
        "some of {}{}",
        folders, fmt::join(left_out, ", "), has_more ? ", ..." : "");
}

}  // namespace

void publish(const std::string& folder, const Files& files, const std::vector<std::string>& removed) {
    if (files.empty() && removed.empty()) return;
    make_folder(folder);
    for (const auto& [name, bytes] : files) save_file(join(folder, name), bytes);
    for (const std::string& path : removed) {
        std::error_code failure;
        fs::remove(path, failure);
        if (failure) fail_file("remove", path, failure.value());
    }
}

void write_new(const SuiteDef& def, const std::vector<Case>& cases, const Files& files) {
    if (files.empty() && !is_there(def.new_folder)) return;
    std::vector<std::string> removed;
    if (is_there(join(def.new_folder, kManifest)))
        for (const NewPicture& old : new_pictures_in(def.new_folder))
            if (!files.contains(old.picture.name) && hash_of(old.picture.drawn_path) == old.hash)
                removed.push_back(old.picture.drawn_path);
    Json pictures = Json::array();
    for (const Case& one : cases) {
        for (const Checked& picture : one.pictures) {
            const auto file = files.find(picture.name);
            if (file == files.end()) continue;
            Json json = picture_json(picture);
            json.erase("new");  // the manifest moves with the pictures
            json["hash"] = hash_text(file->second);
            json["scene_hash"] = hash_of(one, picture);
            json["reference_hash"] = hash_of(join(def.folder, picture.name));
            pictures.push_back(json);
        }
    }
    publish(def.new_folder, files, removed);
    const Json manifest{{"schema", 1}, {"corda", version()}, {"pictures", pictures}};
    publish(def.new_folder,
            {{kManifest, manifest.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"}}, {});
}

SuiteResult accept(const SuiteDef& def) {
    SuiteResult result{.may_change = true, .dry_run = def.dry_run};
    SuiteDef strict = def;
    strict.update = true;  // an invalid scene is an error
    std::vector<Checked> invalid;
    std::vector<std::string> stale;
    std::vector<std::string> passed_over;
    std::vector<Case> cases = load_cases(strict, invalid, passed_over);
    select(def, cases, stale, invalid);
    report_skipped_files(passed_over, stale, result);
    std::map<std::string, std::pair<const Case*, const Checked*>> known;
    for (const Case& one : cases)
        for (const Checked& picture : one.pictures) known[picture.name] = {&one, &picture};
    Files files;
    std::map<std::string, std::string> hashes;
    std::vector<std::string> problems;
    std::vector<std::string> left_out;  // by --only or --shard
    for (const std::string& folder : def.accepted) {
        for (NewPicture& one : new_pictures_in(folder)) {
            Checked& picture = one.picture;
            const auto [scene, asked] = known[picture.name];
            if (!is_there(picture.drawn_path)) continue;
            if (asked != nullptr && !asked->selected) {
                left_out.push_back(picture.name);
                continue;
            }
            picture.reference = join(def.folder, picture.name);
            picture.time_s = asked == nullptr ? 0.0 : asked->time_s;
            std::string bytes = file_bytes(picture.drawn_path);
            std::string problem =
                asked == nullptr ? "no scene asks for it" : problem_of(one, bytes, *scene, def);
            const auto [other, is_first] = hashes.emplace(picture.name, one.hash);
            if (!is_first && other->second != one.hash)
                problem = "another folder has another picture of this name";
            if (!problem.empty()) problems.push_back(picture.drawn_path + ": " + problem);
            if (!is_first) continue;
            picture.changed = hash_of(picture.reference) != one.hash;
            if (!picture.changed) picture.verdict = Verdict::kPassed;
            if (picture.changed) files[picture.name] = std::move(bytes);
            result.pictures.push_back(picture);
        }
    }
    if (result.pictures.empty() && problems.empty()) result.notes.push_back(nothing_text(def, left_out));
    if (!problems.empty())
        throw_usage(
            "nothing is accepted:\n  {}\nrun corda golden --new again, give the same --set, or remove these "
            "pictures from their folder",
            fmt::join(problems, "\n  "));
    if (!def.dry_run) publish(def.folder, files, {});
    return result;
}

}  // namespace corda::golden
