#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

#include "console.hpp"
#include "corda/golden/compare.hpp"

namespace corda::app {

/// The command line of `compare`.
struct CompareOptions {
    std::string a;
    std::string b;
    DifferenceLimits limits;
    std::string mask;
    std::string diff;
    bool force = false;
};

/// The figures of a difference; null if the sizes differ.
[[nodiscard]] nlohmann::json figures_json(const Difference& difference);

/// Whether the name is that of a video.
[[nodiscard]] bool is_video_name(const std::string& path);
[[nodiscard]] ExitCode compare_videos(const Console& console, const CompareOptions& options,
                                      const std::optional<Image>& mask);

}  // namespace corda::app
