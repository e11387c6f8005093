#include "corda/core/removed.hpp"

#include <algorithm>
#include <array>

namespace corda {
namespace {

struct Removed {
    std::string_view name;
    std::string_view replacement;
};

// Sorted by kind: commands, options, keys.
constexpr std::array kRemoved{
    Removed{"recover", "render a long film as pictures (-o frames/%06d.png), which --resume continues"},
    Removed{"--panels", "use several ropes in one scene, or join videos by ffmpeg's filter xstack"},
};

}  // namespace

std::string_view replacement_of(std::string_view name) {
    const auto* const found = std::ranges::find(kRemoved, name, &Removed::name);
    return found == kRemoved.end() ? std::string_view{} : found->replacement;
}

}  // namespace corda
