#include "corda/media/video_comment.hpp"

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

namespace corda::media {
namespace {

using Json = nlohmann::json;

/// The comment as a JSON object; an empty one for any other text.
Json parse_comment(const std::string& comment) {
    Json json = Json::parse(comment, nullptr, false);
    return json.is_object() ? json : Json::object();
}

std::optional<std::int64_t> whole_number(const Json& json) {
    if (!json.is_number_integer()) return std::nullopt;
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

}  // namespace

std::optional<Rational> told_rate(const std::string& comment) {
    const Json json = parse_comment(comment);
    const auto fps = json.contains("fps") && json["fps"].is_string()
                         ? Rational::parse(json["fps"].get<std::string>())
                         : std::nullopt;
    return fps && fps->num > 0 ? fps : std::nullopt;
}

std::optional<std::int64_t> told_number(const std::string& comment, const char* key) {
    const Json json = parse_comment(comment);
    return json.contains(key) ? whole_number(json[key]) : std::nullopt;
}

std::vector<ColorPatch> told_patches(const std::string& comment) {
    const Json json = parse_comment(comment);
    std::vector<ColorPatch> patches;
    if (!json.contains("patches") || !json["patches"].is_array()) return patches;
    for (const Json& entry : json["patches"]) {
        if (const auto patch = parse_patch(entry)) patches.push_back(*patch);
    }
    return patches;
}

std::map<std::string, std::string> told_origin(const std::string& comment) {
    const Json json = parse_comment(comment);
    std::map<std::string, std::string> origin;
    if (!json.contains(kOriginKey) || !json[kOriginKey].is_object()) return origin;
    for (const auto& [key, value] : json[kOriginKey].items())
        if (value.is_string()) origin.emplace(key, value.get<std::string>());
    return origin;
}

std::string finished_comment(const std::string& comment, std::size_t frames) {
    auto json = Json::parse(comment, nullptr, false);
    if (!json.is_object()) return comment;
    json.erase(kOriginKey);
    json["frames"] = frames;
    return json.dump();
}

}  // namespace corda::media
