#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/film/provenance.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda::golden {

/// How a film's pictures are made.
[[nodiscard]] GoldenRecord record_of(const Film& film);

/// The texts of a golden PNG. `film` is what the picture was drawn from: `still --from` draws it again.
[[nodiscard]] PngInfo to_png_info(GoldenRecord record, const Film& film, double time_s);

/// The values of the keys that may change pixels; see values_of().
[[nodiscard]] std::map<std::string, std::string> pixel_values(const Scene& scene);

/// The changes of a scene since its picture was kept, of the keys that may change pixels. Those that
/// `settings` make say so. Empty if there are none, or the kept picture does not carry a scene that can be
/// read.
[[nodiscard]] std::vector<KeyChange> scene_changes(const Provenance& kept, const Scene& now,
                                                   const std::vector<Setting>& settings = {});

/// Why a picture failed, or why an update writes it. A table in reports.cpp has the verdicts and the words.
struct Cause {
    enum class Kind {
        kNone,     ///< it passed
        kUnknown,  ///< another picture is accepted, and no record says why it differs
        kInvalidScene,
        kNoReference,
        kReferenceIsNoPng,
        kReferenceIsDamaged,
        kSize,
        kUnrecorded,  ///< pixels differ, and the reference does not say how it was made
        kScene,
        kChoice,  ///< of solver or camera, for the same scene
        kVersion,
        kRenderer,
        kPixels,      ///< all of these are the same
        kLostRecord,  ///< pixels are the same, and the reference does not say how it was made
        kUnasked,     ///< by any scene, of a reference
        kUnaskedNoPng,
        kUnaskedUnrecorded,
    };
    Kind kind = Kind::kNone;
    std::vector<KeyChange> changed = {};  ///< keys of the scene
    std::vector<KeyChange> chosen = {};   ///< what follows: keys that the scene leaves open
    std::string stored = {};              ///< size, version or renderer of the reference
    std::string now = {};                 ///< ... and of the new picture
    std::string message = {};             ///< of the reader of a scene or reference
    std::vector<Problem> problems = {};   ///< of an invalid scene
};

/// The most likely cause of the difference from a kept picture. `settings`: see scene_changes().
[[nodiscard]] Cause cause_of(const Provenance& kept, const GoldenRecord& made, const Scene& now,
                             const std::vector<Setting>& settings = {});

}  // namespace corda::golden
