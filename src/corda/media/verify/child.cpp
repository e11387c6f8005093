#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "corda/core/child_process.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

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
ChildLimits limits_for(std::uint64_t bytes) {
    constexpr std::int64_t kMinS = 20;
    constexpr std::int64_t kBytesPerS = 1000;
    constexpr double kWallPerCpu = 3.0;  // the machine may be busy
    const std::int64_t cpu_s = kMinS + static_cast<std::int64_t>(bytes) / kBytesPerS;
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
    throw_error(ExitCode::kTemporary,
                "reading '{}' {}, perhaps because the system allows little memory (ulimit -v, ulimit -d): "
                "raise the limit; if that changes nothing, the file is damaged",
                path, end.text);
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
    throw_error(ExitCode::kTemporary,
                "'{}' cannot be judged in the memory that the system allows (ulimit -v, ulimit -d): raise "
                "the limit (found: {})",
                path, report.problems.front());
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
    std::error_code none;  // if it is no regular file
    const std::uintmax_t bytes = std::filesystem::file_size(path, none);
    const auto end =
        run_in_child([&] { return report_bytes(path, has_little, fps); }, limits_for(none ? 0 : bytes));
    if (!end) return verify(path, VerifyDepth::kAllFrames, {}, fps);
    if (!end->finished()) {
        throw_if_memory_may_lack(path, *end);
        return damaged(end->text);
    }
    VerifyReport report = Json::from_cbor(end->text);
    throw_if_memory_may_lack(path, report);
    return report;
}

void work_in_child(const std::string& path, std::uint64_t bytes, const std::function<void()>& work) {
    if (has_other_threads()) return work();  // see run_in_child
    const QuietLog quiet;
    const auto answering = [&work]() -> std::string {
        work();
        return {};
    };
    const auto end = run_in_child(answering, limits_for(bytes));
    if (!end) return work();
    if (end->finished()) return;
    throw_if_memory_may_lack(path, *end);
    throw_error(ExitCode::kMismatch, "'{}' is damaged: reading it {}; render it again (--force)", path,
                end->text);
}

}  // namespace corda::media
