#include "corda/serve/scene_numbers.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "corda/core/text.hpp"
#include "corda/scene/document.hpp"
#include "corda/scene/schema.hpp"

namespace corda::serve {
namespace {

constexpr std::size_t kMaxEntries = 4;  // of a list whose numbers count

/// A number with its place.
struct Found {
    SceneNumber number;
    toml::source_region region;
};

/// Collects the numbers of a document.
class Collector {
  public:
    std::vector<Found> collect(const toml::table& document) {
        add_table(document, "", "");
        std::ranges::sort(found_, {}, [](const Found& found) { return found.region.begin; });
        return std::move(found_);
    }

  private:
    /// `path` has the indices of tables, `section` has not.
    void add_table(const toml::table& table, const std::string& path, const std::string& section) {
        for (const auto& [key, node] : table) {
            const std::string key_path = scene::dotted(path, key.str());
            const std::string key_section = scene::dotted(section, key.str());
            if (section.empty() && (key.str() == "video" || key.str() == "golden" || key.str() == "schema"))
                continue;
            if (const auto* const inner = node.as_table()) {
                add_table(*inner, key_path, key_section);
            } else if (const auto* const list = node.as_array(); list != nullptr) {
                const bool has_tables = list->is_array_of_tables();
                for (std::size_t i = 0; i < list->size() && (has_tables || list->size() <= kMaxEntries);
                     ++i) {
                    const std::string entry = fmt::format("{}[{}]", key_path, i);
                    if (has_tables)
                        add_table(*list->get_as<toml::table>(i), entry, key_section);
                    else
                        add_number(*list->get(i), entry, scene::find_key(section, key.str()));
                }
            } else {
                add_number(node, key_path, scene::find_key(section, key.str()));
            }
        }
    }

    void add_number(const toml::node& node, const std::string& path, const scene::Key* key) {
        using scene::Kind;
        if (!node.is_number() || key == nullptr) return;
        const bool is_integer = key->type.kind == Kind::kInteger;
        const bool is_index = is_integer && (key->type.forms == scene::kList || key->name == "pin");
        if ((key->type.kind != Kind::kNumber && !is_integer) || is_index) return;
        const double value = scene::number_of(node);
        if (!std::isfinite(value)) return;
        found_.push_back(
            {{path, value, is_integer, key->type.range.low, key->type.range.high, key->type.range.low_open,
              std::string(key->unit), std::string(key->meaning), node.source().begin.line},
             node.source()});
    }

    std::vector<Found> found_;
};

std::string text_of(double value, bool is_integer) {
    return is_integer ? fmt::format("{:.0f}", value) : scene::number_text(value);
}

/// The offset of a place in a text; columns count characters, a byte order mark not.
std::size_t offset_of(std::string_view text, toml::source_position place) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    std::size_t offset = place.line == 1 && text.starts_with(kMark) ? kMark.size() : 0;
    for (std::size_t line = 1; line < place.line; ++line) offset = text.find('\n', offset) + 1;
    for (std::size_t column = 1; column < place.column; ++column) do
            ++offset;
        while (offset < text.size() && is_continuation(text[offset]));
    return offset;
}

/// Whether a text is a document with the same values.
bool says(const std::string& text, const toml::table& expected) {
    try {
        return scene::parse_document(text, "") == expected;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

std::vector<SceneNumber> numbers_of(std::string_view text, const std::string& name,
                                    const std::vector<Setting>& settings) {
    toml::table document = scene::parse_document(text, name);
    std::vector<SceneNumber> numbers;
    for (Found& found : Collector().collect(document)) numbers.push_back(std::move(found.number));
    scene::Problems ignored(name);  // parse_scene() tells them
    for (const Setting& setting : settings) scene::apply_setting(document, setting, ignored);
    for (SceneNumber& number : numbers)
        if (const auto node = document.at_path(number.key); node.is_number())
            number.value = scene::number_of(*node.node());
    return numbers;
}

std::vector<Setting> settings_of(const NumberChanges& changes, const std::vector<SceneNumber>& numbers) {
    std::vector<Setting> settings;
    for (const SceneNumber& number : numbers)
        if (const auto found = changes.find(number.key); found != changes.end())
            settings.push_back(fmt::format("{}={}", number.key, text_of(found->second, number.is_integer)));
    return settings;
}

bool sets(const Setting& setting, const std::string& key) {
    const auto inner = scene::parse_key(key);
    const auto outer = scene::parse_key(std::string_view(setting).substr(0, setting.find('=')));
    return inner && outer && outer->size() <= inner->size() &&
           std::equal(outer->begin(), outer->end(), inner->begin());
}

std::string with_changes(const std::string& before, const std::string& name, const NumberChanges& changes) {
    std::string text = before;
    std::vector<Found> all = Collector().collect(scene::parse_document(text, name));
    for (const auto& change : changes)
        if (std::ranges::none_of(all, [&](const Found& found) { return found.number.key == change.first; }))
            throw_usage("{} has no number {} any more", name, printable(change.first));
    toml::table expected = scene::parse_document(text, name);
    std::ranges::reverse(all);  // so that a change does not move the places of the others
    for (const auto& [number, region] : all) {
        const auto change = changes.find(number.key);
        if (change == changes.end()) continue;
        const std::size_t begin = offset_of(text, region.begin);
        const std::size_t end = std::min(text.find_first_of(" \t\r\n,]}#", begin), text.size());
        std::string changed = text_of(change->second, number.is_integer);
        const bool had_point = text.substr(begin, end - begin).find('.') != std::string::npos;
        if (had_point && changed.find_first_of(".e") == std::string::npos) changed += ".0";
        text.replace(begin, end - begin, changed);
        scene::Problems none(name);
        scene::apply_setting(expected, fmt::format("{}={}", number.key, changed), none);
    }
    if (!says(text, expected))
        throw_usage(
            "the numbers cannot be written to {} without a change of something else; change them there",
            name);
    return text;
}

}  // namespace corda::serve
