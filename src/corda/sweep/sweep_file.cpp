#include "corda/sweep/sweep_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "corda/core/text.hpp"
#include "corda/media/format/format.hpp"
#include "corda/scene/document.hpp"
#include "corda/scene/problems.hpp"
#include "corda/scene/read_file.hpp"
#include "corda/scene/schema.hpp"
#include "corda/sweep/summary.hpp"

namespace corda::sweep {
namespace {

using scene::described;
using scene::Problems;

constexpr double kMaxExactInteger = 9007199254740992.0;  // 2^53

/// The numbers that a shape takes.
struct ShapeRule {
    bool (*is_sound)(double first, double second);
    std::string_view remedy;
};

/// In the order of Shape.
constexpr std::array<ShapeRule, 4> kShapeRules{{
    {[](double least, double largest) { return least <= largest && std::isfinite(largest - least); },
     "is [least, largest], two numbers, the smaller first, or two vectors of one length"},
    {[](double least, double largest) {
         return least >= std::numeric_limits<double>::min() && least <= largest &&
                std::isfinite(largest / least);
     },
     "is [least, largest], two positive numbers or two vectors of one length"},
    {[](double, double deviation) { return deviation > 0.0; },
     "is [mean, standard deviation], the second positive, or two vectors of one length; bounds are min and "
     "max"},
    {[](double least, double largest) {
         return least == std::floor(least) && largest == std::floor(largest) && least <= largest &&
                std::max(std::abs(least), std::abs(largest)) <= kMaxExactInteger / 2;
     },
     "is [least, largest], two whole numbers, both included, or two vectors of one length"},
}};

Json json_of(const toml::node& node) {
    if (const auto* table = node.as_table()) {
        Json json = Json::object();
        for (const auto& [key, value] : *table) json[std::string(key.str())] = json_of(value);
        return json;
    }
    if (const auto* array = node.as_array()) {
        Json json = Json::array();
        for (const toml::node& entry : *array) json.push_back(json_of(entry));
        return json;
    }
    if (const auto text = node.value_exact<std::string>()) return *text;
    if (const auto integer = node.value_exact<std::int64_t>()) return *integer;
    if (const auto number = node.value_exact<double>()) return *number;
    if (const auto boolean = node.value_exact<bool>()) return *boolean;
    return nullptr;  // a date or a time, which no key of a scene takes
}

/// Whether a value has neither dates and times nor numbers that are not finite.
bool is_finite(const Json& value) {
    if (value.is_structured())
        return std::ranges::all_of(value, [](const Json& entry) { return is_finite(entry); });
    return !value.is_null() && (!value.is_number_float() || std::isfinite(value.get<double>()));
}

/// Reads the tables of a sweep file. What is wrong in them goes to the problems.
class SweepReader {
  public:
    SweepReader(const toml::table& document, Problems& problems, SweepDef& sweep)
        : document_(&document), problems_(&problems), sweep_(&sweep) {}

    void read() {
        refuse_others(
            *document_, "",
            {"schema", "scene", "samples", "grid", "seed", "shard_samples", "vary", "output", "split"});
        if (integer(*document_, "", "schema", 1, 1) != 1) missing("schema", "give schema = 1");
        if (const auto* scene = text(*document_, "scene", "give the path of a scene, relative to this file"))
            sweep_->scene_name = *scene;
        else
            missing("scene", "give the path of a scene, relative to this file");
        read_vary();
        read_samples();
        if (const auto seed = integer(*document_, "", "seed", 0, std::numeric_limits<std::int64_t>::max()))
            sweep_->seed = static_cast<std::uint64_t>(*seed);
        if (const auto count = integer(*document_, "", "shard_samples", 1, SweepDef::kMaxShardSamples))
            sweep_->shard_samples = *count;
        read_output();
        read_split();
    }

  private:
    using Names = std::vector<std::string_view>;

