#include "corda/media/read/video_comment.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/child_process.hpp"
#include "corda/core/text.hpp"
#include "corda/media/read/decoder.hpp"

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

constexpr ChildLimits kCommentLimits{std::uint64_t{4} << 30, 20, 60.0};
[[noreturn]] void fail_reading(const std::string& path, ExitCode code, const std::string& problem,
                               std::string_view remedy) {
    throw_error(code, "cannot read '{}': {}; {}", path, problem, remedy);
}

std::string read_comment(const std::string& path, std::string_view remedy) {
    try {
        return metadata_entry(Decoder(path).format(), "comment");
    } catch (const Error& error) {
        fail_reading(path, ExitCode::kIo, error.what(), remedy);
    }
}

}  // namespace

std::string comment_in_child(const std::string& path, std::string_view remedy) {
    const QuietLog quiet;
    const auto end = run_in_child([&] { return read_comment(path, remedy); }, kCommentLimits);
    if (end && !end->finished()) fail_reading(path, ExitCode::kIo, "it " + end->text, remedy);
    std::string comment = end ? end->text : read_comment(path, remedy);
    if (const std::string problem = comment_problem(comment); !problem.empty())
        fail_reading(path, ExitCode::kUsage, "its comment " + problem, remedy);
    return comment;
}

}  // namespace corda::media
