#include "corda/scene/schema.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace corda::scene {
namespace {

using Json = nlohmann::ordered_json;

/// Keys of which a table has exactly one.
struct Alternatives {
    std::string_view section;
    std::vector<std::string_view> keys;
};
std::vector<Alternatives> alternatives() {
    return {{"rope", {"line", "hang", "points"}},
            {"rope.hang", {"length", "lengths"}},
            {"net", {"grid", "points"}}};
}

Json number_json(double value) {
    constexpr double kExact = 1e15;
    if (value == std::floor(value) && std::abs(value) < kExact) return static_cast<std::int64_t>(value);
    return value;
}

void add_range(const Range& range, Json& json) {
    if (range.low != Range{}.low)
        json[range.low_open ? "exclusiveMinimum" : "minimum"] = number_json(range.low);
    if (range.high != Range{}.high)
        json[range.high_open ? "exclusiveMaximum" : "maximum"] = number_json(range.high);
}

Json words_json(const Type& type) {
    Json words = Json::array();
    for (const std::string_view word : type.choices) {
        if (type.kind == Kind::kInteger)
            words.push_back(std::atoi(std::string(word).c_str()));
        else
            words.push_back(word);
    }
    return words;
}

Json value_json(const Type& type) {
    Json json;
    switch (type.kind) {
        case Kind::kTable:
        case Kind::kTables:
            return json;
        case Kind::kBoolean:
            return {{"type", "boolean"}};
        case Kind::kInteger:
        case Kind::kNumber:
            json["type"] = type.kind == Kind::kInteger ? "integer" : "number";
            add_range(type.range, json);
            break;
        case Kind::kChoice:
        case Kind::kText:
            json["type"] = "string";
            break;
        case Kind::kColor:
            return {{"type", "string"}, {"pattern", "^(#[0-9A-Fa-f]{6}([0-9A-Fa-f]{2})?|[A-Za-z]+)$"}};
        case Kind::kFraction: {
            Json number{{"type", "number"}};
            add_range(type.range, number);
            return {{"anyOf", {number, {{"type", "string"}, {"pattern", "^[0-9]+([./][0-9]+)?$"}}}}};
        }
    }
    if (!type.choices.empty()) json["enum"] = words_json(type);
    return json;
}

/// One of the forms that a key takes.
Json form_json(const Type& type, Form form) {
    Json value = value_json(type);
    Json pair{{"type", "array"}, {"items", value}, {"minItems", 2}, {"maxItems", 2}};
    if (form == kOne) return value;
    if (form == kPair) return pair;
    return {{"type", "array"}, {"items", form == kList ? value : pair}, {"minItems", type.min_entries}};
}

std::string description(const Key& key) {
    std::string text(key.meaning);
    if (!key.unit.empty()) text += ", in " + std::string(key.unit);
    if (!key.note.empty()) text += "; " + std::string(key.note);
    if (!key.binding.initial.words.empty()) text += "; default: " + std::string(key.binding.initial.words);
    for (std::size_t i = 0; i < key.methods.size(); ++i)
        text += (i == 0 ? "; method " : " or ") + std::string(key.methods[i]);
    return text;
}

Json table_json(std::string_view section);

Json key_json(const Key& key) {
    const Json about{{"description", description(key)}};
    Json json = about;
    if (key.type.kind == Kind::kTable || key.type.kind == Kind::kTables) {
        const Json table = table_json(dotted(key.section, key.name));
        if (key.type.kind == Kind::kTable)
            json.update(table);
        else
            json.update({{"type", "array"}, {"items", table}});
        return json;
    }
    std::vector<Json> forms;
    for (const Form form : {kOne, kPair, kList, kPairs})
        if ((key.type.forms & form) != 0) forms.push_back(form_json(key.type, form));
    if (!key.type.names.empty()) forms.push_back({{"enum", key.type.names}});
    if (forms.size() == 1)
        json.update(forms.front());
    else
        json["anyOf"] = forms;
    if (!key.binding.initial.toml.empty()) {
        // Values in TOML are values in JSON, except frame rates and the like.
        const Json initial = Json::parse(key.binding.initial.toml, nullptr, false);
        if (!initial.is_discarded()) json["default"] = initial;
    }
    return json;
}

Json table_json(std::string_view section) {
    Json properties = Json::object();
    Json required = Json::array();
    for (const Key& key : keys_of(section)) {
        properties[std::string(key.name)] = key_json(key);
        if (key.binding.initial.required) required.push_back(key.name);
    }
    Json json{{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    if (!required.empty()) json["required"] = required;
    for (const Alternatives& one : alternatives()) {
        if (one.section != section) continue;
        for (const std::string_view key : one.keys) json["oneOf"].push_back({{"required", {key}}});
    }
    return json;
}

}  // namespace

std::string json_schema() {
    Json json{{"$schema", "http://json-schema.org/draft-07/schema#"},
              {"title", "Corda scene"},
              {"description", "A scene file of Corda: see corda help scene"}};
    json.update(table_json(""));
    json["anyOf"] = {{{"required", {"rope"}}}, {{"required", {"net"}}}};
    constexpr int kIndent = 2;
    return json.dump(kIndent);
}

}  // namespace corda::scene
