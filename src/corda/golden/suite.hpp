#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

#include "corda/golden/compare.hpp"
#include "corda/golden/record.hpp"

namespace corda::golden {

/// Scenes with a table [golden], and the pictures that are kept of them.
struct SuiteDef {
    /// Scene files, and folders: their .toml files with a table [golden] count, and those of folders in them.
    std::vector<std::string> paths;
    std::vector<Setting> settings;  ///< of all scenes
    std::string folder;             ///< of the references
    /// Names of pictures, with or without .png, and of scenes; * stands for any text. Empty: all.
    std::vector<std::string> only;
    Shard shard;              ///< every N-th scene and stale picture
    bool stale_only = false;  ///< draw nothing; look for stale pictures
    bool update = false;      ///< replace references that differ, add missing ones, remove stale ones
    bool force =
        false;  ///< with `update`: also replace files that are no PNG, and remove stale ones without a record
    bool dry_run = false;  ///< with `update` and in accept(): change nothing
    /// Where failed pictures are written for accept(), as an update would.
    /// Empty: nowhere. One with earlier pictures is emptied of them.
    std::string new_folder;
    std::vector<std::string> accepted;  ///< folders of earlier runs, see accept()
    int most_drawn = 0;                 ///< largest number of failed pictures that are kept for a page
    FilmDef film;
    OnProgress on_progress;  ///< called with the pictures done, by one thread at a time; false stops
};

enum class Verdict { kPassed, kDifferent, kMissing, kEmpty, kStale, kInvalid };

/// "passed", "different" and so on.
[[nodiscard]] const char* word_of(Verdict verdict);

/// One picture of a suite, or a scene file that is invalid: what all reports tell.
struct Checked {
    std::string scene;
    std::string name;  ///< of its file in the folder of references; of a scene, its path
    double time_s = 0.0;
    bool is_empty = false;                   ///< nothing is in view
    std::optional<Difference> difference{};  ///< from a reference of the same size
    std::string reference{};                 ///< path that it was compared with last; empty: none
    std::string drawn_path{};                ///< in SuiteDef::new_folder; empty: it was not written
    Cause cause{};                           ///< of the difference from the reference
    double seconds = 0.0;                    ///< that drawing and comparing took
    bool changed = false;          ///< written or removed by an update, or to be: then it is no failure
    bool selected = true;          ///< see SuiteDef::only; others are not in a result
    std::optional<Image> drawn{};  ///< if it failed, see SuiteDef::most_drawn

    /// That of the cause, or kEmpty.
    [[nodiscard]] Verdict verdict() const;
    [[nodiscard]] bool failed() const { return verdict() != Verdict::kPassed && !changed; }
};

struct SuiteResult {
    std::vector<Checked> pictures = {};  ///< scene by scene in order of time; stale ones, invalid scenes last
    std::vector<std::string> details = {};  ///< files that were passed over, in words
    std::vector<std::string> notes = {};    ///< what the user must know besides: sentences
    bool may_change = false;                ///< of an update or accept()
    bool dry_run = false;

    /// The pictures of a verdict, without those that an update has put right.
    [[nodiscard]] std::int64_t count(Verdict verdict) const;
    [[nodiscard]] std::int64_t changed() const;
    /// "61 pictures: 43 passed, 13 failed, 3 missing, 2 stale": each picture once.
    [[nodiscard]] std::string totals() const;
};

/// Draws all pictures of a suite, one per core at a time, as frames of a video: exposed as video.shutter
/// says. Compares them with their references. An update is written when all is drawn. Beside an invalid
/// scene the others are checked, but nothing is updated or stale. Throws corda::Error: kUsage if
/// there is no scene with a table [golden] or two pictures have one name, what load_scene() and Film throw,
/// kIo.
[[nodiscard]] SuiteResult run(const SuiteDef& def);

/// Puts the pictures of SuiteDef::accepted, which earlier runs wrote to their SuiteDef::new_folder, in the
/// place of their references, as an update does: each as a whole; a repeated call completes one that was
/// killed. Draws nothing. Pictures that were removed from their folder are passed over. Throws corda::Error
/// as run(), and kUsage, before anything is written, if a picture belongs to another suite, scene or
/// reference.
[[nodiscard]] SuiteResult accept(const SuiteDef& def);

/// "max 3, mean 0.1, share 0.02"; empty if a picture has no figures.
[[nodiscard]] std::string figures_text(const Checked& picture);

/// The cause of a failure in words.
struct CauseText {
    std::string group;    ///< the same for all pictures that fail for this reason, whatever the figures
    std::string own;      ///< what it says of this picture beyond that
    std::string whole{};  ///< empty if the verdict says it all

    [[nodiscard]] const std::string& whole_or_group() const { return whole.empty() ? group : whole; }
};
[[nodiscard]] CauseText cause_text(const Checked& picture);

/// Joins the texts that are not empty: "max 3, mean 0.1, share 0.02; pixels differ".
[[nodiscard]] std::string joined(const std::string& first, const std::string& second);

/// A picture in the results of `corda golden --json`, and in golden.json.
[[nodiscard]] nlohmann::json picture_json(const Checked& picture);
/// The keys "max", "mean" and "share" of a difference; null if there are no figures.
[[nodiscard]] nlohmann::json figures_json(const std::optional<Difference>& difference);

/// As JUnit's XML: a test suite per scene, a test case per picture.
[[nodiscard]] std::string junit_xml(const SuiteResult& result);

/// Failures as Markdown, for the summary or a comment of a pull request: a table per cause.
[[nodiscard]] std::string markdown(const SuiteResult& result);

/// One page of HTML that needs no other file. It shows, per failed picture, the reference, the new picture
/// and sixteen times their difference, side by side, blinking, or under a slider.
[[nodiscard]] std::string html_report(const SuiteResult& result);

/// Sixteen times the difference of each channel on black, that of alpha in all three. Blue: only one of the
/// pictures has the pixel.
[[nodiscard]] Image amplified(const Image& a, const Image& b);

}  // namespace corda::golden
