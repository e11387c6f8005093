#include "corda/media/read/video_comment.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

using Json = nlohmann::json;

/// Parses text of any size and depth without recursion; what lies too deep is left out, and noted.
Json parse_to_level(std::string_view text, bool& is_too_deep) {
    const auto keep = [&is_too_deep](int depth, Json::parse_event_t event, const Json&) {
        const bool begins =
            event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
        if (begins && depth >= kDeepestJsonLevel) is_too_deep = true;
        return !is_too_deep;
    };
    return Json::parse(text, keep, false);
}

}  // namespace

std::string comment_problem(std::string_view comment) {
    if (comment.size() > kMaxJsonBytes)
        return fmt::format("has {} bytes, more than {}", comment.size(), kMaxJsonBytes);
    bool is_too_deep = false;
    static_cast<void>(parse_to_level(comment, is_too_deep));
    return is_too_deep ? fmt::format("is JSON nested more than {} levels deep", kDeepestJsonLevel) : "";
}

Json parse_untrusted_json(std::string_view text) {
    if (const std::string problem = comment_problem(text); !problem.empty())
        throw Error(ExitCode::kMismatch, problem);
    Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw Error(ExitCode::kMismatch, "is no JSON");
    return json;
}

namespace {

[[noreturn]] void fail_reading(const std::string& path, ExitCode code, const std::string& problem,
                               std::string_view remedy) {
    throw_error(code, "cannot read '{}': {}; {}", path, problem, remedy);
}

/// libav's question whether to give up.
int is_to_stop(void* /*unused*/) noexcept {
    try {
        check_cancelled();
        return 0;
    } catch (...) {
        return 1;
    }
}

}  // namespace

std::string video_comment(const std::string& path, std::string_view remedy) {
    const LogCapture log;
    // libav does not choose the demuxer: it takes a text file for ANSI art, and follows a playlist.
    const std::string kind = file_kind(path);
    const AVInputFormat* const demuxer = kind.empty() ? nullptr : av_find_input_format(kind.c_str());
    if (demuxer == nullptr) {
        const ForeignKind* const foreign = foreign_kind_of(path);
        fail_reading(path, ExitCode::kIo,
                     foreign == nullptr ? "it is no video of a kind that is known"
                                        : fmt::format("it is {}: {}", foreign->words, foreign->remedy),
                     remedy);
    }
    AVFormatContext* format = check_allocated(avformat_alloc_context(), "a demuxer");
    format->interrupt_callback.callback = &is_to_stop;
    const int status = avformat_open_input(&format, file_url(path).c_str(), demuxer, nullptr);
    check_cancelled();
    if (status < 0) fail_reading(path, ExitCode::kIo, libav_text(status), remedy);
    const InputFormat file(format);
    const AVDictionaryEntry* const entry = av_dict_get(file->metadata, "comment", nullptr, 0);
    std::string comment = entry == nullptr ? "" : entry->value;
    if (const std::string problem = comment_problem(comment); !problem.empty())
        fail_reading(path, ExitCode::kUsage, "its comment " + problem, remedy);
    return comment;
}

}  // namespace corda::media
