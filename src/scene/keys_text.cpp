// What messages and documentation say about the keys.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "corda/scene/keys.hpp"

namespace corda::scene {
namespace {

constexpr std::string_view kColorWords =
    R"(such as "tomato", "#e8c07d", "#e8c07d80" (with alpha) or "transparent")";

std::string kind_text(Kind kind) {
    switch (kind) {
        case Kind::kTable:
            return "table";
        case Kind::kTables:
            return "list of tables";
        case Kind::kBoolean:
            return "true or false";
        case Kind::kInteger:
            return "integer";
        case Kind::kNumber:
            return "number";
        case Kind::kChoice:
            return "text";
        case Kind::kColor:
            return "colour";
        case Kind::kText:
            return "text";
        case Kind::kFrameRate:
            return "number or fraction as text";
    }
    return "";
}

std::string entries_text(const Key& key) {
    return key.type.least_entries == 0 ? "" : fmt::format("at least {}", key.type.least_entries);
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
    if (!forms.empty())
        text += fmt::format(", {} {}", (key.type.forms & kOne) != 0 ? "or" : "as", fmt::join(forms, " or "));
    return key.type.least_entries == 0 ? text : fmt::format("{}, {}", text, entries_text(key));
}

std::string initial_text(const Key& key) {
    if (key.initial.required) return "required";
    return key.initial.toml.empty() ? std::string(key.initial.words) : key.initial.toml;
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
    if (!initial.empty()) facts += (key.initial.required ? ", " : ", default ") + initial;
    return fmt::format("  {:<{}}{}\n  {:<{}}{}\n", key.name, kNameWidth, facts, "", kNameWidth,
                       meaning_text(key));
}

}  // namespace

std::string number_text(double value) {
    std::string plain = fmt::format("{}", value);
    std::string scientific = fmt::format("{:g}", value);
    const std::size_t e = scientific.find('e');
    if (e == std::string::npos) return plain;
    if (std::stod(scientific) != value) return plain;
    scientific.erase(std::remove(scientific.begin(), scientific.end(), '+'), scientific.end());
    const std::size_t digits = scientific.find_first_of("0123456789", e);
    if (scientific[digits] == '0') scientific.erase(digits, 1);
    return scientific.size() < plain.size() ? scientific : plain;
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
            return fmt::format("give one or more [[{}]]", path_of(key));
        case Kind::kBoolean:
            return "give true or false";
        case Kind::kColor:
            return fmt::format("give a {} {}", (key.type.forms & kOne) != 0 ? "colour" : "list of colours",
                               kColorWords);
        case Kind::kText:
            return fmt::format("give {} as one line of text in quotes", key.meaning);
        case Kind::kFrameRate:
            return fmt::format(
                R"(give {}, {}, as a number of up to three decimals or as a fraction in quotes such as "30000/1001")",
                key.meaning, range_text(key));
        default:
            return number_remedy(key);
    }
}

std::string keys_text() {
    std::string text = "Keys of a scene file (TOML)\n";
    std::string_view section = "none";
    for (const Key& key : all_keys()) {
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
