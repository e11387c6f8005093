#include "corda/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/bytes.hpp"
#include "corda/sweep/shard_folder.hpp"

namespace corda::sweep {
namespace {

/// Makes the samples of some shard files on several threads, and gives them in order.
class SampleQueue {
  public:
    SampleQueue(const SweepDef& sweep, const FilmDef& film, std::vector<std::int64_t> shards,
                std::int64_t samples, int jobs)
        : sweep_(&sweep), film_(film), shards_(std::move(shards)), workers_(0, samples, jobs, [this] {
              return [this, maker = std::make_shared<SampleMaker>(*sweep_, film_)](
                         std::int64_t index, const OrderedWorkers<PackedSample>& all) {
                  const CancelScope running([&all] { return !all.is_stopped(); });
                  return pack(maker->make(number_of(index)));
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
    /// Only the last shard file may have fewer samples than the others.
    [[nodiscard]] std::int64_t number_of(std::int64_t index) const {
        const std::int64_t shard = shards_[static_cast<std::size_t>(index / sweep_->shard_samples)];
        return shard * sweep_->shard_samples + index % sweep_->shard_samples;
    }

    const SweepDef* sweep_;
    FilmDef film_;
    std::vector<std::int64_t> shards_;  ///< ascending
    OrderedWorkers<PackedSample> workers_;
};

/// "000012: the reason"
std::string failure_text(const Json& row) {
    return fmt::format("{}: {}", row.at("key").get<std::string>(),
                       row.at("failure").at("message").get<std::string>());
}

/// Writes metadata.csv and the whole manifest, if all shards are finished.
void finish_folder(const SweepDef& sweep, const std::string& folder, RunResult& result) {
    const auto whole = summary_of(sweep, folder);
    if (!whole) return;
    write_plain_file(metadata_path(folder), whole->metadata);
    write_plain_file(manifest_path(folder), whole->manifest.dump(1) + "\n");
    result.is_complete = true;
    result.failed = whole->manifest.at("failed").get<std::int64_t>();
    if (result.failed > 0) result.first_failure = failure_text(whole->manifest.at("failures").front());
}

/// Whether all shards seem to be there. Their indices are not read: each of many tasks asks for it.
bool has_all_shards(const SweepDef& sweep, const std::string& folder) {
    std::int64_t shard = 0;
    while (shard < shard_count(sweep) && is_there(index_path(folder, shard))) {
        check_cancelled();
        ++shard;
    }
    return shard == shard_count(sweep);
}

/// The numbers of the shard files of a run that are to be made.
std::vector<std::int64_t> lacking_shards(const SweepDef& sweep, const RunDef& def, RunResult& result) {
    std::vector<std::int64_t> lacking;
    const Shard share = def.shard.value_or(Shard{});
    const std::int64_t count = shard_count(sweep);
    for (std::int64_t shard = share.index; shard < count; shard += share.count) {
        check_cancelled();
        ++result.shards;
        if (def.force || !find_index(sweep, def.folder, shard)) lacking.push_back(shard);
        if (share.count >= count - shard) break;  // the sum might overflow
    }
    return lacking;
}

/// Makes shard files.
void make_shards(const SweepDef& sweep, const RunDef& def, const std::vector<std::int64_t>& lacking,
                 RunResult& result) {
    std::int64_t total = 0;
    for (const std::int64_t shard : lacking)
        total += samples_of(sweep, shard).end - samples_of(sweep, shard).first;
    const auto report = [&] { report_progress(def.on_progress, result.samples_made, total); };
    SampleQueue samples(sweep, def.film, lacking, total,
                        static_cast<int>(std::min<std::int64_t>(jobs_of(def.jobs), total)));
    for (const std::int64_t shard : lacking) {
        PackedSample sample = samples.next(report);
        // Once there is a sample, it is known that samples can be made.
        if (result.samples_made == 0)
            def.force ? clear_folder(sweep, def.folder) : mark_incomplete(sweep, def.folder);
        ShardWriter writer(sweep, def.folder, shard);
        for (std::int64_t i = samples_of(sweep, shard).first;;) {
            if (sample.row.contains("failure") && result.failed++ == 0)
                result.first_failure = failure_text(sample.row);
            writer.add(std::move(sample));
            ++result.samples_made;
            if (++i == samples_of(sweep, shard).end) break;
            sample = samples.next(report);
        }
        writer.finish();
        ++result.shards_made;
    }
    report();
}

/// Throws corda::Error: kMismatch if a shard file is missing or damaged, kUsage if it is of another sweep.
void check_shard(const SweepDef& sweep, const std::string& folder, std::int64_t shard) {
    const std::string path = shard_path(folder, shard);
    const auto fail = [&path](const std::string& problem) {
        throw_error(ExitCode::kMismatch, "'{}' {}", path, problem);
    };
    const auto index = find_index(sweep, folder, shard);
    if (!index)
        fail(is_there(path) ? "does not fit its index; run the sweep again"
                            : "is missing; run the sweep again");
    if (media::sha256_of_file(path) != index->at("sha256").get<std::string>())
        fail(
            "is damaged: its SHA-256 is another one than its index says; remove it, and run the sweep again");
}

/// Throws corda::Error (kMismatch) if a file differs from the summary of the shards.
void check_text(const std::string& path, std::string_view expected) {
    if (read_plain_file(path) != expected)
        throw_error(ExitCode::kMismatch,
                    "'{}' does not say what the shards hold; remove it, and run the sweep again", path);
}

}  // namespace

RunResult run_sweep(const SweepDef& sweep, const RunDef& def) {
    open_folder(sweep, def.folder, def.force);
    RunResult result;
    const std::vector<std::int64_t> lacking = lacking_shards(sweep, def, result);
    if (!lacking.empty()) make_shards(sweep, def, lacking, result);
    if (has_all_shards(sweep, def.folder)) finish_folder(sweep, def.folder, result);
    return result;
}

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
        const FolderSummary whole = summary_of(sweep, folder).value();
        check([&] { check_text(metadata_path(folder), whole.metadata); });
        check([&] { check_text(manifest_path(folder), whole.manifest.dump(1) + "\n"); });
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
