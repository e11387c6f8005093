#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

#include "console.hpp"
#include "corda/golden/compare.hpp"

namespace corda::app {

/// The command line of `compare`.
struct CompareOptions {
    std::string a;
    std::string b;
    std::vector<std::string> variants;
    DifferenceLimits limits;
    std::string mask;
    std::string diff;
    bool force = false;
    bool json = false;  ///< figures that take long are wanted, too
};

/// The figures of a difference; null for those that were not computed.
[[nodiscard]] nlohmann::json figures_json(const Difference& difference);
/// The largest difference: a whole number, but of pictures with 16 bits.
[[nodiscard]] nlohmann::json max_json(const Difference& difference);
[[nodiscard]] nlohmann::json notes_json(const std::vector<std::string>& notes);
/// Which figures the limits ask for.
[[nodiscard]] PerceivedFigures figures_for(const CompareOptions& options);

/// Whether the name is that of a video.
[[nodiscard]] bool is_video_name(const std::string& path);
[[nodiscard]] ExitCode compare_videos(const Console& console, const CompareOptions& options,
                                      const std::optional<Image>& mask);
[[nodiscard]] ExitCode compare_folders(const Console& console, const CompareOptions& options,
                                       const std::optional<Image>& mask);

/// A picture against those that it may be equal to.
struct ComparedPicture {
    Difference difference;
    bool passed = false;
    std::string reference;  ///< the file that the figures are of
    std::string variant;    ///< the cause of the variant that passed; empty: none, or the first reference
    std::string words;
    std::vector<std::string> notes;  ///< on contents of the files that the comparison ignores
};

/// Compares `picture` with `references`: the first that passes counts, or else the first of all. Writes the
/// picture of the difference to `diff`, if that is not empty. `threads` is for each comparison.
[[nodiscard]] ComparedPicture compare_picture(const CompareOptions& options, const std::string& picture,
                                              const std::vector<std::string>& references,
                                              const std::optional<Image>& mask, const std::string& diff,
                                              int threads);

}  // namespace corda::app
