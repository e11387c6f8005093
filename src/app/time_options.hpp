#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/scene/scene.hpp"

namespace corda::app {

/// Frames FIRST <= k < END of a video; without an end, up to its last.
struct FrameRange {
    std::int64_t first = 0;
    std::optional<std::int64_t> end;
};

/// Reads "FIRST:END", either of which may be left out; std::nullopt for any other text.
[[nodiscard]] std::optional<FrameRange> parse_frame_range(std::string_view text);

/// A moment of the motion that is to be drawn.
struct RequestedTime {
    double time_s = 0.0;
    std::optional<std::int64_t> frame;  ///< if it was asked for by its number
};

/// Which moments are drawn: `--at` or `--frame`.
struct TimeOptions {
    std::vector<double> times_s;
    std::vector<std::string> frames;

    void add_to(CLI::App& command);
    /// Throws CLI::RequiredError if neither option was given.
    void require() const;
    /// In the order of time. Throws corda::Error (kUsage) for a moment that the scene does not have.
    [[nodiscard]] std::vector<RequestedTime> list(const Scene& scene) const;
};

}  // namespace corda::app
