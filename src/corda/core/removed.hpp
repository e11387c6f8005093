#pragma once

#include <string_view>

namespace corda {

/// What to use in place of a command ("recover"), an option ("--panels") or a scene key ("golden.flip") that
/// was removed: a sentence without a full stop. Empty if there never was one of that name.
[[nodiscard]] std::string_view replacement_of(std::string_view name);

}  // namespace corda