    void fail(const toml::node& node, std::string_view key, const std::string& problem) {
        problems_->add(node.source(), key, problem);
    }
    void missing(std::string_view key, const std::string& remedy) {
        if (!document_->contains(key)) fail(*document_, key, "is missing; " + remedy);
    }

    void refuse_others(const toml::table& table, const std::string& path, const Names& names) {
        for (const auto& [key, node] : table) {
            if (std::ranges::find(names, key.str()) != names.end()) continue;
            const auto meant = nearest(key.str(), names);
            const std::string remedy = meant ? fmt::format("did you mean \"{}\"?", *meant)
                                             : fmt::format("there are {}", fmt::join(names, ", "));
            problems_->add(key.source(), scene::dotted(path, key.str()),
                           fmt::format("unknown key \"{}\"; {}", scene::excerpt(key.str()), remedy));
        }
    }

    std::optional<std::int64_t> integer(const toml::table& table, const std::string& path,
                                        std::string_view key, std::int64_t low, std::int64_t high) {
        const toml::node* const node = table.get(key);
        if (node == nullptr) return std::nullopt;
        const auto value = node->value_exact<std::int64_t>();
        if (value && *value >= low && *value <= high) return value;
        fail(*node, scene::dotted(path, key),
             low == high ? fmt::format("{}; give {}", described(*node), low)
                         : fmt::format("{}; give an integer, {} .. {}", described(*node), low, high));
        return std::nullopt;
    }

    const std::string* text(const toml::table& table, std::string_view key, std::string_view remedy) {
        const toml::node* const node = table.get(key);
        if (node == nullptr || (node->is_string() && !node->as_string()->get().empty()))
            return node == nullptr ? nullptr : &node->as_string()->get();
        fail(*node, key, fmt::format("{}; {}", described(*node), remedy));
        return nullptr;
    }

    const toml::table* table(std::string_view key) {
        const toml::node* const node = document_->get(key);
        if (node != nullptr && !node->is_table())
            fail(*node, key, fmt::format("{}; give a table [{}]", described(*node), key));
        return node == nullptr ? nullptr : node->as_table();
    }

    /// The place of a word in a list of allowed ones.
    std::optional<std::size_t> word(const toml::node& node, const std::string& path, const Names& words) {
        const auto* const given = node.as_string();
        const auto found = given == nullptr ? words.end() : std::ranges::find(words, given->get());
        if (found != words.end()) return found - words.begin();
        fail(node, path, fmt::format("{}; give {}", described(node), fmt::join(words, ", ")));
        return std::nullopt;
    }

    void read_samples() {
        const toml::node* const grid = document_->get("grid");
        if (grid != nullptr && !grid->is_boolean())
            fail(*grid, "grid", fmt::format("{}; give true or false", described(*grid)));
        sweep_->is_grid = grid != nullptr && grid->value_or(false);
        const auto samples = integer(*document_, "", "samples", 1, SweepDef::kMaxSamples);
        if (!sweep_->is_grid) {
            missing("samples", "give a number of samples, or grid = true for every combination of lists");
            sweep_->samples = samples.value_or(0);
            return;
        }
        if (samples)
            fail(*document_->get("samples"), "samples",
                 "a grid has a sample for each combination; leave it out");
        sweep_->samples = 1;
        for (const VariedKey& varied : sweep_->vary) {
            const auto* const choice = std::get_if<Choice>(&varied.values);
            const std::string path = "vary." + Json(varied.key).dump();
            if (choice == nullptr) {
                fail(*(*document_)["vary"][varied.key].node(), path,
                     "a distribution has no combinations; give a list of values, or leave out grid");
                continue;
            }
            sweep_->samples *= std::ssize(choice->values);
            if (sweep_->samples > SweepDef::kMaxSamples) {
                fail(*grid, "grid",
                     fmt::format("more than {} combinations; give shorter lists", SweepDef::kMaxSamples));
                return;
            }
        }
    }

