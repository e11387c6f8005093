// The types of the rows of the schema.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"
#include "corda/scene/schema.hpp"

namespace corda::scene {

/// [world], [[rope]], [[net]] and [solver].
[[nodiscard]] std::vector<Key> model_rows();

/// [video], [style], [overlay], [camera] and [golden].
[[nodiscard]] std::vector<Key> picture_rows();

using Words = std::vector<std::string_view>;

inline constexpr Range kAny{};
inline constexpr Range kAbove0{.low = 0.0, .low_open = true};
inline constexpr Range kFrom0{.low = 0.0};
inline constexpr Range kCoordinate{.low = -Limits::kCoordinateMetres, .high = Limits::kCoordinateMetres};
inline constexpr Range kDistance{.low = kMinBarMetres, .high = Limits::kCoordinateMetres};
inline constexpr Range kLength{.low = kMinBarMetres, .high = 4 * Limits::kCoordinateMetres};
inline constexpr Range kMass{.low = 1e-12, .high = 1e12};
inline constexpr Range kValue{.low = -1e12, .high = 1e12};
inline constexpr Range kWidthPx{.low = 0.1, .high = 1000.0};
inline constexpr double kMaxParticles = Limits::kParticles;

inline Type of(Kind kind, const Range& range = kAny) {
    return {.kind = kind, .range = range};
}

inline Type number(const Range& range = kAny) {
    return of(Kind::kNumber, range);
}

inline Type integer(double low, double high) {
    return {.kind = Kind::kInteger, .range = {.low = low, .high = high}};
}

inline Type one_of(Words words, Kind kind = Kind::kChoice) {
    return {.kind = kind, .choices = std::move(words)};
}

inline Type pair(std::string_view words, const Range& range) {
    return {.forms = kPair, .range = range, .pair = words};
}

/// One value, or a pair.
inline Type or_pair(Type type, std::string_view words) {
    type.forms |= kPair;
    type.pair = words;
    return type;
}

/// `type`, or a list of it.
inline Type or_list(Type type, std::string_view words) {
    type.forms |= type.forms == kPair ? kPairs : kList;
    type.list = words;
    return type;
}

inline Type list(Kind kind, std::size_t min) {
    return {.kind = kind, .forms = kList, .list = "a list", .min_entries = min};
}

inline Type pairs(Kind kind, std::string_view words, std::size_t min, const Range& range = kAny) {
    return {.kind = kind, .forms = kPairs, .range = range, .pair = words, .min_entries = min};
}

/// For tables, and keys without a default.
inline Binding none() {
    return {};
}

}  // namespace corda::scene
