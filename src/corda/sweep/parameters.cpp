#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "corda/core/text.hpp"
#include "corda/scene/schema.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/sweep/random.hpp"
#include "corda/sweep/sweep_file.hpp"

namespace corda::sweep {
namespace {

constexpr std::size_t kMaxIdentityText = 200;

/// One number of a distribution.
Json draw(const Distribution& distribution, std::size_t component, Random random, std::string_view key) {
    const double first = distribution.first[component];
    const double second = distribution.second[component];
    switch (distribution.shape) {
        case Shape::kUniform:
            return std::min(first + (second - first) * random.uniform(), second);
        case Shape::kLogUniform:
            return std::clamp(first * power_of(second / first, random.uniform()), first, second);
        case Shape::kInteger:
            return static_cast<std::int64_t>(first + std::floor((second - first + 1.0) * random.uniform()));
        case Shape::kNormal:
            break;
    }
    constexpr int kMaxTries = 1000;
    for (int tries = 0; tries < kMaxTries; ++tries) {
        const double value = first + second * random.normal();
        if (value >= distribution.min[component] && value <= distribution.max[component]) return value;
    }
    throw_error(
        ExitCode::kInvalidScene,
        "vary.\"{}\": of {} numbers of the normal distribution none was within its bounds; give wider bounds",
        key, kMaxTries);
}

}  // namespace

std::string toml_of(const Json& value) {
    if (value.is_number_float()) return scene::number_text(value.get<double>());
    if (!value.is_structured()) return value.dump();  // a string in JSON is one in TOML
    std::string text;
    for (const auto& [key, entry] : value.items()) {
        if (!text.empty()) text += ", ";
        if (value.is_object()) text += fmt::format("{} = ", Json(key).dump());
        text += toml_of(entry);
    }
    return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

Parameters parameters_of(const SweepDef& sweep, std::int64_t sample) {
    Parameters parameters(sweep.vary.size());
    std::int64_t rest = sample;
    for (std::size_t k = sweep.vary.size(); k-- > 0;) {
        const auto& [key, values] = sweep.vary[k];
        parameters[k].first = key;
        if (const auto* const choice = std::get_if<Choice>(&values)) {
            const std::int64_t count = std::ssize(choice->values);
            const auto drawn = static_cast<std::int64_t>(Random(sweep.seed, sample, key).uniform() *
                                                         static_cast<double>(count));
            parameters[k].second =
                choice->values[static_cast<std::size_t>(sweep.is_grid ? rest % count : drawn)];
            rest /= count;
            continue;
        }
        const auto& distribution = std::get<Distribution>(values);
        Json numbers = Json::array();
        for (std::size_t i = 0; i < distribution.first.size(); ++i)
            numbers.push_back(draw(distribution, i, Random(sweep.seed, sample, key, i), key));
        parameters[k].second = distribution.is_vector ? numbers : numbers.front();
    }
    return parameters;
}

std::string split_of(const SweepDef& sweep, std::int64_t sample) {
    if (sweep.splits.empty()) return "";
    double rest = Random(sweep.seed, sample, "[split]").uniform();
    for (const Split& split : sweep.splits) {
        if (rest < split.share) return split.name;
        rest -= split.share;
    }
    const auto last = std::find_if(sweep.splits.rbegin(), sweep.splits.rend(),
                                   [](const Split& split) { return split.share > 0.0; });
    return last->name;  // the shares were rounded
}

std::vector<Setting> settings_of(const Parameters& parameters) {
    std::vector<Setting> settings;
    for (const auto& [key, value] : parameters) settings.push_back(fmt::format("{}={}", key, toml_of(value)));
    std::ranges::sort(settings);  // as in the JSON of the sample; no two overlap
    return settings;
}

Scene scene_of(const SweepDef& sweep, const Parameters& parameters) {
    return parse_scene(sweep.scene_toml, sweep.scene_name, {}, {"vary", settings_of(parameters)});
}

std::string value_text(const Json& value) {
    return value.is_string() ? value.get<std::string>() : toml_of(value);
}

std::map<std::string, std::string> identity_of(const SweepDef& sweep) {
    std::map<std::string, std::string> identity{
        {"version", std::string(version())},
        {"scene", hash_text(sweep.scene_name + "\n" + sweep.scene_toml)},
        {"grid", sweep.is_grid ? "true" : "false"},
        {"seed", std::to_string(sweep.seed)},
        {"shard_samples", std::to_string(sweep.shard_samples)},
        {"output.pictures", std::string(kPictureNames[static_cast<std::size_t>(sweep.pictures)])},
        {"output.summary", fmt::format("{}", fmt::join(sweep.summary, " "))}};
    for (const Label* const label : sweep.labels)
        identity["output.labels"] += fmt::format("{} ", label->name);
    if (!sweep.encoder.empty()) identity["encoder"] = sweep.encoder;
    for (const Split& split : sweep.splits) identity["split." + split.name] = scene::number_text(split.share);
    for (std::size_t i = 0; i < sweep.vary.size(); ++i) {
        const auto& [key, values] = sweep.vary[i];
        std::string& text = identity["vary." + Json(key).dump()];
        text = sweep.is_grid ? fmt::format("{}: ", i) : "";
        if (const auto* const choice = std::get_if<Choice>(&values)) {
            text += Json(choice->values).dump();
        } else {
            const auto& distribution = std::get<Distribution>(values);
            text += fmt::format("{} {} {} {} {}", kShapeNames[static_cast<std::size_t>(distribution.shape)],
                                toml_of(distribution.first), toml_of(distribution.second),
                                toml_of(distribution.min), toml_of(distribution.max));
        }
        if (text.size() > kMaxIdentityText) text = hash_text(text);
    }
    return identity;
}

}  // namespace corda::sweep
