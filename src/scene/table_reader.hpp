#pragma once

#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "corda/core/image.hpp"
#include "corda/scene/keys.hpp"
#include "corda/scene/problems.hpp"
#include "corda/sim/defs.hpp"

namespace corda::scene {

/// One value of a document that `check_document` has checked. The document and the problems must outlive it.
class Value {
  public:
    Value(Problems& problems, const toml::node& node, std::string path)
        : problems_(&problems), node_(&node), path_(std::move(path)) {}

    [[nodiscard]] const toml::node& node() const { return *node_; }
    [[nodiscard]] bool is_list() const { return node_->is_array(); }

    /// Length of a list.
    [[nodiscard]] std::size_t size() const { return node_->as_array()->size(); }

    /// Entry `i` of a list. Requires `i < size()`.
    [[nodiscard]] Value at(std::size_t i) const {
        return {*problems_, *node_->as_array()->get(i), path_ + '[' + std::to_string(i) + ']'};
    }

    /// The value as a `T`. Requires a key of that type.
    template <class T>
    [[nodiscard]] T as() const {
        if constexpr (std::is_same_v<T, Vec2>) {
            return {at(0).as<double>(), at(1).as<double>()};
        } else if constexpr (std::is_same_v<T, Color>) {
            return *Color::parse(as<std::string_view>());
        } else if constexpr (std::is_same_v<T, double>) {
            return number_of(*node_);
        } else {
            return *node_->value<T>();
        }
    }

    void add_problem(std::string_view problem) const { problems_->add(node_->source(), path_, problem); }

  private:
    Problems* problems_;
    const toml::node* node_;
    std::string path_;
};

/// One table of a document that `check_document` has checked, read key by key. The document and the problems
/// must outlive it.
class TableReader {
  public:
    /// `path` is the table's dotted key in messages: section "rope", path "rope[0]".
    TableReader(Problems& problems, const toml::table& table, std::string section, std::string path)
        : problems_(&problems), table_(&table), section_(std::move(section)), path_(std::move(path)) {}

    /// The value of a key; empty if the file has no good one.
    [[nodiscard]] std::optional<Value> find(std::string_view key) const;
    [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }

    /// Whether there is no problem with a key.
    [[nodiscard]] bool is_sound(std::string_view key) const { return problems_->is_sound(path_of(key)); }

    /// Whether the file has a key, be it bad or misspelt.
    [[nodiscard]] bool is_given(std::string_view key) const { return has(key) || !is_sound(key); }

    /// The table of that key, empty if the file has no good one.
    [[nodiscard]] TableReader table(std::string_view key) const;

    /// The tables of a list.
    [[nodiscard]] std::vector<TableReader> tables(std::string_view key) const;

    /// Puts the value of a key into `target`, if the file has a good one. `T` is as the key's kind; for a
    /// choice text or an enum in the order of the choices.
    template <class T>
    void read(std::string_view key, T& target) const {
        const auto value = find(key);
        if (!value) return;
        if constexpr (std::is_enum_v<T>) {
            const auto& choices = find_key(section_, key)->type.choices;
            const auto found = std::find(choices.begin(), choices.end(), value->as<std::string_view>());
            target = static_cast<T>(found - choices.begin());
        } else {
            target = value->as<T>();
        }
    }
    template <class T>
    void read(std::string_view key, std::optional<T>& target) const {
        if (find(key)) read(key, target.emplace());
    }

    [[nodiscard]] Problems& problems() const { return *problems_; }
    void add_problem(std::string_view problem) const { problems_->add(table_->source(), path_, problem); }
    /// A problem at a key that is missing.
    void add_missing(std::string_view key) const;

  private:
    [[nodiscard]] std::string path_of(std::string_view key) const;

    Problems* problems_;
    const toml::table* table_;
    std::string section_;
    std::string path_;
};

}  // namespace corda::scene
