#include "corda/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/csv.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/encode/resources.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/sweep/archive.hpp"

namespace corda::sweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifestName = "manifest.json";
constexpr const char* kMetadataName = "metadata.csv";
constexpr std::size_t kMaxJsonFileBytes = std::size_t{1} << 30U;

std::int64_t shard_count(const SweepDef& sweep) {
    return (sweep.samples - 1) / sweep.shard_samples + 1;
}

/// The samples of a shard file.
struct SampleRange {
    std::int64_t first = 0;
    std::int64_t end = 0;
};

SampleRange samples_of(const SweepDef& sweep, std::int64_t shard) {
    const std::int64_t first = shard * sweep.shard_samples;
    return {first, std::min(first + sweep.shard_samples, sweep.samples)};
}

std::string shard_name(std::int64_t shard) {
    return fmt::format("shard-{:06}", shard);
}

/// Whether a file, without its folder, is one that a sweep writes.
bool is_sweep_file(const std::string& name) {
    return name == kManifestName || name == kMetadataName || name.starts_with("shard-");
}

/// Refuses what another sweep has made, naming the differences. Throws Json::exception if `made_from` is
/// none.
void require_same(const SweepDef& sweep, const Json& made_from, const std::string& path) {
    const auto changes = differences(identity_of(sweep), made_from.get<std::map<std::string, std::string>>());
    if (!changes.empty())
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' is of another sweep: {}; choose another folder, move it "
                                "away, or replace all shards (--force)",
                                path, differences_text(changes)));
}

/// The JSON object in a file; std::nullopt if there is no file, or none with an object.
std::optional<Json> read_json(const std::string& path) {
    std::error_code failure;
    if (fs::status(path, failure).type() != fs::file_type::regular || file_size(path) > kMaxJsonFileBytes)
        return std::nullopt;
    const FileHandle file = open_for_reading(path);
    std::string text(file_size(path), '\0');
    text.resize(read_bytes(file, path, text.data(), text.size()));
    Json json = Json::parse(text, nullptr, false);
    return json.is_object() ? std::optional(std::move(json)) : std::nullopt;
}

void write_text(const std::string& path, std::string_view text) {
    OutputFile file(path, {.force = true});
    file.write(text);
    file.commit();
}

[[noreturn]] void fail_larger(const std::string& path) {
    throw Error(ExitCode::kUsage,
                fmt::format("'{}' is of a sweep of more samples; move it away, or replace all "
                            "shards (--force)",
                            path));
}

/// The checksum of an index without its own.
std::string checksum_of(Json index) {
    index.erase("checksum");
    return hash_text(index.dump());
}

/// Throws Json::exception if a row of an index lacks what is read of it.
void check_row(const Json& row) {
    for (const char* const key : {"key", "split"})
        static_cast<void>(row.at(key).get_ref<const std::string&>());
    static_cast<void>(row.value("parameters", Json::object()).get_ref<const Json::object_t&>());
    static_cast<void>(row.value("summary", Json::object()).get_ref<const Json::object_t&>());
    if (!row.contains("failure")) return;
    static_cast<void>(row.at("failure").at("code").get<int>());
    static_cast<void>(row.at("failure").at("message").get_ref<const std::string&>());
}

