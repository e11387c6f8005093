#include "corda/core/removed.hpp"

#include <algorithm>
#include <array>

namespace corda {
namespace {

// Sorted by kind: commands, options, keys.
constexpr std::array kRemoved{
    Removed{"recover", "render a long film as pictures (-o frames/%06d.png), which --resume continues"},
    Removed{"study", "run python3 tests/benchmark/study.py in Corda's sources"},
    Removed{"verify", "render checks each video before it gets its name; ffprobe tells about any video"},
    Removed{"join", "join videos by ffmpeg's demuxer concat"},
    Removed{"sweep", "use python3 -m corda sweep (Debian package python3-corda)"},
    Removed{"report", "use python3 -m corda report (Debian package python3-corda)"},
    Removed{"--verify", "render checks each video before it gets its name"},
    Removed{"--shard", "give each machine a part of the pictures of a sequence (render --frames FIRST:END)"},
    Removed{"--panels", "use several ropes in one scene, or join videos by ffmpeg's filter xstack"},
    Removed{"--flip",
            "use --max, --mean or --share of compare, or golden.max, golden.mean or golden.share of a scene"},
    Removed{"--replan", "name method and camera in the scene, as corda plan --toml prints them, to fix them"},
    Removed{"--ssim",
            "use --max, --mean or --share of compare, or golden.max, golden.mean or golden.share of a scene"},
    Removed{"golden.flip", "use golden.max, golden.mean or golden.share"},
    Removed{"golden.ssim", "use golden.max, golden.mean or golden.share"},
};

}  // namespace

std::span<const Removed> all_removed() {
    return kRemoved;
}

std::string_view replacement_of(std::string_view name) {
    const auto* const found = std::ranges::find(kRemoved, name, &Removed::name);
    return found == kRemoved.end() ? std::string_view{} : found->replacement;
}

}  // namespace corda
