#include "corda/scene/schema.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <map>

#include "corda/scene/readers.hpp"
#include "corda/scene/rows.hpp"

namespace corda::scene {
namespace {

std::vector<Key> root_keys() {
    const Type table = of(Kind::kTable);
    const Type tables = of(Kind::kTables);
    return {
        {"", "schema", one_of({"1"}, Kind::kInteger), "", required(), "the version of this list of keys"},
        {"", "world", table, "", none(), "what acts on every body, and for how long"},
        {"", "rope", tables, "", none(), "a chain of particles", "a scene has at least one rope or net"},
        {"", "net", tables, "", none(), "particles and bars in any graph"},
        {"", "solver", table, "", none(), "how the motion is computed"},
        {"", "video", table, "", none(), "picture size, frame rate and encoder"},
        {"", "style", table, "", none(), "how it looks"},
        {"", "overlay", table, "", none(), "words, a scale bar and a plot next to the picture"},
        {"", "camera", table, "", none(), "where the camera looks"},
        {"", "golden", table, "", none(), "which pictures `corda golden` keeps and compares"},
    };
}

/// The method that a definition belongs to; empty for others.
std::string_view method_of(std::type_index def) {
    std::string_view name;
    for_each_solver([&](const auto& solver) {
        if (def == typeid(solver)) name = solver.kName;
    });
    return name;
}

/// Derives the default and the methods from the fields.
void complete(Key& key) {
    Default& initial = key.binding.initial;
    for (const Field& one : key.binding.fields) {
        if (initial.toml.empty() && initial.words.empty() && !initial.required)
            initial.toml = one.initial(key);
        if (const std::string_view method = method_of(one.def); !method.empty())
            key.methods.push_back(method);
    }
}

constexpr std::string_view kColorWords =
    R"(such as "red", "#e8c07d", "#e8c07d80" (with alpha) or "transparent")";

std::string kind_text(Kind kind) {
    constexpr std::array kTexts{"table",   "list of tables", "true or false",
                                "integer", "number",         "text",
                                "colour",  "text",           "number or fraction as text"};
    return kTexts.at(static_cast<std::size_t>(kind));
}

std::string entries_text(const Key& key) {
    return key.type.min_entries == 0 ? "" : fmt::format("at least {}", key.type.min_entries);
}

std::string numbers_text(const Range& range) {
    const std::string low = fmt::format("{} {}", range.low_open ? ">" : ">=", number_text(range.low));
    const std::string high = fmt::format("{} {}", range.high_open ? "<" : "<=", number_text(range.high));
    const bool has_low = range.low != Range{}.low;
    const bool has_high = range.high != Range{}.high;
    if (has_low && has_high) {
        const bool closed = !range.low_open && !range.high_open;
        return closed ? fmt::format("{} .. {}", number_text(range.low), number_text(range.high))
                      : fmt::format("{} and {}", low, high);
    }
    return has_low ? low : has_high ? high : "";
}

std::string number_remedy(const Key& key) {
    std::string text = fmt::format("give {}", key.meaning);
    if (!key.unit.empty()) text += fmt::format(" in {}", key.unit);
    const std::string range = numbers_text(key.type.range);
    if (!range.empty()) text += ", " + range;
    std::vector<std::string> forms;
    if ((key.type.forms & kPair) != 0) forms.emplace_back(key.type.pair);
    if (!key.type.list.empty()) forms.emplace_back(key.type.list);
    if (key.type.forms == kPairs) forms.push_back(fmt::format("a list of {}", key.type.pair));
    for (const std::string_view name : key.type.names) forms.push_back(fmt::format("\"{}\"", name));
    if (!forms.empty())
        text += fmt::format(", {} {}", (key.type.forms & kOne) != 0 ? "or" : "as", fmt::join(forms, " or "));
    return key.type.min_entries == 0 ? text : fmt::format("{}, {}", text, entries_text(key));
}

std::string initial_text(const Key& key) {
    if (key.binding.initial.required) return "required";
    return key.binding.initial.toml.empty() ? std::string(key.binding.initial.words)
                                            : key.binding.initial.toml;
}

std::string meaning_text(const Key& key) {
    const std::string methods = key.methods.empty() ? "" : fmt::format("{}: ", fmt::join(key.methods, ", "));
    return methods + std::string(key.meaning) + (key.note.empty() ? "" : fmt::format("; {}", key.note));
}

/// "[world]", "[[rope]]", "rope.line": a section as a file writes it.
std::string heading(std::string_view section) {
    const Key* const table = key_of_section(section);
    if (table == nullptr) return "Top level";
    if (table->type.kind == Kind::kTables) return fmt::format("[[{}]]", section);
    return table->section.empty() ? fmt::format("[{}]", section) : std::string(section);
}

std::string text_row(const Key& key) {
    constexpr int kNameWidth = 21;
    std::string facts = type_text(key);
    if (!key.unit.empty()) facts += fmt::format(" in {}", key.unit);
    if (const std::string range = range_text(key); !range.empty()) facts += ", " + range;
    const std::string initial = initial_text(key);
    if (!initial.empty()) facts += (key.binding.initial.required ? ", " : ", default ") + initial;
    return fmt::format("  {:<{}}{}\n  {:<{}}{}\n", key.name, kNameWidth, facts, "", kNameWidth,
                       meaning_text(key));
}

}  // namespace

const std::vector<Key>& all_keys() {
    static const std::vector<Key> keys = [] {
        std::vector<Key> all = root_keys();
        for (const std::vector<Key>& rows : {model_rows(), picture_rows()})
            all.insert(all.end(), rows.begin(), rows.end());
        for (Key& key : all) complete(key);
        return all;
    }();
    return keys;
}

std::span<const Key> keys_of(std::string_view section) {
    static const std::map<std::string_view, std::span<const Key>> sections = [] {
        std::map<std::string_view, std::span<const Key>> all;
        const std::span<const Key> keys = all_keys();
        for (std::size_t first = 0, end = 0; first < keys.size(); first = end) {
            while (end < keys.size() && keys[end].section == keys[first].section) ++end;
            all.emplace(keys[first].section, keys.subspan(first, end - first));
        }
        return all;
    }();
    const auto found = sections.find(section);
    return found == sections.end() ? std::span<const Key>() : found->second;
}

const Key* find_key(std::string_view section, std::string_view name) {
    for (const Key& key : keys_of(section))
        if (key.name == name) return &key;
    return nullptr;
}

const Key* key_of_section(std::string_view section) {
    const std::size_t dot = section.rfind('.');
    if (dot == std::string_view::npos) return find_key("", section);
    return find_key(section.substr(0, dot), section.substr(dot + 1));
}

std::string dotted(std::string_view front, std::string_view name) {
    return front.empty() ? std::string(name) : fmt::format("{}.{}", front, name);
}

std::string path_of(const Key& key) {
    const Key* const table = key_of_section(key.section);
    if (table == nullptr) return std::string(key.name);
    return fmt::format("{}{}.{}", path_of(*table), table->type.kind == Kind::kTables ? "[]" : "", key.name);
}

std::string type_text(const Key& key) {
    if (!key.type.choices.empty()) return fmt::format("{}", fmt::join(key.type.choices, ", "));
    const std::string one = kind_text(key.type.kind);
    std::vector<std::string> forms;
    if ((key.type.forms & kOne) != 0) forms.push_back(one);
    if ((key.type.forms & kPair) != 0) forms.emplace_back(key.type.pair);
    if ((key.type.forms & kList) != 0) forms.push_back(fmt::format("list of {}s", one));
    if ((key.type.forms & kPairs) != 0) forms.push_back(fmt::format("list of {}", key.type.pair));
    if (!key.type.names.empty()) forms.push_back(fmt::format("{}", fmt::join(key.type.names, ", ")));
    return fmt::format("{}", fmt::join(forms, " or "));
}

std::string range_text(const Key& key) {
    const std::string numbers = numbers_text(key.type.range);
    const std::string entries = entries_text(key);
    return numbers + (numbers.empty() || entries.empty() ? "" : "; ") + entries;
}

std::string remedy(const Key& key) {
    const auto& choices = key.type.choices;
    const std::string_view quote = key.type.kind == Kind::kChoice ? "\"" : "";
    if (choices.size() == 1) return fmt::format("give {} = {}{}{}", key.name, quote, choices.front(), quote);
    if (!choices.empty()) return fmt::format("give one of: {}", fmt::join(choices, ", "));
    switch (key.type.kind) {
        case Kind::kTable:
            return key.section.empty() ? fmt::format("write [{}]", key.name)
                                       : fmt::format("give {}", key.meaning);
        case Kind::kTables:
            return path_of(key).find("[]") == std::string::npos
                       ? fmt::format("give one or more [[{}]]", path_of(key))
                       : fmt::format("give {} = [{{ ... }}], a table for each", key.name);
        case Kind::kBoolean:
            return "give true or false";
        case Kind::kColor:
            return fmt::format("give a {} {}", (key.type.forms & kOne) != 0 ? "colour" : "list of colours",
                               kColorWords);
        case Kind::kText:
            return fmt::format("give {} as one line of text in quotes", key.meaning);
        case Kind::kFraction:
            return fmt::format(
                R"(give {}, {}, as a number of up to three decimals or as a fraction in quotes such as "30000/1001")",
                key.meaning, range_text(key));
        default:
            return number_remedy(key);
    }
}

std::string keys_text(std::string_view only) {
    std::string text;
    std::string_view section = "none";
    for (const Key& key : all_keys()) {
        if (!only.empty() && key.section != only && !key.section.starts_with(fmt::format("{}.", only)))
            continue;
        if (text.empty()) text = "Keys of a scene file (TOML)\n";
        if (key.section != section) text += fmt::format("\n{}\n", heading(key.section));
        section = key.section;
        text += text_row(key);
    }
    return text;
}

std::string keys_markdown() {
    std::string text = "| key | value | unit | range | default | meaning |\n|---|---|---|---|---|---|\n";
    for (const Key& key : all_keys()) {
        text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", path_of(key), type_text(key), key.unit,
                            range_text(key), initial_text(key), meaning_text(key));
    }
    return text;
}

}  // namespace corda::scene
