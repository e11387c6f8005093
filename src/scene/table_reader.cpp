#include "corda/scene/table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <tuple>

#include "corda/scene/keys.hpp"
#include "corda/scene/nearest_key.hpp"

namespace corda::scene {
namespace {

const toml::table& empty_table() {
    static const toml::table empty;
    return empty;
}

bool is_known(std::string_view section, std::string_view name) {
    return std::any_of(kKeys.begin(), kKeys.end(),
                       [&](const KeyText& key) { return key.section == section && key.name == name; });
}

bool stands_before(const toml::key& a, const toml::key& b) {
    const auto place = [](const toml::key& key) {
        return std::tuple(key.source().begin.line, key.source().begin.column);
    };
    return place(a) < place(b);
}

/// For a key that another table has: `; it is a key of video`.
std::string other_home(std::string_view name) {
    const auto* const key = std::find_if(kKeys.begin(), kKeys.end(),
                                         [&](const KeyText& candidate) { return candidate.name == name; });
    if (key == kKeys.end()) return "";
    return fmt::format("; it is a key of {}", key->section.empty() ? "the top level" : key->section);
}

}  // namespace

TableReader::TableReader(const Source& source, const toml::table& table, std::string_view section,
                         std::string path)
    : source_(&source), table_(&table), section_(section), path_(std::move(path)) {
    refuse_unknown_keys();
}

std::optional<Value> TableReader::find(std::string_view key) const {
    assert(is_known(section_, key));
    const toml::node* node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    return Value(*source_, *node, path_of(key));
}

Value TableReader::require(std::string_view key, std::string_view remedy) const {
    if (auto value = find(key)) return *std::move(value);
    source_->fail(table_->source(), path_of(key), fmt::format("missing; {}", remedy));
}

TableReader TableReader::table(std::string_view key, std::string_view remedy) const {
    const std::string section = section_.empty() ? std::string(key) : fmt::format("{}.{}", section_, key);
    const auto* const known = std::find_if(kKeys.begin(), kKeys.end(),
                                           [&](const KeyText& text) { return text.section == section; });
    assert(known != kKeys.end());
    const toml::node* node = table_->get(key);
    if (node == nullptr) return {*source_, empty_table(), known->section, path_of(key)};
    if (!node->is_table()) {
        source_->fail(node->source(), path_of(key),
                      fmt::format("{}, not a table; {}", described(*node), remedy));
    }
    return {*source_, *node->as_table(), known->section, path_of(key)};
}

void TableReader::read_number(std::string_view key, double& target, const Range& range,
                              std::string_view remedy) const {
    if (const auto value = find(key)) target = value->number(range, remedy);
}

void TableReader::read_number(std::string_view key, std::optional<double>& target, const Range& range,
                              std::string_view remedy) const {
    if (const auto value = find(key)) target = value->number(range, remedy);
}

void TableReader::read_integer(std::string_view key, int& target, int low, int high,
                               std::string_view remedy) const {
    if (const auto value = find(key)) target = static_cast<int>(value->integer(low, high, remedy));
}

void TableReader::read_color(std::string_view key, Color& target) const {
    if (const auto value = find(key)) target = value->color();
}

std::string TableReader::path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void TableReader::fail(std::string_view problem) const {
    source_->fail(table_->source(), path_, problem);
}

void TableReader::refuse_unknown_keys() const {
    const toml::key* first = nullptr;
    for (const auto& [key, node] : *table_) {
        const bool unknown = !is_known(section_, key.str());
        if (unknown && (first == nullptr || stands_before(key, *first))) first = &key;
    }
    if (first != nullptr) fail_unknown_key(*first);
}

void TableReader::fail_unknown_key(const toml::key& key) const {
    const std::string name = printable(key.str());
    const auto known = keys_of(section_);
    const auto nearest = nearest_key(key.str(), known);
    std::string hint = nearest ? fmt::format("; did you mean \"{}\"?", *nearest) : other_home(key.str());
    if (hint.empty()) hint = fmt::format("; valid keys: {}", joined(known));
    source_->fail(key.source(), path_of(name), fmt::format("unknown key \"{}\"{}", name, hint));
}

}  // namespace corda::scene
