#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/media/defs.hpp"
#include "corda/sweep/sample.hpp"

namespace corda::sweep {

/// How a sweep is run.
struct RunDef {
    std::string folder{};          ///< of the shards; made if there is none
    std::optional<Shard> shard{};  ///< make only every count-th shard file, from shard file `index` on
    int jobs = 0;                  ///< samples made at a time; 0: one per core. The bytes do not depend on it
    bool force = false;            ///< replace the shards of another sweep, and make finished ones again
    FilmDef film{};                ///< how to reach OpenGL
    OnProgress on_progress{};      ///< called with the number of samples; returning false stops
};

struct RunResult {
    std::int64_t shards = 0;       ///< number of shard files of this run
    std::int64_t shards_made = 0;  ///< those that were not finished before
    std::int64_t samples_made = 0;
    std::int64_t failed = 0;  ///< samples without files: of this run, or of the whole sweep if it is complete
    std::string first_failure{};  ///< key and reason of the first of them
    bool is_complete =
        false;  ///< all shard files of the sweep are there, with metadata.csv and manifest.json
};

/// Makes the shard files that are not finished, and metadata.csv and manifest.json when all are: see
/// README.md. The same sweep gives the same files, however its shards are made. Throws corda::Error: kUsage
/// if the folder holds another sweep, naming a difference, kIo (finished shards stay), kInterrupted, and what
/// SampleMaker::make() throws.
RunResult run_sweep(const SweepDef& sweep, const RunDef& def);

/// Reads all files again. Returns the problems: missing and damaged files, and those of another sweep.
/// Throws corda::Error (kIo, kInterrupted).
[[nodiscard]] std::vector<std::string> check_sweep(const SweepDef& sweep, const std::string& folder,
                                                   const OnProgress& on_progress = {});

/// A row of metadata.csv.
struct SampleRow {
    std::int64_t number = 0;
    Parameters parameters;
    std::map<std::string, double> summary;  ///< without those that do not apply
    std::optional<SampleFailure> failure;
};

/// Calls `take` with the samples of all finished shards, in order.
void read_rows(const SweepDef& sweep, const std::string& folder,
               const std::function<void(const SampleRow&)>& take);

}  // namespace corda::sweep
