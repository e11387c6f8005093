#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/child_process.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/read/open_video.hpp"
#include "corda/media/read/video_comment.hpp"

namespace corda::media {
namespace {

constexpr ChildLimits kCommentLimits{std::uint64_t{4} << 30, 20, 60.0};
[[noreturn]] void fail_reading(const std::string& path, ExitCode code, const std::string& problem) {
    throw Error(code, fmt::format("cannot read '{}': {}; give a PNG or a video that corda has written", path,
                                  problem));
}

std::string read_comment(const std::string& path) {
    try {
        const OpenVideo file = open_video(path);
        return metadata_entry(*file.format, "comment");
    } catch (const Error& error) {
        fail_reading(path, ExitCode::kIo, error.what());
    }
}

}  // namespace

std::string comment_in_child(const std::string& path, const OnProgress& on_progress) {
    const QuietLog quiet;
    const auto end = run_in_child([&] { return read_comment(path); }, kCommentLimits,
                                  [&] { report_progress(on_progress, 0, 0); });
    if (end && !end->finished()) fail_reading(path, ExitCode::kIo, "it " + end->text);
    std::string comment = end ? end->text : read_comment(path);
    if (const std::string problem = comment_problem(comment); !problem.empty())
        fail_reading(path, ExitCode::kUsage, "its comment " + problem);
    return comment;
}

}  // namespace corda::media
