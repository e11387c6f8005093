#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/child_process.hpp"
#include "corda/core/machine.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Rational, num, den)

namespace media {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(VerifyReport, container, codec, profile, h264_level, pixel_format,
                                   width_px, height_px, fps, frames, duration_s, range, matrix, primaries,
                                   transfer, chroma_location, faststart, alpha, problems, notes)

namespace {

using Json = nlohmann::json;

// A frame of kMaxPicturePx has 100 MB, and a decoder holds up to some 20; others are far smaller.
constexpr int kMemoryGib = 4;
constexpr std::uint64_t kMemoryBytes = std::uint64_t{kMemoryGib} << 30;

/// In time, more than a sound file takes: measured are 0.06 s per kB, in a still scene, whose frames are
/// small.
ChildLimits limits_for(const std::string& path) {
    constexpr std::int64_t kMinS = 20;
    constexpr std::int64_t kBytesPerS = 1000;
    constexpr double kWallPerCpu = 3.0;  // the machine may be busy
    std::error_code none;                // if it is no regular file
    const std::uintmax_t size = std::filesystem::file_size(path, none);
    const std::int64_t bytes = none ? 0 : static_cast<std::int64_t>(size);
    const std::int64_t cpu_s = kMinS + bytes / kBytesPerS;
    return {kMemoryBytes, cpu_s, kWallPerCpu * static_cast<double>(cpu_s)};
}

VerifyReport damaged(const std::string& decoding) {
    VerifyReport report;
    report.problems.push_back(
        fmt::format("decoding {}; the file is damaged: copy or render it again", decoding));
    return report;
}

/// Whether the user allows less memory than a child may take: then a lack of it is not the file's fault.
bool has_little_memory() {
    const auto is_little = [](std::optional<std::uint64_t> left) { return left && *left < kMemoryBytes; };
    return is_little(address_space_left()) || is_little(data_left());
}

/// Throws corda::Error (kTemporary) for a file whose reading ended so, if a lack of memory may be
/// the reason.
void throw_if_memory_may_lack(const std::string& path, const ChildEnd& end) {
    if (!has_little_memory() || end.outcome != ChildEnd::Outcome::kCrashed) return;
    throw Error(
        ExitCode::kTemporary,
        fmt::format(
            "reading '{}' {}, perhaps because the system allows little memory (ulimit -v, ulimit -d): raise "
            "the limit; if that changes nothing, the file is damaged",
            path, end.text));
}

/// The same for problems that were found: without memory libavformat loses packets, and libavcodec frames,
/// and both say nothing (FFmpeg 7.1).
void throw_if_memory_may_lack(const std::string& path, const VerifyReport& report) {
    constexpr std::uint64_t kFrames = 24;  // that a decoder may hold
    const std::uint64_t needed = (std::uint64_t{32} << 20) + kFrames * 4 *
                                                                 static_cast<std::uint64_t>(report.width_px) *
                                                                 static_cast<std::uint64_t>(report.height_px);
    const auto is_less = [&](std::optional<std::uint64_t> left) { return left && *left < needed; };
    if (report.problems.empty() || !(is_less(address_space_left()) || is_less(data_left()))) return;
    throw Error(
        ExitCode::kTemporary,
        fmt::format("'{}' cannot be judged in the memory that the system allows (ulimit -v, ulimit -d): "
                    "raise the limit (found: {})",
                    path, report.problems.front()));
}

/// The report as CBOR, because the words may quote any bytes of the file.
std::string report_bytes(const std::string& path, bool has_little, std::optional<Rational> fps) {
    const auto report_of = [&] {
        const auto out_of_memory = [] {
            return damaged(fmt::format("asks for more memory than it may have ({} GiB)", kMemoryGib));
        };
        try {
            return verify(path, VerifyDepth::kAllFrames, {}, fps);
        } catch (const std::bad_alloc&) {
            if (has_little) throw Error(ExitCode::kTemporary, "out of memory");
            return out_of_memory();
        } catch (const Error& error) {
            if (error.code() != ExitCode::kTemporary || has_little) throw;
            return out_of_memory();
        }
    };
    std::string bytes;
    Json::to_cbor(report_of(), bytes);
    return bytes;
}

}  // namespace

VerifyReport verify_in_child(const std::string& path, std::optional<Rational> fps) {
    const bool has_little = has_little_memory();
    const auto end = run_in_child([&] { return report_bytes(path, has_little, fps); }, limits_for(path));
    if (!end) return verify(path, VerifyDepth::kAllFrames, {}, fps);
    if (!end->finished()) {
        throw_if_memory_may_lack(path, *end);
        return damaged(end->text);
    }
    VerifyReport report = Json::from_cbor(end->text);
    throw_if_memory_may_lack(path, report);
    return report;
}

void check_part_in_child(const std::string& path, bool decodes) {
    if (has_other_threads()) return;  // see run_in_child
    const QuietLog quiet;
    const auto read = [&]() -> std::string {
        try {
            static_cast<void>(index_part(path));
            if (decodes) static_cast<void>(verify(path));
        } catch (const std::exception&) {
            // This process comes to the same point, and reports it.
        }
        return {};
    };
    const auto end = run_in_child(read, limits_for(path));
    if (!end || end->finished()) return;
    throw_if_memory_may_lack(path, *end);
    throw Error(ExitCode::kMismatch,
                fmt::format("'{}' is damaged: reading it {}; render it again (--force)", path, end->text));
}

}  // namespace media
}  // namespace corda
