#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "corda/core/color.hpp"
#include "corda/scene/scene.hpp"
#include "corda/scene/source.hpp"
#include "corda/sim/vec2.hpp"

namespace corda::scene {

/// The numbers that a key allows, with the words for one that it does not.
struct Range {
    double low = std::numeric_limits<double>::lowest();
    double high = std::numeric_limits<double>::max();
    bool low_open = false;   ///< `low` itself is not allowed
    bool high_open = false;  ///< `high` itself is not allowed
};

inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{.low = 0.0, .low_open = true};
inline constexpr Range kNotNegative{.low = 0.0};
inline constexpr Range kCoordinate{.low = -Limits::kCoordinateMetres, .high = Limits::kCoordinateMetres};
inline constexpr Range kWidthPx{.low = 0.1, .high = 1000.0};

/// One value of a scene file with its dotted key. Every reader takes a `remedy`, "give a mass in kg", that
/// ends its message, and throws kInvalidScene for a value of another type or out of range. NaN and infinities
/// are never in range. The document must outlive it.
class Value {
  public:
    Value(const Source& source, const toml::node& node, std::string key)
        : source_(&source), node_(&node), key_(std::move(key)) {}

    [[nodiscard]] const std::string& key() const { return key_; }
    [[nodiscard]] bool is_list() const { return node_->is_array(); }
    [[nodiscard]] bool is_number() const { return node_->is_number(); }
    [[nodiscard]] bool is_integer() const { return node_->is_integer(); }
    [[nodiscard]] bool is_text() const { return node_->is_string(); }

    [[nodiscard]] bool boolean(std::string_view remedy) const;
    [[nodiscard]] double number(const Range& range, std::string_view remedy) const;
    [[nodiscard]] std::int64_t integer(std::int64_t low, std::int64_t high, std::string_view remedy) const;
    [[nodiscard]] std::string_view text(std::string_view remedy) const;
    [[nodiscard]] Color color() const;

    /// Index of the text in `names`; refuses one that is not there with the nearest of them, or all.
    [[nodiscard]] std::size_t choice(std::span<const std::string_view> names) const;

    /// Two numbers [x, y].
    [[nodiscard]] sim::Vec2 pair(const Range& range, std::string_view remedy) const;

    /// Length of a list.
    [[nodiscard]] std::size_t size(std::string_view remedy) const;

    /// Element `i` of a list. Requires `i < size()`.
    [[nodiscard]] Value at(std::size_t i) const;

    /// Throws kInvalidScene with the place and the key of this value before `problem`.
    [[noreturn]] void fail(std::string_view problem) const { source_->fail(node_->source(), key_, problem); }

  private:
    [[noreturn]] void fail_type(std::string_view expected, std::string_view remedy) const;
    [[noreturn]] void fail_range(double value, std::string_view relation, double bound,
                                 std::string_view remedy) const;

    const Source* source_;
    const toml::node* node_;
    std::string key_;
};

}  // namespace corda::scene
