#include "corda/media/chunks/chunk_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/media/chunks/video_writer.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/video_comment.hpp"

namespace corda::media {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Manifest, made_from, fps, loop, first, end, per_chunk, title, comment)

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Use = ChunkFolder::Use;

constexpr const char* kManifestName = "corda.json";
constexpr const char* kUnnamedChunk = "chunk";
// Products of these do not overflow.
constexpr std::int64_t kMaxNumber = std::int64_t{1} << 32U;
constexpr std::int64_t kMaxPerChunk = std::int64_t{1} << 30U;

std::string manifest_path(const std::string& folder) {
    return folder + "/" + kManifestName;
}

/// The part of a manifest that determines the bytes of the chunks.
std::string identity_of(const Manifest& manifest) {
    Json json = manifest;
    json.erase("title");
    json.erase("comment");
    return json.dump();
}

/// Of a chunk of this video.
std::uint32_t checksum_of(const std::string& path, const Manifest& manifest) {
    std::uint32_t sum = 0;
    const auto add = [&sum](const char* bytes, std::size_t count) {
        sum = av_crc(av_crc_get_table(AV_CRC_32_IEEE_LE), sum, reinterpret_cast<const std::uint8_t*>(bytes),
                     count);
    };
    const std::string identity = identity_of(manifest);
    add(identity.data(), identity.size());
    const FileHandle file = open_for_reading(path);
    std::array<char, 1 << 16> block{};
    while (const std::size_t count = read_bytes(file, path, block.data(), block.size())) {
        check_cancelled();
        add(block.data(), count);
    }
    return sum;
}

std::string chunk_name(const ChunkFile& file, const std::string& ending) {
    return fmt::format("{:06}-{}-{:08x}{}", file.number, file.frames, file.checksum, ending);
}

/// The chunk of a file name; std::nullopt for another name.
std::optional<ChunkFile> chunk_of(const fs::path& path) {
    ChunkFile file;
    file.path = path.string();
    const std::string name = path.filename().string();
    const int read = std::sscanf(name.c_str(), "%" SCNd64 "-%" SCNd64 "-%" SCNx32, &file.number, &file.frames,
                                 &file.checksum);
    const bool is_one = read == 3 && file.number >= 0 && file.number <= kMaxNumber && file.frames > 0 &&
                        name == chunk_name(file, path.extension().string());
    return is_one ? std::optional(file) : std::nullopt;
}

/// Whether a name is one that OutputFile is given here, of which temporary names begin.
bool is_unnamed(const std::string& name) {
    return name == kUnnamedChunk || name == kManifestName;
}

struct Contents {
    std::vector<ChunkFile> chunks;
    bool has_manifest = false;
    bool has_others = false;
};

Contents contents_of(const std::string& folder) {
    Contents contents;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure); !failure && entry != fs::directory_iterator();
         entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        // A pipe or a device could be read for ever.
        const bool is_file = entry->symlink_status().type() == fs::file_type::regular;
        if (auto chunk = is_file ? chunk_of(entry->path()) : std::nullopt)
            contents.chunks.push_back(std::move(*chunk));
        else if (is_file && name == kManifestName)
            contents.has_manifest = true;
        else if (!name.ends_with(".tmp"))
            contents.has_others = true;
    }
    if (failure) fail_file("read", folder, failure.value());
    std::ranges::sort(contents.chunks, {},
                      [](const ChunkFile& chunk) { return std::pair(chunk.number, -chunk.frames); });
    return contents;
}

/// Opens the folder; an empty Descriptor if there is none.
Descriptor open_folder(const std::string& path) {
    Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (folder || errno == ENOENT) return folder;
    const int failure = errno;
    std::error_code ignored;
    if (fs::is_symlink(path, ignored))
        throw_error(ExitCode::kIo,
                    "'{}' is a symbolic link, which is not followed; put the folder that it leads to in its "
                    "place, or remove it",
                    path);
    if (failure != ENOTDIR) fail_file("read", path, failure);
    throw_error(ExitCode::kIo,
                "'{}' is no folder, and the chunks of the unfinished video need this name; move it away, or "
                "choose another name for the output",
                path);
}

/// Locks a folder. False if its name leads to another one by now. Throws corda::Error (kIo) if another
/// process uses it for longer than it takes to check it.
bool lock_folder(const Descriptor& folder, const std::string& path, Use use) {
    constexpr int kMaxTries = 25;
    const int kind = (use == Use::kShare ? LOCK_SH : LOCK_EX) | LOCK_NB;
    for (int tries = 0; ::flock(folder.get(), kind) != 0; ++tries) {
        if (errno != EWOULDBLOCK && errno != EINTR) break;  // a file system without locks
        if (tries == kMaxTries) fail_busy("'" + path + "'");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return leads_to(path, folder);
}

void refuse_other_contents(const std::string& path, Use use) {
    const Contents found = contents_of(path);
    if (found.has_others && !found.has_manifest)
        throw_error(ExitCode::kIo,
                    "'{}' holds other files, and the chunks of the unfinished video need this name; move it "
                    "away, or choose another name for the output",
                    path);
    if (use == Use::kNew && !found.chunks.empty())
        throw_error(ExitCode::kIo,
                    "'{}' holds an interrupted render; resume it (--resume), make it a video (corda "
                    "recover), move it away, or start again with force (--force)",
                    path);
}

/// Removes all files that Corda has named, the manifest last.
void clear(const std::string& path) {
    std::error_code ignored;
    for (const ChunkFile& chunk : contents_of(path).chunks) fs::remove(chunk.path, ignored);
    fs::remove(manifest_path(path), ignored);
    remove_leftovers(path, is_unnamed);
}

}  // namespace

