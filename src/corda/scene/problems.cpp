#include "corda/scene/problems.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"

namespace corda::scene {
namespace {

constexpr std::size_t kMaxShown = 20;
constexpr std::size_t kMaxKept = 10'000;  // bounds the memory for a file that is not a scene at all

/// A string, a number or a boolean; empty for other values.
std::string value_text(const toml::node& node) {
    if (const auto* const text = node.as_string()) return fmt::format("\"{}\"", excerpt(text->get()));
    if (const auto* const number = node.as_integer()) return fmt::format("{}", number->get());
    if (const auto* const number = node.as_floating_point()) return fmt::format("{}", number->get());
    if (const auto* const boolean = node.as_boolean()) return fmt::format("{}", boolean->get());
    return "";
}

toml::source_position begin_of(const toml::source_region& region) {
    return region.begin ? region.begin : toml::source_position{1, 1};
}

}  // namespace

std::string excerpt(std::string_view text, std::size_t longest) {
    std::size_t length = std::min(text.size(), longest);
    while (length < text.size() && length > 0 && is_continuation(text[length])) --length;
    return printable(text.substr(0, length)) + (length < text.size() ? "..." : "");
}

std::string described(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table:
            return "this is a table";
        case toml::node_type::array:
            return fmt::format("this is a list of {}", node.as_array()->size());
        case toml::node_type::string:
            return value_text(node) + " is a string";
        case toml::node_type::integer:
            return value_text(node) + " is an integer";
        case toml::node_type::floating_point:
            return is_whole(node) ? fmt::format("{:.1f} is a number with a point", number_of(node))
                                  : value_text(node) + " is a number with a fraction";
        case toml::node_type::boolean:
            return value_text(node) + " is a boolean";
        default:
            return "this is a date or a time";
    }
}

bool is_whole(const toml::node& node) {
    constexpr double kMost = 1e15;  // "3.0", not "3e20"
    if (!node.is_floating_point()) return false;
    const double value = number_of(node);
    return std::abs(value) < kMost && value == std::trunc(value);
}

double number_of(const toml::node& node) {
    return node.is_integer() ? static_cast<double>(node.as_integer()->get())
                             : node.as_floating_point()->get();
}

std::string Problems::file_key(std::string_view key) const {
    constexpr std::string_view kRope = "rope[";
    std::size_t index = 0;
    if (!key.starts_with(kRope)) return std::string(key);
    const auto [rest, status] = std::from_chars(key.data() + kRope.size(), key.data() + key.size(), index);
    if (status != std::errc{} || index >= file_index_.size()) return std::string(key);
    return fmt::format("{}{}{}", kRope, file_index_[index], std::string_view(rest, key.data() + key.size()));
}

void Problems::add(const toml::source_region& region, std::string_view path, std::string what,
                   std::string remedy, std::string value) {
    const std::string key = file_key(path);
    if (problems_.size() == kMaxKept) {
        ++not_kept_;
        return;
    }
    if (!reported_.emplace(key).second) return;
    for (std::size_t end = 0; end != std::string_view::npos;) {
        end = key.find_first_of(".[", end + 1);
        unsound_.emplace(key.substr(0, end));
    }
    const toml::source_position begin = begin_of(region);
    problems_.push_back({{is_setting(region), begin.line, begin.column},
                         {place_of(region, path), std::move(what), std::move(remedy), std::move(value)}});
}

void Problems::add(const toml::node& value, std::string_view key, std::string what, std::string remedy) {
    add(value.source(), key, std::move(what), std::move(remedy), value_text(value));
}

Place Problems::place_of(const toml::source_region& region, std::string_view path) const {
    if (is_setting(region)) return {.source = *region.path, .key = file_key(path)};
    if (!has_places_) return {.source = source_name_, .key = file_key(path)};
    const toml::source_position begin = begin_of(region);
    return {source_name_, begin.line, begin.column, file_key(path)};
}

void Problems::add_to_setting(Problem problem) {
    problems_.push_back({{true, 0, 0}, std::move(problem)});
}

void Problems::throw_if_any() const {
    if (problems_.empty()) return;
    std::vector<Placed> sorted = problems_;
    std::ranges::stable_sort(sorted, {}, &Placed::order);
    std::vector<Problem> shown;
    for (std::size_t i = 0; i < std::min(sorted.size(), kMaxShown); ++i) shown.push_back(sorted[i].problem);
    const std::size_t count = sorted.size() + not_kept_;
    if (count > kMaxShown) shown.push_back({{}, fmt::format("and {} more", count - kMaxShown), {}});
    throw Error(ExitCode::kInvalidScene, std::move(shown));
}

}  // namespace corda::scene
