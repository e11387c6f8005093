#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/cases.hpp"

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
    std::string name;
    std::string path;
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
            const std::string name = text("name");
            if (fs::path(name).filename() != name || !name.ends_with(kEnding) ||
                name.find('\0') != std::string::npos)
                throw Error(ExitCode::kUsage, printable(name) + " is no name of a picture");
            pictures.push_back(
                {name, join(folder, name), text("hash"), text("scene_hash"), text("reference_hash")});
        }
    } catch (const std::exception& error) {  // of Json, and kIo
        throw_usage("'{}' is no folder that corda golden --new has written: {}", folder,
                    printable(error.what()));
    }
    return pictures;
}

/// Why a new picture of these bytes is not what a suite asks for; empty if it is.
std::string problem_of(const NewPicture& one, const std::string& bytes, const Case& scene,
                       const Checked& picture, const SuiteDef& def) {
    if (hash_text(bytes) != one.hash) return "it was changed after corda golden --new wrote it";
    try {
        static_cast<void>(read_png(one.path));
    } catch (const Error& error) {
        return fmt::format("it is no picture: {}", error.what());
    }
    if (one.scene_hash != hash_of(scene, picture))
        return "it is of another scene; " + changes_text(scene_changes(provenance_in(read_png_info(one.path)),
                                                                       scene.drawn(), def.settings));
    const std::string reference = hash_of(picture.reference);
    const bool is_known = reference == one.reference_hash || reference == one.hash;
    return is_known ? "" : fmt::format("'{}' has changed since, or is another one", picture.reference);
}

/// Why a new picture replaces its reference.
Cause cause_of_change(const NewPicture& one, const Case& scene, const Checked& picture, const SuiteDef& def) {
    const auto made = provenance_of_file(one.path);
    const auto kept = provenance_of_file(picture.reference);
    if (!made || !made->golden || !kept) return {.kind = Cause::Kind::kUnknown};
    return cause_of(*kept, *made->golden, scene.drawn(), def.settings);
}

/// Why no picture was accepted, although none was refused. `left_out`: those that the folders have.
std::string nothing_text(const SuiteDef& def, const std::vector<std::string>& left_out) {
    const std::string folders = fmt::format("{}", fmt::join(def.accepted, "', '"));
    if (left_out.empty())
        return fmt::format(
            "nothing to accept: '{}' has no picture, as after a corda golden --new without failures",
            folders);
    return fmt::format(
        "nothing to accept: '{}' has other pictures than those of --only or --shard; leave that out, or name "
        "some of {}",
        folders, listed(left_out, 10));
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
            if (!files.contains(old.name) && hash_of(old.path) == old.hash) removed.push_back(old.path);
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
    Suite suite = load_suite(def);
    select(def, suite);
    report_skipped_files(suite, result);
    std::map<std::string, std::pair<const Case*, const Checked*>> known;
    for (const Case& one : suite.cases)
        for (const Checked& picture : one.pictures) known[picture.name] = {&one, &picture};
    Files files;
    std::map<std::string, std::string> hashes;
    std::vector<std::string> problems;
    std::vector<std::string> left_out;  // by --only or --shard
    for (const std::string& folder : def.accepted) {
        for (const NewPicture& one : new_pictures_in(folder)) {
            if (!is_there(one.path)) continue;
            const auto [scene, asked] = known[one.name];
            if (asked == nullptr) {
                problems.push_back(one.path + ": no scene asks for it");
                continue;
            }
            if (!asked->selected) {
                left_out.push_back(one.name);
                continue;
            }
            Checked picture = *asked;
            picture.reference = join(def.folder, one.name);
            picture.drawn_path = one.path;
            std::string bytes = file_bytes(one.path);
            std::string problem = problem_of(one, bytes, *scene, picture, def);
            const auto [other, is_first] = hashes.emplace(one.name, one.hash);
            if (!is_first && other->second != one.hash)
                problem = "another folder has another picture of this name";
            if (!problem.empty()) problems.push_back(one.path + ": " + problem);
            if (!problem.empty() || !is_first) continue;
            picture.changed = hash_of(picture.reference) != one.hash;
            if (picture.changed) {
                const bool is_missing = one.reference_hash.empty();
                picture.cause = is_missing ? Cause{.kind = Cause::Kind::kNoReference}
                                           : cause_of_change(one, *scene, picture, def);
                files[one.name] = std::move(bytes);
            }
            result.pictures.push_back(std::move(picture));
        }
    }
    if (!problems.empty())
        throw_usage(
            "nothing is accepted:\n  {}\nrun corda golden --new again, give the same --set, or remove these "
            "pictures from their folder",
            fmt::join(problems, "\n  "));
    if (result.pictures.empty()) result.notes.push_back(nothing_text(def, left_out));
    if (!def.dry_run) publish(def.folder, files, {});
    return result;
}

}  // namespace corda::golden
