#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/golden/compare.hpp"
#include "corda/pipeline/film.hpp"

namespace corda::golden {

/// Scenes with a table [golden], and the pictures that are kept of them.
struct SuiteDef {
    /// Scene files, and folders: their .toml files with a table [golden] count, and those of folders in them.
    std::vector<std::string> paths;
    std::vector<Setting> settings;  ///< of all scenes
    std::string folder;             ///< of the references
    bool update = false;            ///< replace references that differ, add missing ones, remove stale ones
    bool force =
        false;  ///< with `update`: also replace files that are no PNG, and remove stale ones without a record
    bool replan = false;   ///< with `update`: choose solver and camera of all scenes again
    bool dry_run = false;  ///< with `update`: change nothing
    int most_drawn = 0;    ///< largest number of failed pictures that are kept for a page
    FilmDef film;
    OnProgress on_progress;  ///< called with the pictures done, by one thread at a time; false stops
};

enum class Verdict { kPassed, kDifferent, kMissing, kEmpty, kStale, kInvalid };

/// One picture of a suite, or a scene file that is invalid.
struct Checked {
    std::string scene;
    std::string name;  ///< of its file in the folder of references; of a scene, its path
    double time_s = 0.0;
    Verdict verdict = Verdict::kPassed;
    Difference difference{};
    std::string variant{};         ///< the file that it was compared with last, NAME.png or NAME.CAUSE.png
    std::string cause{};           ///< why it failed, in words
    std::string change{};          ///< what its scene says that the kept one's did not
    bool changed = false;          ///< written or removed by an update, or to be: then it is no failure
    bool has_no_record = false;    ///< stale by its name alone: removed with SuiteDef::force alone
    std::optional<Image> drawn{};  ///< if it failed, see SuiteDef::most_drawn

    [[nodiscard]] bool failed() const { return verdict != Verdict::kPassed && !changed; }
};

struct SuiteResult {
    std::vector<Checked> pictures;     ///< scene by scene in order of time; stale ones, invalid scenes last
    std::vector<std::string> frozen;   ///< per scene whose solver or camera its references fix: in words
    std::vector<std::string> details;  ///< files that were passed over, in words
    std::vector<std::string> notes;    ///< what the user must know besides: sentences

    /// The pictures of a verdict, without those that an update has put right.
    [[nodiscard]] std::int64_t count(Verdict verdict) const;
};

/// Draws all pictures of a suite, one per core at a time, as frames of a video: exposed as video.shutter
/// says. Compares them with their references. An update is written when all is drawn. Beside an invalid
/// scene the others are checked, but nothing is updated or stale. Throws corda::Error: kUsage if
/// there is no scene with a table [golden] or two pictures have one name, what load_scene() and Film throw,
/// kIo.
[[nodiscard]] SuiteResult run(const SuiteDef& def);

/// As JUnit's XML: a test suite per scene, a test case per picture.
[[nodiscard]] std::string junit_xml(const SuiteResult& result);

/// One page of HTML that needs no other file: per failed picture the reference, what was drawn and sixteen
/// times their difference, beside each other, blinking, or under a slider. `folder`: of the references.
[[nodiscard]] std::string page_html(const SuiteResult& result, const std::string& folder);

}  // namespace corda::golden
