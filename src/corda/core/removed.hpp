#pragma once

#include <span>
#include <string_view>

namespace corda {

struct Removed {
    std::string_view name;
    std::string_view replacement;
};

/// Commands ("recover"), options ("--panels") and scene keys ("golden.flip") that were removed.
[[nodiscard]] std::span<const Removed> all_removed();

/// What to use in place of a command ("recover"), an option ("--panels") or a scene key ("golden.flip") that
/// was removed: a sentence without a full stop. Empty if there never was one of that name.
[[nodiscard]] std::string_view replacement_of(std::string_view name);

}  // namespace corda
