#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"
#include "corda/scene/problems.hpp"
#include "corda/scene/schema.hpp"
#include "corda/view/defs.hpp"

namespace corda::scene {

/// Frames per second from a number of up to three decimals, which is exact, or a fraction as text; otherwise
/// the problem with it. Numbers that round a broadcast rate or a third, such as 29.97 and 16.667, are
/// refused. The node is a number or text.
[[nodiscard]] std::variant<Rational, Problem> read_rate(const toml::node& node);

template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;

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
        if constexpr (std::is_same_v<T, Vec2> || std::is_same_v<T, Interval>) {
            return {at(0).as<double>(), at(1).as<double>()};
        } else if constexpr (std::is_same_v<T, Color>) {
            return *Color::parse(as<std::string_view>());
        } else if constexpr (std::is_same_v<T, Ground>) {
            return is_list() ? Ground{at(0).as<Color>(), at(1).as<Color>()}
                             : Ground{as<Color>(), as<Color>()};
        } else if constexpr (std::is_same_v<T, Rational>) {
            return std::get<Rational>(read_rate(*node_));
        } else if constexpr (std::is_same_v<T, FrameRate>) {
            return FrameRate(as<Rational>());
        } else if constexpr (kIsVector<T>) {
            T values;
            for (std::size_t i = 0; i < size(); ++i) values.push_back(at(i).as<typename T::value_type>());
            return values;
        } else if constexpr (std::is_same_v<T, double>) {
            return number_of(*node_);
        } else {
            return *node_->value<T>();
        }
    }

    void add_problem(std::string what, std::string remedy = "") const {
        problems_->add(*node_, path_, std::move(what), std::move(remedy));
    }
    [[nodiscard]] Place place() const { return problems_->place_of(node_->source(), path_); }

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

    [[nodiscard]] const std::string& section() const { return section_; }

    /// The value of a key; empty if the file has no good one.
    [[nodiscard]] std::optional<Value> find(std::string_view key) const;
    [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }

    [[nodiscard]] bool is_sound(std::string_view key) const { return problems_->is_sound(path_of(key)); }

    /// Whether the file has a key, be it bad or misspelt.
    [[nodiscard]] bool is_given(std::string_view key) const { return has(key) || !is_sound(key); }

    /// The table of that key, empty if the file has no good one.
    [[nodiscard]] TableReader table(std::string_view key) const;

    /// The tables of a list.
    [[nodiscard]] std::vector<TableReader> tables(std::string_view key) const;

    /// Stores the value of a key in `target`, if the file has a good one. `T` is that of the key's kind.
    template <class T>
    void read(std::string_view key, T& target) const {
        if (const auto value = find(key)) target = value->as<T>();
    }

    [[nodiscard]] Problems& problems() const { return *problems_; }
    void add_problem(std::string what, std::string remedy) const {
        problems_->add(table_->source(), path_, std::move(what), std::move(remedy));
    }
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
