#include "corda/sweep/shard_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>

#include "corda/core/cancel.hpp"
#include "corda/core/csv.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda::sweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifestName = "manifest.json";
constexpr const char* kMetadataName = "metadata.csv";
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30U;

std::string shard_name(std::int64_t shard) {
    return fmt::format("shard-{:06}", shard);
}

/// The number of a shard file or an index; std::nullopt for another name.
std::optional<std::int64_t> shard_of(const std::string& name) {
    constexpr std::size_t kPrefix = std::string_view("shard-").size();
    if (name.size() < kPrefix) return std::nullopt;
    const auto shard =
        whole_number<std::int64_t>(std::string_view(name).substr(kPrefix, name.rfind('.') - kPrefix));
    const bool is_one =
        shard && *shard >= 0 && (name == shard_name(*shard) + ".tar" || name == shard_name(*shard) + ".json");
    return is_one ? shard : std::nullopt;
}

bool is_sweep_file(const std::string& name) {
    return name == kManifestName || name == kMetadataName || shard_of(name).has_value();
}

std::vector<std::string> sweep_files(const std::string& folder) {
    std::vector<std::string> names;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure); !failure && entry != fs::directory_iterator();
         entry.increment(failure))
        if (const std::string name = entry->path().filename().string(); is_sweep_file(name))
            names.push_back(name);
    if (failure && failure != std::errc::no_such_file_or_directory)
        fail_file("read", folder, failure.value());
    return names;
}

bool exists(const std::string& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

bool is_plain(const std::string& path) {
    std::error_code ignored;
    return fs::symlink_status(path, ignored).type() == fs::file_type::regular;
}

void refuse_unusual(const std::string& path) {
    if (exists(path) && !is_plain(path))
        throw_error(ExitCode::kIo, "'{}' is no ordinary file; move it away, or choose another folder", path);
}

/// The JSON object in a file; std::nullopt if there is none that is nested as little as Corda's.
std::optional<Json> read_json(const std::string& path) {
    constexpr int kMaxDepth = 32;
    const auto text = read_plain_file(path);
    if (!text) return std::nullopt;
    bool is_deep = false;
    const auto limit = [&is_deep](int depth, Json::parse_event_t, Json&) {
        is_deep = is_deep || depth > kMaxDepth;
        return !is_deep;
    };
    Json json = Json::parse(*text, limit, false);
    return json.is_object() && !is_deep ? std::optional(std::move(json)) : std::nullopt;
}

Json empty_manifest(const SweepDef& sweep) {
    return {{"schema", 1}, {"corda", version()}, {"made_from", identity_of(sweep)}, {"complete", false}};
}

std::string text_of(const Json& manifest) {
    return manifest.dump(1) + "\n";
}

/// The member "made_from" of a file. Throws Json::exception if it has none.
std::map<std::string, std::string> origin_of(const Json& json) {
    return json.at("made_from").get<std::map<std::string, std::string>>();
}

/// Refuses what another sweep has made, naming the differences.
void require_same(const SweepDef& sweep, const std::map<std::string, std::string>& origin,
                  const std::string& path) {
    const auto changes = differences(identity_of(sweep), origin);
    if (!changes.empty())
        throw_usage(
            "'{}' is of another sweep: {}; choose another folder, move it away, or replace all shards "
            "(--force)",
            path, differences_text(changes));
}

[[noreturn]] void fail_larger(const std::string& path) {
    throw_usage("'{}' is of a sweep of more samples; move it away, or replace all shards (--force)", path);
}

/// The origin in the manifest; std::nullopt if there is no manifest.
std::optional<std::map<std::string, std::string>> manifest_origin(const std::string& folder) {
    const std::string path = manifest_path(folder);
    if (!exists(path)) return std::nullopt;
    try {
        return origin_of(read_json(path).value_or(Json::object()));
    } catch (const Json::exception&) {
        throw_error(ExitCode::kIo, "'{}' is no manifest of a sweep; move it away, or choose another folder",
                    path);
    }
}

/// The origin in the first sound index of a folder; std::nullopt if there is none.
std::optional<std::map<std::string, std::string>> index_origin(const std::string& folder,
                                                               const std::vector<std::string>& files) {
    for (const std::string& name : files) {
        if (!name.ends_with(".json") || name == kManifestName) continue;
        try {
            return origin_of(read_json((fs::path(folder) / name).string()).value_or(Json::object()));
        } catch (const Json::exception&) {
            continue;
        }
    }
    return std::nullopt;
}

/// The checksum of an index without its own.
std::string checksum_of(Json index) {
    index.erase("checksum");
    return hash_text(index.dump());
}

/// Throws Json::exception if a row of an index lacks a member.
void check_row(const Json& row) {
    for (const char* const key : {"key", "split"})
        static_cast<void>(row.at(key).get_ref<const std::string&>());
    for (const char* const key : {"parameters", "summary"})
        if (row.contains(key)) static_cast<void>(row.at(key).get_ref<const Json::object_t&>());
    if (!row.contains("failure")) return;
    static_cast<void>(row.at("failure").at("code").get_ref<const std::uint64_t&>());
    static_cast<void>(row.at("failure").at("message").get_ref<const std::string&>());
}

Json failure_json(const SampleFailure& failure) {
    return {{"code", static_cast<unsigned>(failure.code)}, {"message", utf8(failure.message)}};
}

void add_row(const SweepDef& sweep, std::int64_t shard, const Json& row, CsvLine& line) {
    line.add(row.at("key").get<std::string>());
    line.add(shard_name(shard) + ".tar");
    line.add(row.at("split").get<std::string>());
    for (const VariedKey& varied : sweep.vary) {
        const Json values = row.value("parameters", Json::object());
        line.add(values.contains(varied.key) ? value_text(values.at(varied.key)) : std::string());
    }
    const Json summary = row.value("summary", Json::object());
    for (const std::string& name : sweep.summary) {
        const Json value = summary.value(name, Json());
        line.add(value.is_number() ? value_text(value) : std::string());
    }
    line.add(row.contains("failure") ? row.at("failure").at("message").get<std::string>() : std::string());
}

}  // namespace

