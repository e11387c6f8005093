#include "corda/scene/table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

namespace corda::scene {
namespace {

/// The fraction that someone who rounded a number such as 29.97 or 16.667 means.
std::optional<Rational> rounded_fraction(double fps) {
    constexpr std::array<std::int64_t, 7> kBroadcastRates{12, 15, 24, 30, 48, 60, 120};
    for (const std::int64_t rate : kBroadcastRates) {
        const Rational fraction{rate * 1000, 1001};
        for (const double digits : {1e2, 1e3, 1e4, 1e5, 1e6})  // 23.98, 23.976 ...
            if (std::round(fraction.value() * digits) / digits == fps) return fraction;
    }
    constexpr double kThird = 1.5e-3;  // of 0.333 and 16.667
    const double thirds = std::round(3.0 * fps);
    const bool is_third = thirds >= 1.0 && std::fmod(thirds, 3.0) != 0.0;
    if (is_third && std::abs(3.0 * fps - thirds) <= kThird * std::min(1.0, thirds))
        return Rational{static_cast<std::int64_t>(thirds), 3};
    return std::nullopt;
}

/// The fraction of few digits that a number with many is, such as 0.142857142857.
std::optional<Rational> nearest_fraction(double fps) {
    constexpr std::int64_t kMaxDenominator = 1001;  // of 30000/1001
    for (std::int64_t den = 2; den <= kMaxDenominator; ++den) {
        const double num = std::round(fps * static_cast<double>(den));
        if (std::abs(fps * static_cast<double>(den) - num) < 1e-9 * num) {
            return Rational::reduced(static_cast<std::int64_t>(num), den);
        }
    }
    return std::nullopt;
}

std::variant<Rational, Problem> rate_from_number(double fps) {
    if (!std::isfinite(fps)) return Problem{{}, fmt::format("{} is not a finite number", fps), {}};
    if (std::abs(fps) > static_cast<double>(Rational::kMaxPart) / 1000.0)
        return Problem{{}, fmt::format("{} is out of range", fps), {}};
    if (fps == std::floor(fps)) return Rational{static_cast<std::int64_t>(fps), 1};
    const auto inexact = [fps](const std::optional<Rational>& meant) {
        return Problem{
            {}, fmt::format("{} is not exact", fps), meant ? fmt::format("write \"{}\"", meant->text()) : ""};
    };
    if (const auto meant = rounded_fraction(fps)) return inexact(meant);
    // A decimal of up to three digits is a number of thousandths.
    const double thousandths = std::round(1000.0 * fps);
    if (thousandths / 1000.0 == fps) return Rational::reduced(static_cast<std::int64_t>(thousandths), 1000);
    return inexact(nearest_fraction(fps));
}

/// A number in decimal digits; std::nullopt for any other text.
std::optional<double> decimal(std::string_view text) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [stop, status] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
    const bool is_number = status == std::errc{} && stop == end && std::isfinite(value);
    return is_number ? std::optional(value) : std::nullopt;
}

}  // namespace

std::variant<Rational, Problem> read_rate(const toml::node& node) {
    if (node.is_number()) return rate_from_number(number_of(node));
    const std::string& text = node.as_string()->get();
    if (const auto rate = Rational::parse(text)) return *rate;
    if (const auto fps = decimal(text); fps && *fps > 0.0) return rate_from_number(*fps);
    return Problem{{}, fmt::format("\"{}\" is not a fraction", excerpt(text)), {}};
}

std::optional<Value> TableReader::find(std::string_view key) const {
    assert(find_key(section_, key) != nullptr);
    const toml::node* const node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    return Value(*problems_, *node, path_of(key));
}

TableReader TableReader::table(std::string_view key) const {
    static const toml::table empty;
    const toml::node* const node = table_->get(key);
    return {*problems_, node == nullptr ? empty : *node->as_table(), dotted(section_, key), path_of(key)};
}

std::vector<TableReader> TableReader::tables(std::string_view key) const {
    std::vector<TableReader> readers;
    const toml::array* const list = (*table_)[key].as_array();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        if (const toml::table* const table = list->get(i)->as_table())
            readers.emplace_back(*problems_, *table, dotted(section_, key),
                                 fmt::format("{}[{}]", path_of(key), i));
    }
    return readers;
}

void TableReader::add_missing(std::string_view key) const {
    if (is_sound(key))
        problems_->add(table_->source(), path_of(key), "missing", remedy(*find_key(section_, key)));
}

std::string TableReader::path_of(std::string_view key) const {
    return dotted(path_, key);
}

}  // namespace corda::scene