    void read_vary() {
        const toml::table* const vary = table("vary");
        if (vary == nullptr && document_->contains("vary")) return;  // it has a problem
        if (vary == nullptr || vary->empty())
            return fail(vary == nullptr ? *document_ : *vary, "vary",
                        "no key varies; give [vary] with keys of the scene and their values");
        std::vector<const toml::key*> keys;  // in the order of the file
        for (const auto& [key, node] : *vary) keys.push_back(&key);
        std::ranges::sort(keys, {}, [](const toml::key* key) { return key->source().begin; });
        for (const toml::key* const key : keys) read_varied(*key, *vary->get(key->str()));
    }

    void read_varied(const toml::key& key, const toml::node& node) {
        const std::string name(key.str());
        const std::string path = "vary." + Json(name).dump();
        if (!is_scene_key(name)) {
            problems_->add(key.source(), path, key_remedy(name));
        } else if (const auto* const list = node.as_array()) {
            Choice choice;
            for (const toml::node& value : *list) {
                if (!is_finite(json_of(value)))
                    fail(value, path,
                         described(value) + "; no key of a scene takes a date, a time, inf or nan");
                choice.values.push_back(json_of(value));
            }
            if (choice.values.empty()) fail(node, path, "an empty list; give values to choose from");
            sweep_->vary.push_back({name, std::move(choice)});
        } else if (const auto* const table = node.as_table()) {
            if (auto distribution = read_distribution(*table, path))
                sweep_->vary.push_back({name, std::move(*distribution)});
        } else {
            fail(node, path,
                 fmt::format("{}; give a list of values, or a distribution such as {{ uniform = "
                             "[1.0, 2.0] }}",
                             described(node)));
        }
    }

    /// A dotted key without its indices: its section and its name.
    static std::pair<std::string, std::string> parts_of(const std::string& key) {
        std::string path;
        bool is_index = false;
        for (const char c : key) {
            is_index = is_index || c == '[';
            if (!is_index) path += c;
            if (c == ']') is_index = false;
        }
        const std::size_t dot = path.rfind('.');
        return dot == std::string::npos ? std::pair(path, std::string())
                                        : std::pair(path.substr(0, dot), path.substr(dot + 1));
    }
    static bool is_scene_key(const std::string& key) {
        const auto [section, name] = parts_of(key);
        return !name.empty() && scene::find_key(section, name) != nullptr;
    }
    static std::string key_remedy(const std::string& key) {
        const auto [section, name] = parts_of(key);
        if (name.empty())
            return "no key of a scene; quote a dotted key, such as \"rope[0].hang.angle_deg\" (see corda "
                   "help scene)";
        Names names;
        for (const scene::Key& known : scene::keys_of(section)) names.push_back(known.name);
        const auto meant = nearest(name, names);
        return meant ? fmt::format("no key of a scene; did you mean \"{}\" in place of \"{}\"?", *meant, name)
                     : std::string("no key of a scene (see corda help scene)");
    }

    std::optional<Distribution> read_distribution(const toml::table& table, const std::string& path) {
        refuse_others(table, path, {"uniform", "log_uniform", "normal", "integer", "min", "max"});
        std::optional<Distribution> made;
        for (std::size_t i = 0; i < kShapeNames.size(); ++i) {
            const toml::node* const node = table.get(kShapeNames[i]);
            if (node == nullptr) continue;
            if (made) {
                fail(*node, path, "two distributions; give one");
                return std::nullopt;
            }
            const auto* const ends = node->as_array();
            made.emplace().shape = static_cast<Shape>(i);
            made->is_vector = ends != nullptr && ends->size() == 2 && ends->get(0)->is_array();
            const bool is_read = ends != nullptr && ends->size() == 2 &&
                                 read_numbers(*ends->get(0), made->is_vector, made->first) &&
                                 read_numbers(*ends->get(1), made->is_vector, made->second) &&
                                 std::ranges::equal(made->first, made->second, kShapeRules[i].is_sound);
            if (!is_read) {
                fail(*node, path, fmt::format("{} {}", kShapeNames[i], kShapeRules[i].remedy));
                return std::nullopt;
            }
        }
        if (!made) {
            if (problems_->is_sound(path))
                fail(table, path, fmt::format("no distribution; give {}", fmt::join(kShapeNames, ", ")));
            return made;
        }
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        made->min = read_bound(table, "min", -kInfinity, path, *made);
        made->max = read_bound(table, "max", kInfinity, path, *made);
        for (std::size_t i = 0; i < made->first.size(); ++i)
            if (made->min[i] >= made->max[i]) fail(table, path, "min is not less than max");
        return made;
    }