std::int64_t shard_count(const SweepDef& sweep) {
    return (sweep.samples - 1) / sweep.shard_samples + 1;
}

SampleRange samples_of(const SweepDef& sweep, std::int64_t shard) {
    const std::int64_t first = shard * sweep.shard_samples;
    return {first, std::min(first + sweep.shard_samples, sweep.samples)};
}

std::string shard_path(const std::string& folder, std::int64_t shard) {
    return (fs::path(folder) / (shard_name(shard) + ".tar")).string();
}
std::string index_path(const std::string& folder, std::int64_t shard) {
    return (fs::path(folder) / (shard_name(shard) + ".json")).string();
}
std::string metadata_path(const std::string& folder) {
    return (fs::path(folder) / kMetadataName).string();
}
std::string manifest_path(const std::string& folder) {
    return (fs::path(folder) / kManifestName).string();
}

std::optional<std::string> read_plain_file(const std::string& path) {
    if (!is_plain(path) || file_size(path) > kMaxFileBytes) return std::nullopt;
    return file_bytes(path);
}

void write_plain_file(const std::string& path, std::string_view text) {
    refuse_unusual(path);
    save_file(path, text);
}

void open_folder(const SweepDef& sweep, const std::string& folder, bool force) {
    make_folder(folder);
    // In this order: another process makes the manifest before any other file.
    const std::vector<std::string> files = sweep_files(folder);
    auto origin = manifest_origin(folder);
    const bool has_manifest = origin.has_value();
    if (!origin) origin = index_origin(folder, files);
    if (!origin && !files.empty())
        throw_error(ExitCode::kIo,
                    "'{}' is there, and no manifest of a sweep; move it away, or choose another folder",
                    (fs::path(folder) / files.front()).string());
    if (!has_manifest) {
        OutputFile file(manifest_path(folder));
        file.write(text_of(empty_manifest(sweep)));
        file.flush();
        // A link, unlike a rename, never replaces the manifest of another process.
        std::error_code failure;
        fs::create_hard_link(file.temporary_path(), manifest_path(folder), failure);
        if (failure) origin = manifest_origin(folder);
        if (failure && !origin) file.commit();  // a file system without links
    }
    if (force) return;
    if (origin) require_same(sweep, *origin, manifest_path(folder));
    refuse_surplus_shards(sweep, folder);
}

void clear_folder(const SweepDef& sweep, const std::string& folder) {
    std::error_code ignored;
    for (const std::string& name : sweep_files(folder))
        if (name != kManifestName) fs::remove(fs::path(folder) / name, ignored);
    write_plain_file(manifest_path(folder), text_of(empty_manifest(sweep)));
}

void mark_incomplete(const SweepDef& sweep, const std::string& folder) {
    const auto manifest = read_json(manifest_path(folder));
    if (manifest && manifest->value("complete", Json()) == false) return;
    write_plain_file(manifest_path(folder), text_of(empty_manifest(sweep)));
}