std::int64_t Manifest::first_of(std::int64_t chunk) const {
    return std::max(first, chunk * per_chunk);
}

std::int64_t Manifest::end_of(std::int64_t chunk) const {
    return std::min(end, (chunk + 1) * per_chunk);
}

std::optional<Manifest> read_manifest(const std::string& folder) {
    constexpr const char* kRemedy = "it is damaged: start again (--force without --resume)";
    const std::string path = manifest_path(folder);
    if (!is_there(path)) return std::nullopt;
    std::error_code ignored;
    if (fs::symlink_status(path, ignored).type() != fs::file_type::regular)
        throw_error(ExitCode::kMismatch, "'{}' is no ordinary file; {}", path, kRemedy);
    try {
        const auto manifest = parse_untrusted_json(first_bytes(path, kMaxJsonBytes + 1)).get<Manifest>();
        const bool can_be = manifest.fps.is_rate() && manifest.first >= 0 && manifest.first < manifest.end &&
                            manifest.end <= CheckedVideo::kNoEnd && manifest.per_chunk >= 1 &&
                            manifest.per_chunk <= kMaxPerChunk;
        if (can_be) return manifest;
        throw Error(ExitCode::kMismatch, "has values that cannot be");
    } catch (const Json::exception&) {
        throw_error(ExitCode::kMismatch, "'{}' lacks a value; {}", path, kRemedy);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kMismatch) throw;
        throw_error(ExitCode::kMismatch, "'{}' {}; {}", path, error.what(), kRemedy);
    }
}

std::vector<ChunkFile> chunk_files(const std::string& folder) {
    return is_there(folder) ? contents_of(folder).chunks : std::vector<ChunkFile>{};
}

std::uint64_t bytes_of(const std::vector<ChunkFile>& files) {
    std::uint64_t bytes = 0;
    for (const ChunkFile& file : files) bytes += file_size(file.path);
    return bytes;
}

void ChunkFolder::check(const std::string& path, Use use) {
    const Descriptor folder = open_folder(path);
    if (folder && lock_folder(folder, path, use)) refuse_other_contents(path, use);
}

ChunkFolder::ChunkFolder(std::string path, Use use, Manifest manifest)
    : path_(std::move(path)), manifest_(std::move(manifest)) {
    while (!lock_ || !lock_folder(lock_, path_, use)) {
        if (::mkdir(path_.c_str(), 0777) == 0)
            sync_folder_of(path_);
        else if (errno != EEXIST)
            fail_file("make the folder", path_, errno);
        lock_ = open_folder(path_);
    }
    refuse_other_contents(path_, use);
    if (use == Use::kNew || use == Use::kReplace) clear(path_);
    remove_leftovers(path_, is_unnamed);
    if (const auto found = read_manifest(path_)) {
        if (identity_of(*found) != identity_of(manifest_))
            throw_usage("'{}' has chunks of another render", path_);
        return;
    }
    save_file(manifest_path(path_), Json(manifest_).dump(1) + "\n");
}

bool is_sound(const ChunkFile& file, const Manifest& manifest) {
    return checksum_of(file.path, manifest) == file.checksum;
}

ChunkRun ChunkFolder::run() const {
    ChunkRun run;
    const std::vector<ChunkFile> all = chunk_files(path_);
    auto file = all.begin();
    for (std::int64_t number = manifest_.first_chunk(); number < manifest_.end_chunk(); ++number) {
        const std::int64_t whole = manifest_.frames_of(number);
        std::optional<ChunkFile> found;
        for (; file != all.end() && file->number <= number; ++file) {
            if (found || file->number < number || file->frames > whole) continue;
            if (is_sound(*file, manifest_))
                found = *file;
            else
                run.is_damaged = true;
        }
        if (found) {
            run.frames += found->frames;
            run.chunks.push_back(*found);
        }
        if (!found || found->frames < whole) {
            run.gap = number;
            break;
        }
        run.is_damaged = false;
    }
    run.left_out = std::ssize(all) - std::ssize(run.chunks);
    return run;
}

ChunkFile ChunkFolder::add(std::int64_t number, std::int64_t frames, const std::string& ending,
                           const std::function<void(OutputFile&)>& write) {
    OutputFile output(path_ + "/" + kUnnamedChunk, {.force = true});
    write(output);
    ChunkFile file{number, frames, checksum_of(output.temporary_path(), manifest_)};
    file.path = path_ + "/" + chunk_name(file, ending);
    output.rename(file.path);
    output.commit();
    return file;
}

void ChunkFolder::remove() noexcept {
    try {
        if (!is_named()) return;
        clear(path_);
        ::rmdir(path_.c_str());
    } catch (const std::exception&) {
        return;
    }
}

}  // namespace corda::media