/// The index of a shard file: its size, its checksum and the rows of its samples. It is written after the
/// shard, so that a shard with an index is finished. std::nullopt if there is no sound one for these samples
/// with a shard file of its size. Throws corda::Error (kUsage) if it is of another sweep.
std::optional<Json> find_index(const SweepDef& sweep, const std::string& folder, std::int64_t shard) {
    const std::string path = (fs::path(folder) / shard_name(shard)).string();
    auto index = read_json(path + ".json");
    if (!index || index->value("checksum", Json()) != checksum_of(*index)) return std::nullopt;
    try {
        require_same(sweep, index->at("made_from"), path + ".tar");
        const SampleRange samples = samples_of(sweep, shard);
        const auto rows = std::ssize(index->at("rows").get_ref<const Json::array_t&>());
        if (rows > samples.end - samples.first) fail_larger(path + ".tar");
        std::error_code failure;
        const bool is_finished =
            rows == samples.end - samples.first &&
            fs::file_size(path + ".tar", failure) == index->at("bytes").get<std::uintmax_t>();
        static_cast<void>(index->at("sha256").get_ref<const std::string&>());
        for (const Json& row : index->at("rows")) check_row(row);
        return is_finished ? std::move(index) : std::nullopt;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

/// Refuses a shard file beyond the last one.
void refuse_surplus_shards(const SweepDef& sweep, const std::string& folder) {
    const std::string last = shard_name(shard_count(sweep) - 1) + ".tar";
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (is_sweep_file(name) && name.ends_with(".tar") &&
            std::pair(name.size(), name) > std::pair(last.size(), last))
            fail_larger(entry.path().string());
    }
}

Json failure_json(const SampleFailure& failure) {
    return {{"code", static_cast<int>(failure.code)}, {"message", utf8(failure.message)}};
}

/// A sample as its files and its row in the index.
struct PackedSample {
    Json row;
    std::vector<std::pair<std::string, std::string>> files;  ///< name and bytes, in the order of the tar
};

PackedSample pack(Sample sample) {
    PackedSample packed;
    packed.row = {{"key", sample.key}, {"split", sample.split}};
    for (const auto& [key, value] : sample.parameters) packed.row["parameters"][key] = value;
    if (sample.failure) {
        packed.row["failure"] = failure_json(*sample.failure);
        return packed;
    }
    packed.row["summary"] = sample.info.at("summary");
    for (SampleFile& file : sample.pictures)
        packed.files.emplace_back(sample.key + file.ending, std::move(file.bytes));
    packed.files.emplace_back(sample.key + ".json", sample.info.dump(1) + "\n");
    packed.files.emplace_back(sample.key + ".npz", npz_bytes(sample.arrays));
    return packed;
}

/// Writes a shard file, and its index at the end.
class ShardWriter {
  public:
    ShardWriter(const SweepDef& sweep, const std::string& folder, std::int64_t shard)
        : path_((fs::path(folder) / shard_name(shard)).string()),
          file_(path_ + ".tar", {.force = true}),
          tar_([this](std::string_view bytes) {
              file_.write(bytes);
              sum_.add(bytes);
              bytes_ += bytes.size();
          }) {
        index_ = {{"schema", 1}, {"made_from", identity_of(sweep)}, {"rows", Json::array()}};
    }

    void add(PackedSample sample) {
        for (const auto& [name, bytes] : sample.files) tar_.add(name, bytes);
        index_["rows"].push_back(std::move(sample.row));
    }
    void finish() {
        tar_.finish();
        file_.commit();
        index_["bytes"] = bytes_;
        index_["sha256"] = sum_.text();
        index_["checksum"] = checksum_of(index_);
        write_text(path_ + ".json", index_.dump() + "\n");
    }

  private:
    std::string path_;
    OutputFile file_;
    media::Sha256 sum_;
    std::uint64_t bytes_ = 0;
    Json index_;
    TarWriter tar_;
};

Json empty_manifest(const SweepDef& sweep) {
    return {{"schema", 1}, {"corda", version()}, {"made_from", identity_of(sweep)}, {"complete", false}};
}

/// Makes the folder and its manifest; refuses the folder of another sweep.
void open_folder(const SweepDef& sweep, const RunDef& def) {
    make_folder(def.folder);
    const std::string path = (fs::path(def.folder) / kManifestName).string();
    remove_leftovers(def.folder, is_sweep_file);
    if (def.force) {
        std::vector<fs::path> old;
        for (const auto& entry : fs::directory_iterator(def.folder))
            if (entry.is_regular_file() && is_sweep_file(entry.path().filename().string()))
                old.push_back(entry.path());
        std::error_code ignored;
        for (const fs::path& file : old) fs::remove(file, ignored);
    }
    const auto found = read_json(path);
    if (!found && !fs::exists(path)) return write_text(path, empty_manifest(sweep).dump(1) + "\n");
    try {
        require_same(sweep, found.value_or(Json()).at("made_from"), path);
    } catch (const Json::exception&) {
        throw Error(ExitCode::kIo, fmt::format("'{}' is no manifest of a sweep; move it away, or choose "
                                               "another folder",
                                               path));
    }
    refuse_surplus_shards(sweep, def.folder);
}

/// Makes samples on several threads, and gives them in order.
class SampleQueue {
  public:
    SampleQueue(const SweepDef& sweep, const FilmDef& film, std::vector<std::int64_t> numbers, int jobs)
        : sweep_(&sweep),
          film_(film),
          numbers_(std::move(numbers)),
          workers_(0, std::ssize(numbers_), jobs, [this] {
              return [this, maker = std::make_shared<SampleMaker>(*sweep_, film_)](
                         std::int64_t index, const OrderedWorkers<PackedSample>& all) {
                  const CancelScope running([&all] { return !all.is_stopped(); });
                  return pack(maker->make(numbers_[static_cast<std::size_t>(index)]));
              };
          }) {}

    /// The next sample. Calls `wait` repeatedly meanwhile. Throws what makes no sample, and kTemporary if the
    /// system starts no thread.
    template <class Wait>
    PackedSample next(const Wait& wait) {
        if (!workers_.has_threads()) throw Error(ExitCode::kTemporary, "cannot start a thread; try again");
        while (true) {
            auto made = workers_.wait();
            wait();
            if (made) return std::move(*made);
        }
    }

  private:
    const SweepDef* sweep_;
    FilmDef film_;
    std::vector<std::int64_t> numbers_;
    OrderedWorkers<PackedSample> workers_;
};

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

/// What says of a whole sweep what its shards hold.
struct Summaries {
    std::string metadata;
    Json manifest;
};

/// std::nullopt if a shard is not finished.
std::optional<Summaries> summaries_of(const SweepDef& sweep, const std::string& folder) {
    Summaries whole{{}, empty_manifest(sweep)};
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

/// Writes metadata.csv and the whole manifest, if all shards are finished.
void finish_folder(const SweepDef& sweep, const std::string& folder, RunResult& result) {
    const auto whole = summaries_of(sweep, folder);
    if (!whole) return;
    write_text((fs::path(folder) / kMetadataName).string(), whole->metadata);
    write_text((fs::path(folder) / kManifestName).string(), whole->manifest.dump(1) + "\n");
    result.is_complete = true;
    result.failed = whole->manifest.at("failed").get<std::int64_t>();
    for (const Json& failed : whole->manifest.at("failures")) {
        result.first_failure = fmt::format("{}: {}", failed.at("key").get<std::string>(),
                                           failed.at("failure").at("message").get<std::string>());
        break;
    }
}

/// Whether all shards seem to be there. Their indices are not read: each of many tasks asks for it.
bool has_all_shards(const SweepDef& sweep, const std::string& folder) {
    std::int64_t shard = 0;
    while (shard < shard_count(sweep) && fs::exists(fs::path(folder) / (shard_name(shard) + ".json")))
        ++shard;
    return shard == shard_count(sweep);
}

/// The numbers of the shard files of a run that are not finished.
std::vector<std::int64_t> lacking_shards(const SweepDef& sweep, const RunDef& def, RunResult& result) {
    std::vector<std::int64_t> lacking;
    const Shard share = def.shard.value_or(Shard{});
    for (std::int64_t shard = share.index; shard < shard_count(sweep); shard += share.count) {
        check_cancelled();
        ++result.shards;
        if (!find_index(sweep, def.folder, shard)) lacking.push_back(shard);
    }
    return lacking;
}

}  // namespace

RunResult run_sweep(const SweepDef& sweep, const RunDef& def) {
    open_folder(sweep, def);
    RunResult result;
    const std::vector<std::int64_t> lacking = lacking_shards(sweep, def, result);
    std::vector<std::int64_t> numbers;
    for (const std::int64_t shard : lacking)
        for (std::int64_t i = samples_of(sweep, shard).first; i < samples_of(sweep, shard).end; ++i)
            numbers.push_back(i);
    const auto total = std::ssize(numbers);
    const auto report = [&] { report_progress(def.on_progress, result.samples_made, total); };
    if (total > 0) {
        SampleQueue samples(sweep, def.film, std::move(numbers),
                            static_cast<int>(std::min<std::int64_t>(media::jobs_of(def.jobs), total)));
        for (const std::int64_t shard : lacking) {
            ShardWriter writer(sweep, def.folder, shard);
            for (std::int64_t i = samples_of(sweep, shard).first; i < samples_of(sweep, shard).end; ++i) {
                PackedSample sample = samples.next(report);
                if (sample.row.contains("failure") && result.failed++ == 0)
                    result.first_failure =
                        fmt::format("{}: {}", sample.row.at("key").get<std::string>(),
                                    sample.row.at("failure").at("message").get<std::string>());
                writer.add(std::move(sample));
                ++result.samples_made;
            }
            writer.finish();
            ++result.shards_made;
        }
    }
    report();
    if (has_all_shards(sweep, def.folder)) finish_folder(sweep, def.folder, result);
    return result;
}

namespace {

/// Throws corda::Error: kMismatch if a shard file is missing or damaged, kUsage if it is of another sweep.
void check_shard(const SweepDef& sweep, const std::string& folder, std::int64_t shard) {
    const std::string path = (fs::path(folder) / (shard_name(shard) + ".tar")).string();
    const auto fail = [&path](const std::string& problem) {
        throw Error(ExitCode::kMismatch, fmt::format("'{}' {}", path, problem));
    };
    const auto index = find_index(sweep, folder, shard);
    if (!index)
        fail(fs::exists(path) ? "does not fit its index; run the sweep again"
                              : "is missing; run the sweep again");
    if (media::sha256_of_file(path) != index->at("sha256").get<std::string>())
        fail(
            "is damaged: its SHA-256 is another one than its index says; remove it, and run the sweep again");
    std::set<std::string> keys;
    list_tar(path,
             [&keys](const std::string& name, std::int64_t) { keys.insert(name.substr(0, name.find('.'))); });
    for (const Json& row : index->at("rows"))
        if (const auto key = row.at("key").get<std::string>(); keys.contains(key) == row.contains("failure"))
            fail("does not hold what its index says of sample " + key);
}

/// Throws corda::Error (kMismatch) if a file is not the one that the shards give.
void check_text(const fs::path& path, std::string_view expected) {
    std::string text;
    if (fs::is_regular_file(path) && file_size(path.string()) == expected.size()) {
        text.resize(expected.size());
        text.resize(read_bytes(open_for_reading(path.string()), path.string(), text.data(), text.size()));
    }
    if (text != expected)
        throw Error(ExitCode::kMismatch,
                    fmt::format("'{}' does not say what the shards hold; remove it, and run "
                                "the sweep again",
                                path.string()));
}

}  // namespace

std::vector<std::string> check_sweep(const SweepDef& sweep, const std::string& folder,
                                     const OnProgress& on_progress) {
    std::vector<std::string> problems;
    const auto check = [&problems](const auto& work) {
        try {
            work();
        } catch (const Error& error) {
            if (error.code() != ExitCode::kUsage && error.code() != ExitCode::kMismatch) throw;
            problems.emplace_back(error.what());
        }
    };
    check([&] { refuse_surplus_shards(sweep, folder); });
    const std::int64_t shards = shard_count(sweep);
    for (std::int64_t shard = 0; shard < shards; ++shard) {
        report_progress(on_progress, shard, shards);
        check([&] { check_shard(sweep, folder, shard); });
    }
    if (problems.empty()) {
        const Summaries whole = summaries_of(sweep, folder).value();
        check([&] { check_text(fs::path(folder) / kMetadataName, whole.metadata); });
        check([&] { check_text(fs::path(folder) / kManifestName, whole.manifest.dump(1) + "\n"); });
    }
    report_progress(on_progress, shards, shards);
    return problems;
}

void read_rows(const SweepDef& sweep, const std::string& folder,
               const std::function<void(const SampleRow&)>& take) {
    for (std::int64_t shard = 0; shard < shard_count(sweep); ++shard) {
        const auto index = find_index(sweep, folder, shard);
        if (!index) continue;
        std::int64_t number = samples_of(sweep, shard).first;
        for (const Json& row : index->at("rows")) {
            check_cancelled();
            SampleRow read{number++, {}, {}, {}};
            const Json parameters = row.value("parameters", Json::object());
            const Json summary = row.value("summary", Json::object());
            for (const auto& [key, value] : parameters.items()) read.parameters.emplace_back(key, value);
            for (const auto& [name, value] : summary.items())
                if (value.is_number()) read.summary[name] = value.get<double>();
            if (row.contains("failure"))
                read.failure = {static_cast<ExitCode>(row.at("failure").at("code").get<int>()),
                                row.at("failure").at("message").get<std::string>()};
            take(read);
        }
    }
}

}  // namespace corda::sweep