    static bool read_numbers(const toml::node& node, bool is_vector, std::vector<double>& numbers) {
        const auto add = [&numbers](const toml::node& entry) {
            if (!entry.is_number()) return false;
            numbers.push_back(scene::number_of(entry));
            return std::isfinite(numbers.back());
        };
        if (!is_vector) return add(node);
        const auto* const list = node.as_array();
        return list != nullptr && !list->empty() && list->size() <= std::size_t{1} << 16U &&
               std::all_of(list->begin(), list->end(), add);
    }

    std::vector<double> read_bound(const toml::table& table, std::string_view key, double open,
                                   const std::string& path, const Distribution& distribution) {
        std::vector<double> bound(distribution.first.size(), open);
        const toml::node* const node = table.get(key);
        if (node == nullptr) return bound;
        std::vector<double> given;
        if (distribution.shape != Shape::kNormal)
            fail(*node, path, fmt::format("{} bounds a normal distribution only; leave it out", key));
        else if (read_numbers(*node, distribution.is_vector, given) && given.size() == bound.size())
            return given;
        else
            fail(*node, path,
                 fmt::format("{}: {}; give as many numbers as normal has", key, described(*node)));
        return bound;
    }

    void read_output() {
        for (const Label& label : all_labels()) sweep_->labels.push_back(&label);
        for (const SummaryColumn& column : summary_columns()) sweep_->summary.emplace_back(column.name);
        const toml::table* const output = table("output");
        if (output == nullptr) return;
        refuse_others(*output, "output", {"pictures", "labels", "summary"});
        const Names picture_names(kPictureNames.begin(), kPictureNames.end());
        if (const toml::node* const node = output->get("pictures"))
            if (const auto pictures = word(*node, "output.pictures", picture_names))
                sweep_->pictures = static_cast<Pictures>(*pictures);
        Names labels;
        for (const Label& label : all_labels().subspan(1)) labels.push_back(label.name);
        if (const auto chosen = words(*output, "labels", labels)) {
            sweep_->labels.resize(1);
            for (std::size_t i = 0; i < labels.size(); ++i)
                if (std::find(chosen->begin(), chosen->end(), i) != chosen->end())
                    sweep_->labels.push_back(find_label(labels[i]));
        }
        const Names columns(sweep_->summary.begin(), sweep_->summary.end());
        if (const auto chosen = words(*output, "summary", columns)) {
            std::vector<std::string> names;
            for (const std::size_t i : *chosen) names.emplace_back(columns[i]);
            sweep_->summary = std::move(names);
        }
    }

    std::optional<std::vector<std::size_t>> words(const toml::table& output, const std::string& key,
                                                  const Names& allowed) {
        const toml::node* const node = output.get(key);
        if (node == nullptr) return std::nullopt;
        const auto* const list = node->as_array();
        std::vector<std::size_t> chosen;
        if (list == nullptr)
            fail(*node, "output." + key,
                 fmt::format("{}; give a list of {}", described(*node), fmt::join(allowed, ", ")));
        for (std::size_t i = 0; list != nullptr && i < list->size(); ++i)
            if (const auto place = word(*list->get(i), fmt::format("output.{}[{}]", key, i), allowed))
                if (std::ranges::find(chosen, *place) == chosen.end()) chosen.push_back(*place);
        return chosen;
    }

