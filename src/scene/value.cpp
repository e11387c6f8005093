#include "corda/scene/value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "corda/scene/nearest_key.hpp"

namespace corda::scene {

bool Value::boolean(std::string_view remedy) const {
    if (!node_->is_boolean()) fail_type("true or false", remedy);
    return node_->as_boolean()->get();
}

double Value::number(const Range& range, std::string_view remedy) const {
    if (!is_number()) fail_type("a number", remedy);
    const double value = node_->is_integer() ? static_cast<double>(node_->as_integer()->get())
                                             : node_->as_floating_point()->get();
    if (!std::isfinite(value)) fail(fmt::format("{} is not a finite number; {}", value, remedy));
    if (range.low_open && value <= range.low) fail_range(value, ">", range.low, remedy);
    if (value < range.low) fail_range(value, ">=", range.low, remedy);
    if (range.high_open && value >= range.high) fail_range(value, "<", range.high, remedy);
    if (value > range.high) fail_range(value, "<=", range.high, remedy);
    return value;
}

std::int64_t Value::integer(std::int64_t low, std::int64_t high, std::string_view remedy) const {
    if (!is_integer()) fail_type("an integer", remedy);
    const std::int64_t value = node_->as_integer()->get();
    if (value < low) fail(fmt::format("{} is not >= {}; {}", value, low, remedy));
    if (value > high) fail(fmt::format("{} is over the limit of {}; {}", value, high, remedy));
    return value;
}

std::string_view Value::text(std::string_view remedy) const {
    if (!is_text()) fail_type("text in quotes", remedy);
    return node_->as_string()->get();
}

Color Value::color() const {
    constexpr std::string_view kRemedy = R"(give a colour such as "#e8c07d" or, with alpha, "#e8c07d80")";
    const std::string_view name = text(kRemedy);
    const auto color = Color::parse(name);
    if (!color) fail(fmt::format("\"{}\" is not a colour; {}", printable(name), kRemedy));
    return *color;
}

std::size_t Value::choice(std::span<const std::string_view> names) const {
    const std::string_view name = text("give one of: " + joined(names));
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    if (const auto nearest = nearest_key(name, names)) {
        fail(fmt::format("\"{}\" is unknown; did you mean \"{}\"?", printable(name), *nearest));
    }
    fail(fmt::format("\"{}\" is unknown; give one of: {}", printable(name), joined(names)));
}

sim::Vec2 Value::pair(const Range& range, std::string_view remedy) const {
    if (!is_list()) fail_type("a pair of numbers", remedy);
    if (size(remedy) != 2) fail(fmt::format("{}, not a pair of numbers; {}", described(*node_), remedy));
    return {at(0).number(range, remedy), at(1).number(range, remedy)};
}

std::size_t Value::size(std::string_view remedy) const {
    if (!is_list()) fail_type("a list", remedy);
    return node_->as_array()->size();
}

Value Value::at(std::size_t i) const {
    assert(is_list() && i < node_->as_array()->size());
    return {*source_, *node_->as_array()->get(i), key_ + '[' + std::to_string(i) + ']'};
}

void Value::fail_type(std::string_view expected, std::string_view remedy) const {
    fail(fmt::format("{}, not {}; {}", described(*node_), expected, remedy));
}

void Value::fail_range(double value, std::string_view relation, double bound, std::string_view remedy) const {
    fail(fmt::format("{} is not {} {}; {}", value, relation, bound, remedy));
}

}  // namespace corda::scene
