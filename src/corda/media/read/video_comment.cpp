#include "corda/media/read/video_comment.hpp"

#include <fmt/format.h>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "corda/core/child_process.hpp"
#include "corda/core/text.hpp"
#include "corda/media/read/decoder.hpp"

void corda::to_json(nlohmann::json& json, const Rational& value) {
    json = {{"num", value.num}, {"den", value.den}};
}

void corda::from_json(const nlohmann::json& json, Rational& value) {
    json.at("num").get_to(value.num);
    json.at("den").get_to(value.den);
}

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

/// The comment as a JSON object; an empty one for any other text.
Json parse_comment(const std::string& comment) {
    try {
        Json json = parse_untrusted_json(comment);
        if (json.is_object()) return json;
    } catch (const Error&) {
        return Json::object();
    }
    return Json::object();
}

std::optional<std::int64_t> whole_number(const Json& json) {
    if (!json.is_number_integer()) return std::nullopt;
    if (json.is_number_unsigned() &&
        json.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()})
        return std::nullopt;
    return json.get<std::int64_t>();
}

std::optional<ColorPatch> parse_patch(const Json& json) {
    if (!json.is_array() || json.size() != 5) return std::nullopt;
    std::array<int, 5> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = whole_number(json[i]);
        if (!value || *value < 0 || *value > (i < 2 ? 65535 : 255)) return std::nullopt;
        values[i] = static_cast<int>(*value);
    }
    return ColorPatch{values[0],
                      values[1],
                      {static_cast<std::uint8_t>(values[2]), static_cast<std::uint8_t>(values[3]),
                       static_cast<std::uint8_t>(values[4])}};
}

Json patches_json(const std::vector<ColorPatch>& patches) {
    Json list = Json::array();
    for (const ColorPatch& patch : patches)
        list.push_back({patch.x, patch.y, patch.rgb[0], patch.rgb[1], patch.rgb[2]});
    return list;
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

std::optional<Rational> comment_rate(const std::string& comment) {
    const Json json = parse_comment(comment);
    const auto fps = json.contains("fps") && json["fps"].is_string()
                         ? Rational::parse(json["fps"].get<std::string>())
                         : std::nullopt;
    return fps && fps->num > 0 ? fps : std::nullopt;
}

std::optional<std::int64_t> comment_number(const std::string& comment, const char* key) {
    const Json json = parse_comment(comment);
    return json.contains(key) ? whole_number(json[key]) : std::nullopt;
}

std::vector<ColorPatch> comment_patches(const std::string& comment, const char* key) {
    const Json json = parse_comment(comment);
    std::vector<ColorPatch> patches;
    if (!json.contains(key) || !json[key].is_array()) return patches;
    for (const Json& entry : json[key]) {
        if (const auto patch = parse_patch(entry)) patches.push_back(*patch);
    }
    return patches;
}

std::string chunk_comment(const std::vector<FrameColors>& colors) {
    Json json{{"patches", patches_json(colors.front().patches)}};
    // A chunk that ended early has the colours of its first frame alone.
    if (colors.size() > 1) json["last_patches"] = patches_json(colors.back().patches);
    return json.dump();
}

std::string finished_comment(const std::string& comment, std::int64_t frames,
                             const std::vector<ColorPatch>& first) {
    Json json = parse_comment(comment);
    json["frames"] = frames;
    json["patches"] = patches_json(first);
    return json.dump();
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
