#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/rational.hpp"

namespace corda::media {

/// The folder of the chunks of an unfinished video.
[[nodiscard]] inline std::string parts_path(const std::string& path) {
    return path + ".parts";
}

/// The video that the chunks of a folder belong to: the file "corda.json" in it.
struct Manifest {
    std::map<std::string, std::string> made_from{};  ///< everything that determines the bytes, by key
    Rational fps{};
    int loop = 0;                ///< see VideoDef
    std::int64_t first = 0;      ///< number of the first frame in the film
    std::int64_t end = 0;        ///< one past the last
    std::int64_t per_chunk = 1;  ///< chunk c has those of the frames c * per_chunk <= k < (c + 1) * per_chunk
    std::string title{};
    std::string comment = "{}";  ///< JSON, without values that depend on the frames

    [[nodiscard]] std::int64_t first_chunk() const { return first / per_chunk; }
    [[nodiscard]] std::int64_t end_chunk() const { return (end - 1) / per_chunk + 1; }
    [[nodiscard]] std::int64_t first_of(std::int64_t chunk) const;
    [[nodiscard]] std::int64_t end_of(std::int64_t chunk) const;
    [[nodiscard]] std::int64_t frames_of(std::int64_t chunk) const { return end_of(chunk) - first_of(chunk); }
};

/// The manifest in a folder of any origin; std::nullopt if there is none. Throws corda::Error: kMismatch if
/// it is damaged, kIo.
[[nodiscard]] std::optional<Manifest> read_manifest(const std::string& folder);

/// A file with one chunk, as its name tells.
struct ChunkFile {
    std::int64_t number = 0;  ///< in the film
    std::int64_t frames = 0;
    std::uint32_t checksum = 0;  ///< of what the manifest says of the bytes, and of its own
    std::string path{};
};

/// The chunk files in a folder, by number and the longest first; none if there is no folder. Throws
/// corda::Error (kIo).
[[nodiscard]] std::vector<ChunkFile> chunk_files(const std::string& folder);
[[nodiscard]] std::uint64_t bytes_of(const std::vector<ChunkFile>& files);

/// Whether a file has its checksum. Throws corda::Error (kIo).
[[nodiscard]] bool is_sound(const ChunkFile& file, const Manifest& manifest);

/// Chunks in order, up to the first one that is missing, damaged or short.
struct ChunkRun {
    std::vector<ChunkFile> chunks;
    std::int64_t frames = 0;
    std::optional<std::int64_t> gap;  ///< the chunk that is missing, damaged or short; empty: all are there
    bool is_damaged = false;          ///< the gap is a file whose checksum does not match
    std::int64_t left_out = 0;        ///< other chunk files, with damaged ones
};

/// The folder `OUT.parts`: a file for each finished chunk, flushed to disk before it gets its name, and the
/// manifest. The name of a chunk file has its number, its frames and a checksum, so that equal chunks of
/// several machines have equal names, and it does not matter which one stays.
///
/// The folder is locked while the object lives: by one render, or by any number that share it. A file system
/// without locks locks nothing. A symbolic link under the name is never followed, and only files that Corda
/// has named are removed.
class ChunkFolder {
  public:
    /// Treatment of the chunks of an earlier render.
    enum class Use {
        kNew,       ///< they are refused
        kReplace,   ///< they are removed
        kContinue,  ///< they stay
        kShare,     ///< they stay, and other processes may add some
    };

    /// Refuses, before any work, a folder that cannot be used so. Throws corda::Error (kIo): if another
    /// process uses it, if it is no folder or holds other files and no manifest, or has chunks (kNew).
    static void check(const std::string& path, Use use);

    /// Makes the folder, if there is none, and its manifest. Throws as `check`, and kUsage if its manifest
    /// is of another video.
    ChunkFolder(std::string path, Use use, Manifest manifest);

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] const Manifest& manifest() const { return manifest_; }
    /// Whether its name still leads to this folder.
    [[nodiscard]] bool is_named() const { return leads_to(path_, lock_); }

    /// Throws corda::Error (kIo), like all below.
    [[nodiscard]] ChunkRun run() const;

    /// Adds a chunk of `frames` frames; `write` writes the file. `ending` is that of its name.
    ChunkFile add(std::int64_t number, std::int64_t frames, const std::string& ending,
                  const std::function<void(OutputFile&)>& write);

    /// Removes the chunks and the manifest, and the folder if nothing else is in it; never throws, because
    /// they do no harm.
    void remove() noexcept;

  private:
    std::string path_;
    Descriptor lock_;
    Manifest manifest_;
};

}  // namespace corda::media