std::optional<Json> find_index(const SweepDef& sweep, const std::string& folder, std::int64_t shard) {
    auto index = read_json(index_path(folder, shard));
    if (!index || index->value("checksum", Json()) != checksum_of(*index)) return std::nullopt;
    const std::string path = shard_path(folder, shard);
    try {
        require_same(sweep, origin_of(*index), path);
        const SampleRange samples = samples_of(sweep, shard);
        const auto rows = std::ssize(index->at("rows").get_ref<const Json::array_t&>());
        if (rows > samples.end - samples.first) fail_larger(path);
        for (const Json& row : index->at("rows")) check_row(row);
        static_cast<void>(index->at("sha256").get_ref<const std::string&>());
        const bool is_finished = rows == samples.end - samples.first && is_plain(path) &&
                                 file_size(path) == index->at("bytes").get_ref<const std::uint64_t&>();
        return is_finished ? std::move(index) : std::nullopt;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

void refuse_surplus_shards(const SweepDef& sweep, const std::string& folder) {
    for (const std::string& name : sweep_files(folder))
        if (shard_of(name).value_or(0) >= shard_count(sweep)) fail_larger((fs::path(folder) / name).string());
}

PackedSample pack(Sample sample) {
    PackedSample packed;
    packed.row = {{"key", sample.key}, {"split", sample.split}};
    for (const auto& [key, value] : sample.parameters) packed.row["parameters"][key] = value;
    try {
        if (!sample.failure) packed.files.emplace_back(sample.key + ".npz", npz_bytes(sample.arrays));
    } catch (const Error& error) {
        if (!is_refusal(error.code())) throw;
        sample.failure = {error.code(), error.what()};
    }
    if (sample.failure) {
        packed.row["failure"] = failure_json(*sample.failure);
        return packed;
    }
    packed.row["summary"] = sample.info.at("summary");
    std::vector<std::pair<std::string, std::string>> files;
    for (SampleFile& file : sample.pictures)
        files.emplace_back(sample.key + file.ending, std::move(file.bytes));
    files.emplace_back(sample.key + ".json", sample.info.dump(1) + "\n");
    files.push_back(std::move(packed.files.front()));
    packed.files = std::move(files);
    return packed;
}

ShardWriter::ShardWriter(const SweepDef& sweep, const std::string& folder, std::int64_t shard)
    : index_path_(index_path(folder, shard)),
      file_((refuse_unusual(shard_path(folder, shard)), shard_path(folder, shard)), {.force = true}) {
    index_ = {{"schema", 1}, {"made_from", identity_of(sweep)}, {"rows", Json::array()}};
}

void ShardWriter::write(std::string_view bytes) {
    file_.write(bytes);
    sum_.add(bytes);
    bytes_ += bytes.size();
}

void ShardWriter::add(PackedSample sample) {
    for (const auto& [name, bytes] : sample.files) write(tar_entry(name, bytes));
    index_["rows"].push_back(std::move(sample.row));
}

void ShardWriter::finish() {
    write(tar_end());
    file_.commit();
    index_["bytes"] = bytes_;
    index_["sha256"] = sum_.text();
    index_["checksum"] = checksum_of(index_);
    write_plain_file(index_path_, index_.dump() + "\n");
}

std::optional<FolderSummary> summary_of(const SweepDef& sweep, const std::string& folder) {
    FolderSummary whole{{}, empty_manifest(sweep)};
    CsvLine line;
    for (const char* const column : {"key", "shard", "split"}) line.add(std::string_view(column));
    for (const VariedKey& varied : sweep.vary) line.add(varied.key);
    for (const std::string& name : sweep.summary) line.add(name);
    line.add(std::string_view("failure"));
    whole.metadata += line.end();
    Json shards = Json::array();
    Json failures = Json::array();
    std::map<std::string, std::int64_t> splits;
    for (std::int64_t shard = 0; shard < shard_count(sweep); ++shard) {
        check_cancelled();
        const auto index = find_index(sweep, folder, shard);
        if (!index) return std::nullopt;
        std::int64_t failed = 0;
        for (const Json& row : index->at("rows")) {
            add_row(sweep, shard, row, line);
            whole.metadata += line.end();
            if (row.contains("failure")) {
                ++failed;
                failures.push_back({{"key", row.at("key")}, {"failure", row.at("failure")}});
            } else if (!sweep.splits.empty()) {
                ++splits[row.at("split").get<std::string>()];
            }
        }
        shards.push_back({{"file", shard_name(shard) + ".tar"},
                          {"bytes", index->at("bytes")},
                          {"sha256", index->at("sha256")},
                          {"samples", std::ssize(index->at("rows")) - failed},
                          {"failed", failed}});
    }
    Json& manifest = whole.manifest;
    manifest["complete"] = true;
    manifest["samples"] = sweep.samples - std::ssize(failures);
    manifest["failed"] = std::ssize(failures);
    manifest["splits"] = splits;
    manifest["shards"] = std::move(shards);
    manifest["failures"] = std::move(failures);
    return whole;
}

}  // namespace corda::sweep
