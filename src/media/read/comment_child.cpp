#include <fmt/format.h>

#include <new>

#include "corda/core/basics.hpp"
#include "corda/core/child_process.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/read/open_video.hpp"
#include "corda/media/read/video_comment.hpp"

namespace corda::media {
namespace {

constexpr ChildLimits kCommentLimits{std::uint64_t{4} << 30, 20, 60.0};
constexpr char kTold = '+';
constexpr char kFailed = '-';
constexpr char kRefused = '!';

/// What the child tells: a sign, and the comment or what went wrong.
std::string comment_told(const std::string& path) {
    try {
        const OpenVideo file = open_video(path);
        const std::string comment = metadata_entry(*file.format, "comment");
        if (const std::string problem = comment_problem(comment); !problem.empty())
            return fmt::format("{}its comment {}", kRefused, problem);
        return kTold + comment;
    } catch (const Error& error) {
        return kFailed + std::string(error.what());
    } catch (const std::bad_alloc&) {
        return kFailed + std::string("it asks for more memory than it may have");
    }
}

}  // namespace

std::string comment_in_child(const std::string& path, const OnProgress& on_progress) {
    const QuietLog quiet;
    const auto end = run_in_child([&] { return comment_told(path); }, kCommentLimits,
                                  [&] { report_progress(on_progress, 0, 0); });
    const std::string told = !end ? comment_told(path) : end->finished ? end->text : kFailed + end->text;
    if (told.front() == kTold) return told.substr(1);
    throw Error(told.front() == kRefused ? ExitCode::kUsage : ExitCode::kIo,
                fmt::format("cannot read '{}': {}; give a PNG or a video that corda has written", path,
                            told.substr(1)));
}

}  // namespace corda::media
