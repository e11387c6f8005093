#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/film/provenance.hpp"
#include "corda/golden/suite.hpp"

namespace corda::golden {

/// The ending of a reference.
inline constexpr const char* kEnding = ".png";

/// A scene of a suite and its pictures.
struct Case {
    std::string path;
    Scene scene;  ///< with the settings of the suite
    std::vector<Checked> pictures;
    std::optional<Image> mask;

    /// The scene in the size of its golden pictures.
    [[nodiscard]] Scene drawn() const;
};

/// The files of a suite.
struct Suite {
    std::vector<Case> cases;
    std::vector<Checked> invalid;          ///< scenes that cannot be read
    std::vector<std::string> passed_over;  ///< TOML files of folders that are no scenes
    std::vector<std::string> references;   ///< all pictures of the folder, sorted
    std::vector<std::string> stale;        ///< those that no scene asks for; none beside invalid scenes
};

/// Finds all files of a suite, for accept() without its references. Throws corda::Error as run(); for an
/// invalid scene, too, if references are to be changed.
[[nodiscard]] Suite load_suite(const SuiteDef& def);

/// Leaves the pictures out that the suite does not ask for: those of cases stay, unselected. Throws
/// corda::Error (kUsage) for a name of SuiteDef::only that is none.
void select(const SuiteDef& def, Suite& suite);

/// Reports the files that were passed over: as a note if pictures are stale for it, else as a detail.
void report_skipped_files(const Suite& suite, SuiteResult& result);

/// The bytes of pictures by their names.
using Files = std::map<std::string, std::string>;

/// Writes pictures to a folder, each as a whole, and removes others by their paths. A signal lets this be
/// completed. Throws corda::Error (kIo).
void publish(const std::string& folder, const Files& files, const std::vector<std::string>& removed);

/// Writes the failed pictures of a run to SuiteDef::new_folder, with what accept() must know of each in its
/// file golden.json, and removes those of an earlier run. Without any no folder is made. Throws corda::Error:
/// kIo; kUsage for a golden.json of another kind.
void write_new(const SuiteDef& def, const std::vector<Case>& cases, const Files& files);

/// The provenance of a picture; none if it cannot be read.
[[nodiscard]] std::optional<Provenance> provenance_of_file(const std::string& path);

/// The pictures of the folder of references, sorted; none if there is no folder. Throws corda::Error (kIo).
[[nodiscard]] std::vector<std::string> references_in(const std::string& folder);

/// Those of `references` that are NAME.png or NAME.CAUSE.png, such as NAME.nvidia.png; `name`: NAME.png.
[[nodiscard]] std::vector<std::string> variants_of(const std::vector<std::string>& references,
                                                   const std::string& name);

/// Whether a picture shows nothing but its ground.
[[nodiscard]] bool has_one_color(const Image& image);

/// The first `most` names, and "..." for others.
[[nodiscard]] std::string listed(std::vector<std::string> names, std::size_t most);

/// True if a file is there that does not begin as a PNG does, such as a pointer of Git LFS or a page of HTML.
[[nodiscard]] bool is_no_png(const std::string& path);

/// True if a readable picture does not tell how `corda golden` made it: a tool may have removed its texts.
[[nodiscard]] bool lacks_record(const std::string& path);

}  // namespace corda::golden
