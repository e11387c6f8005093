#pragma once

#include <string>
#include <vector>

#include "corda/golden/compare.hpp"
#include "corda/pipeline/film.hpp"

namespace corda::suite {

/// Scenes with a table [golden], and the pictures that are kept of them.
struct SuiteDef {
    /// Scene files, and folders whose .toml files with a table [golden] count.
    std::vector<std::string> paths;
    std::vector<Setting> settings;  ///< of all scenes
    std::string folder;             ///< of the references
    bool update = false;            ///< replace references that differ, add missing ones, remove stale ones
    bool dry_run = false;           ///< with `update`: change nothing
    FilmDef film;
    OnProgress on_progress;  ///< called with the pictures done, by one thread at a time; false stops
};

enum class Verdict { kPassed, kDifferent, kMissing, kEmpty, kStale };

/// One picture of a suite.
struct Checked {
    std::string scene;
    std::string name;  ///< of its file in the folder of references
    double time_s = 0.0;
    Verdict verdict = Verdict::kPassed;
    Difference difference{};
    std::string variant{};  ///< the file that it was compared with last, NAME.png or NAME.CAUSE.png
    std::string cause{};    ///< why it differs, in words
    bool changed = false;   ///< written or removed by an update, or to be
};

struct SuiteResult {
    std::vector<Checked> pictures;    ///< scene by scene in order of time; stale ones last
    std::vector<std::string> frozen;  ///< per scene whose solver or camera its references fix: in words

    [[nodiscard]] std::int64_t count(Verdict verdict) const;
};

/// Draws all pictures of a suite, several scenes at a time, and compares them with their references. Throws
/// corda::Error: kUsage if there is no scene with a table [golden] or two pictures have one name, what
/// load_scene() and Film throw, kIo.
[[nodiscard]] SuiteResult run(const SuiteDef& def);

/// As JUnit's XML: a test suite per scene, a test case per picture.
[[nodiscard]] std::string junit_xml(const SuiteResult& result);

}  // namespace corda::suite
