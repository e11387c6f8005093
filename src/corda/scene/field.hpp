#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "corda/scene/schema.hpp"
#include "corda/scene/table_reader.hpp"
#include "corda/view/defs.hpp"

namespace corda::scene {

// Values as a scene file gives them. Numbers have as many digits as it takes to read the same bits.

/// A template, since pointers convert to bool.
template <class T>
requires std::is_integral_v<T>
[[nodiscard]] std::string toml_text(T value) {
    if constexpr (std::is_same_v<T, bool>) return value ? "true" : "false";
    return std::to_string(value);
}
[[nodiscard]] std::string toml_text(double value);
[[nodiscard]] std::string toml_text(std::string_view value);
[[nodiscard]] std::string toml_text(Vec2 value);
[[nodiscard]] std::string toml_text(Color value);
[[nodiscard]] std::string toml_text(const Ground& value);
[[nodiscard]] std::string toml_text(const Interval& value);
[[nodiscard]] std::string toml_text(const Rational& value);
[[nodiscard]] std::string toml_text(const FrameRate& value);
[[nodiscard]] std::string toml_text(const NetBar& value);
[[nodiscard]] std::string toml_text(const WaveDef& value);
[[nodiscard]] std::string toml_text(const PathKeyDef& value);
[[nodiscard]] std::string toml_text(const MoveDef& value);
[[nodiscard]] std::string toml_text(const ReleaseDef& value);
[[nodiscard]] std::string toml_text(const CutDef& value);

template <class T>
[[nodiscard]] std::string toml_text(const std::vector<T>& values) {
    std::string text = "[";
    for (const T& value : values) {
        if (text.size() > 1) text += ", ";
        text += toml_text(value);
    }
    return text + "]";
}

/// One value if all are the same, otherwise a list; empty if there are none.
template <class T>
[[nodiscard]] std::string toml_of_all(const std::vector<T>& values) {
    if (values.empty()) return "";
    std::string first = toml_text(values.front());
    for (const T& value : values)
        if (toml_text(value) != first) return toml_text(values);
    return first;
}

/// The value of a member; empty if it is left open.
template <class T>
[[nodiscard]] std::string toml_of(const Key& key, const T& value) {
    if constexpr (std::is_enum_v<T>) {
        const auto index = static_cast<std::size_t>(value);
        return toml_text(index < key.type.choices.size() ? key.type.choices[index] : "?");
    } else {
        return toml_text(value);
    }
}
[[nodiscard]] inline std::string toml_of(const Key& key, const std::string& value) {
    return value.empty() && !key.binding.initial.words.empty() ? "" : toml_text(value);
}
template <class T>
[[nodiscard]] std::string toml_of(const Key& key, const std::optional<T>& value) {
    return value ? toml_of(key, *value) : "";
}
template <class T>
[[nodiscard]] std::string toml_of(const Key& key, const std::vector<T>& values) {
    if constexpr (std::is_enum_v<T>) {
        std::string text;
        for (const T& value : values) text += (text.empty() ? "" : ", ") + toml_of(key, value);
        return "[" + text + "]";
    } else
        return values.empty() && !key.binding.initial.words.empty() ? "" : toml_text(values);
}

/// Stores a checked value in a member.
template <class T>
void read_value(const Key& key, const Value& value, T& target) {
    if constexpr (std::is_enum_v<T>) {
        std::size_t index = 0;
        while (key.type.choices[index] != value.as<std::string_view>()) ++index;
        target = static_cast<T>(index);
    } else if constexpr (kIsVector<T>) {
        target.resize(value.size());
        for (std::size_t i = 0; i < target.size(); ++i) read_value(key, value.at(i), target[i]);
    } else {
        target = value.as<T>();
    }
}
template <class T>
void read_value(const Key& key, const Value& value, std::optional<T>& target) {
    read_value(key, value, target.emplace());
}

/// A field with functions of its own: `read(value, def)` and `toml(def)`.
template <class Def, class Read, class Toml>
[[nodiscard]] Binding custom_field(Read read, Toml toml) {
    return {{{typeid(Def),
              [read](const Key&, const Value& value, void* def) { read(value, *static_cast<Def*>(def)); },
              [toml](const Key&, const void* def) { return toml(*static_cast<const Def*>(def)); },
              [toml](const Key&) { return toml(Def{}); }}},
            {}};
}

/// A field that the readers of bodies fill in: it is only written, by `toml(def)`.
template <class Def, class Toml>
[[nodiscard]] Binding body_field(Toml toml) {
    Binding binding = custom_field<Def>([](const Value&, Def&) {}, toml);
    binding.fields.front().read = nullptr;
    return binding;
}

/// The member that `get` returns a reference to.
template <class Def, class Get>
[[nodiscard]] Binding field_at(Get get) {
    return {
        {{typeid(Def),
          [get](const Key& key, const Value& value, void* def) {
              read_value(key, value, get(*static_cast<Def*>(def)));
          },
          [get](const Key& key, const void* def) { return toml_of(key, get(*static_cast<const Def*>(def))); },
          [get](const Key& key) {
              const Def def{};
              return toml_of(key, get(def));
          }}},
        {}};
}

template <class Def, class T>
[[nodiscard]] Binding field(T Def::*member) {
    return field_at<Def>([member](auto& def) -> auto& { return def.*member; });
}

/// `binding` with a default that depends on something else.
[[nodiscard]] inline Binding otherwise(std::string_view words, Binding binding = {}) {
    binding.initial.words = words;
    return binding;
}

/// `binding` with the default `toml`.
[[nodiscard]] inline Binding with_default(std::string toml, Binding binding) {
    binding.initial.toml = std::move(toml);
    return binding;
}

/// `binding` without a default.
[[nodiscard]] inline Binding required(Binding binding = {}) {
    binding.initial.required = true;
    return binding;
}

/// One of several fields of a key.
[[nodiscard]] inline Binding either(Binding binding, const Binding& other) {
    binding.fields.insert(binding.fields.end(), other.fields.begin(), other.fields.end());
    return binding;
}

/// Reads the keys of a table that are bound to `Def`. Keys with a problem keep their defaults.
template <class Def>
void read_fields(const TableReader& table, Def& def) {
    for (const Key& key : keys_of(table.section())) {
        if (!table.has(key.name) || !table.is_sound(key.name)) continue;
        for (const Field& one : key.binding.fields)
            if (one.read && one.def == typeid(Def)) one.read(key, *table.find(key.name), &def);
    }
}

}  // namespace corda::scene
