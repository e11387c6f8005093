#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/core/output_file.hpp"
#include "corda/media/bytes.hpp"
#include "corda/sweep/archive.hpp"
#include "corda/sweep/sample.hpp"
#include "corda/sweep/sweep_file.hpp"

namespace corda::sweep {

// The files in the folder of a sweep: README.md describes them. They may be of any origin. All functions
// throw corda::Error (kIo).

[[nodiscard]] std::int64_t shard_count(const SweepDef& sweep);

/// The samples of a shard file.
struct SampleRange {
    std::int64_t first = 0;
    std::int64_t end = 0;
};
[[nodiscard]] SampleRange samples_of(const SweepDef& sweep, std::int64_t shard);

/// Paths of a shard file, of its index, and of the files about the whole sweep.
[[nodiscard]] std::string shard_path(const std::string& folder, std::int64_t shard);
[[nodiscard]] std::string index_path(const std::string& folder, std::int64_t shard);
[[nodiscard]] std::string metadata_path(const std::string& folder);
[[nodiscard]] std::string manifest_path(const std::string& folder);

/// The bytes of a file; std::nullopt if it is none or no ordinary one.
[[nodiscard]] std::optional<std::string> read_plain_file(const std::string& path);
/// Writes an ordinary file or replaces one; refuses a link, a pipe and a device.
void write_plain_file(const std::string& path, std::string_view text);

/// Makes the folder and its manifest. Throws kUsage if it holds another sweep, or one of more samples, and
/// kIo if it has files of a sweep's names but no manifest of a sweep. With `force`, another sweep is
/// accepted, and stays until clear_folder().
void open_folder(const SweepDef& sweep, const std::string& folder, bool force);
/// Removes the files of any sweep, and makes a new manifest.
void clear_folder(const SweepDef& sweep, const std::string& folder);
/// Clears `complete` in the manifest.
void mark_incomplete(const SweepDef& sweep, const std::string& folder);

/// The index of a shard file: its size, its checksum and the rows of its samples. It is written after the
/// shard, so that a shard with an index is finished. std::nullopt if there is no sound one for these samples
/// with a shard file of its size. Throws kUsage if it is of another sweep, or of one of more samples.
[[nodiscard]] std::optional<Json> find_index(const SweepDef& sweep, const std::string& folder,
                                             std::int64_t shard);
/// Throws kUsage if there is a shard file beyond the last one.
void refuse_surplus_shards(const SweepDef& sweep, const std::string& folder);

struct PackedSample {
    Json row;
    std::vector<std::pair<std::string, std::string>> files;  ///< name and bytes, in the order of the tar
};
[[nodiscard]] PackedSample pack(Sample sample);

/// Writes a shard file, and its index at the end.
class ShardWriter {
  public:
    ShardWriter(const SweepDef& sweep, const std::string& folder, std::int64_t shard);

    void add(PackedSample sample);
    void finish();

  private:
    void write(std::string_view bytes);

    std::string index_path_;
    OutputFile file_;
    media::Sha256 sum_;
    std::uint64_t bytes_ = 0;
    Json index_;
};

/// Contents of metadata.csv and manifest.json.
struct FolderSummary {
    std::string metadata;
    Json manifest;
};
/// std::nullopt if a shard is not finished.
[[nodiscard]] std::optional<FolderSummary> summary_of(const SweepDef& sweep, const std::string& folder);

}  // namespace corda::sweep