    void read_split() {
        const toml::table* const split = table("split");
        if (split == nullptr) return;
        double sum = 0.0;
        for (const auto& [key, node] : *split) {
            const std::string name(key.str());
            const double share = node.is_number() ? scene::number_of(node) : -1.0;
            if (!(share >= 0.0 && share <= 1.0))
                fail(node, "split." + name, fmt::format("{}; give a share, 0 .. 1", described(node)));
            if (name.empty() || name != printable(name) || name.find_first_of(",\"/ ") != std::string::npos)
                fail(node, "split." + name, "no name of a split; give a word such as train");
            sum += share;
            sweep_->splits.push_back({name, share});
        }
        if (!(std::abs(sum - 1.0) < 1e-9))
            fail(*split, "split", fmt::format("the shares have the sum {}; give shares with the sum 1", sum));
    }

    const toml::table* document_;
    Problems* problems_;
    SweepDef* sweep_;
};

/// Refuses a key that is another one or lies within it: one would replace the other.
void refuse_overlaps(const SweepDef& sweep, const toml::table& vary, Problems& problems) {
    const auto is_within = [](const std::string& inner, const std::string& outer) {
        const auto steps = scene::parse_key(inner);
        const auto first = scene::parse_key(outer);
        return steps && first && first->size() <= steps->size() &&
               std::equal(first->begin(), first->end(), steps->begin());
    };
    for (const VariedKey& inner : sweep.vary)
        for (const VariedKey& outer : sweep.vary)
            if (&inner != &outer && is_within(inner.key, outer.key))
                problems.add(
                    vary.get(inner.key)->source(), "vary." + Json(inner.key).dump(),
                    fmt::format("lies within \"{}\", which varies, too; leave one of them out", outer.key));
    problems.throw_if_any();
}

/// Refuses keys that do not fit the scene, such as an index beyond its list, before every sample does.
void check_varied_keys(const SweepDef& sweep, const toml::table& vary, Problems& problems) {
    toml::table document = scene::parse_document(sweep.scene_toml, sweep.scene_name);
    for (const VariedKey& varied : sweep.vary) {
        const std::string misfit = scene::misfit_of(document, varied.key);
        if (!misfit.empty())
            problems.add(vary.get(varied.key)->source(), "vary." + Json(varied.key).dump(),
                         fmt::format("does not fit {}: {}", sweep.scene_name, misfit));
    }
    problems.throw_if_any();
}

}  // namespace

SweepDef load_sweep(const std::string& path) {
    SweepDef sweep;
    sweep.source = scene::source_name(path);
    const toml::table document = scene::parse_document(scene::read_file(path, "sweep"), sweep.source);
    Problems problems(sweep.source, document);
    SweepReader(document, problems, sweep).read();
    problems.throw_if_any();
    const std::filesystem::path folder = path == "-" ? "" : std::filesystem::path(path).parent_path();
    try {
        sweep.scene_toml = scene::read_file((folder / sweep.scene_name).string());
    } catch (const Error& error) {
        const toml::source_position at = document.get("scene")->source().begin;
        throw_error(error.code(), "{}:{}:{}: scene: {}", sweep.source, at.line, at.column, error.what());
    }
    const Scene scene =
        parse_scene(sweep.scene_toml, sweep.scene_name);  // the sweep's end if it is not sound
    const toml::table& vary = *document.get_as<toml::table>("vary");
    refuse_overlaps(sweep, vary, problems);
    check_varied_keys(sweep, vary, problems);
    if (sweep.pictures == Pictures::kMp4)
        sweep.encoder = media::find_format("clip.mp4", scene.video).library_versions();
    return sweep;
}

}  // namespace corda::sweep
