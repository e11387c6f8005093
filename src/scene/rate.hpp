#pragma once

#include <toml++/toml.h>

#include <string>
#include <variant>

#include "corda/core/rational.hpp"

namespace corda::scene {

/// Frames per second from a number of up to three decimals, which is exact, or a fraction as text; otherwise
/// what is wrong with it. Numbers that round a broadcast rate or a third, such as 29.97 and 16.667, are
/// refused. The node is a number or text.
[[nodiscard]] std::variant<Rational, std::string> read_rate(const toml::node& node);

}  // namespace corda::scene
