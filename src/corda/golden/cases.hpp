#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/golden/suite.hpp"
#include "corda/film/provenance.hpp"

namespace corda::golden {

/// The ending of a reference.
inline constexpr const char* kEnding = ".png";

/// A scene of a suite and its pictures.
struct Case {
    std::string path;
    std::vector<Setting> settings;  ///< those of the suite, and the picture size
    Scene scene;                    ///< with these settings
    std::vector<Checked> pictures;
    std::optional<Image> mask;
};

/// The scenes of a suite. Invalid ones go to `invalid`, except those of an update. TOML files of folders that
/// are no scenes go to `passed_over`. Throws corda::Error as run().
[[nodiscard]] std::vector<Case> load_cases(const SuiteDef& def, std::vector<Checked>& invalid,
                                           std::vector<std::string>& passed_over);

/// Reports the files that were passed over: as a note if pictures are stale for it, else as a detail.
void report_skipped_files(const std::vector<std::string>& files, const std::vector<std::string>& stale,
                          SuiteResult& result);

/// Leaves the pictures out that the suite does not ask for: those of `cases` stay, unselected. Throws
/// corda::Error (kUsage) for a name of SuiteDef::only that is none.
void select(const SuiteDef& def, std::vector<Case>& cases, std::vector<std::string>& stale,
            std::vector<Checked>& invalid);

/// The bytes of pictures by their names.
using Files = std::map<std::string, std::string>;

/// Writes pictures to a folder, each as a whole, and removes others by their paths. A signal lets this be
/// completed. Throws corda::Error (kIo).
void publish(const std::string& folder, const Files& files, const std::vector<std::string>& removed);

/// Writes the failed pictures of a run to SuiteDef::new_folder, with what accept() must know of each in its
/// file golden.json, and removes those of an earlier run. Without any no folder is made. Throws corda::Error:
/// kIo; kUsage for a golden.json of another kind.
void write_new(const SuiteDef& def, const std::vector<Case>& cases, const Files& files);

/// The provenance of a golden picture; empty if it cannot be read.
[[nodiscard]] Provenance provenance_of_file(const std::string& path);

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
