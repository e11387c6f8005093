#pragma once

#include <toml++/toml.h>

#include <string>
#include <variant>

#include "corda/core/rational.hpp"

namespace corda::scene {

/// Frames per second from an integer, or a fraction as text; otherwise what is wrong with it. The node is a
/// number or text.
[[nodiscard]] std::variant<Rational, std::string> read_rate(const toml::node& node);

}  // namespace corda::scene
