#pragma once

#include <string>
#include <vector>

#include "corda/golden/suite.hpp"

namespace corda::golden {

/// The ending of a reference.
inline constexpr const char* kEnding = ".png";

/// A scene of a suite and its pictures.
struct Case {
    std::string path;
    std::vector<Setting> settings;  ///< those of the suite, and the picture size
    Scene scene;                    ///< with these settings
    std::vector<Checked> pictures;
    std::string frozen;  ///< what its references freeze, in words
};

/// The scenes of a suite; those that are invalid go to `invalid`, but for those of an update. TOML files of
/// folders that are no scenes are told in `passed_over`. Throws corda::Error as run().
[[nodiscard]] std::vector<Case> load_cases(const SuiteDef& def, std::vector<Checked>& invalid,
                                           std::vector<std::string>& passed_over);

/// The pictures of the folder of references, sorted; none if there is no folder. Throws corda::Error (kIo).
[[nodiscard]] std::vector<std::string> references_in(const std::string& folder);

/// Those of `references` that are NAME.png or NAME.CAUSE.png, such as NAME.nvidia.png; `name`: NAME.png.
[[nodiscard]] std::vector<std::string> variants_of(const std::vector<std::string>& references,
                                                   const std::string& name);

/// Whether a picture shows nothing but its ground.
[[nodiscard]] bool has_one_color(const Image& image);

/// True if a file is there that does not begin as a PNG does, such as a pointer of Git LFS or a page of HTML.
[[nodiscard]] bool is_no_png(const std::string& path);

/// True if a readable picture does not tell how `corda golden` made it: a tool may have removed its texts.
[[nodiscard]] bool lacks_record(const std::string& path);

/// References that `corda golden` made and no scene asks for; if scenes are named one by one, of these alone.
/// Made by it are those that say so, and those without a record whose names are SCENE_tSSSS_FFFFFF.png.
[[nodiscard]] std::vector<std::string> stale_ones(const SuiteDef& def, const std::vector<Case>& cases,
                                                  const std::vector<std::string>& references);

}  // namespace corda::golden
