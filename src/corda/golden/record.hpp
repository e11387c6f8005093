#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/film/provenance.hpp"

namespace corda::golden {

/// How a film's pictures are made.
[[nodiscard]] GoldenRecord record_of(Film& film);

/// The texts of a golden PNG. `film` is what the picture was drawn from: `still --from` draws it again.
[[nodiscard]] PngInfo to_png_info(GoldenRecord record, const Film& film, double time_s);

/// The values of the keys that may change pixels; see values_of().
[[nodiscard]] std::map<std::string, std::string> pixel_values(const Scene& scene);

/// The changes of a scene since its picture was kept, of the keys that may change pixels: "world.drag is 0.2
/// and was 0, rope[0].hang.links is 31 and was 30". Those that `settings` make say so. Empty if there are
/// none, or the kept picture does not carry a scene that can be read.
[[nodiscard]] std::string scene_change(const Provenance& kept, const Scene& now,
                                       const std::vector<Setting>& settings = {});

/// Why pictures differ.
struct Cause {
    std::string text;
    std::string group;  ///< the same for all pictures that differ for this reason, whatever the figures
};

/// The most likely cause of the difference from a kept picture, in words. `settings`: see scene_change().
[[nodiscard]] Cause cause_of(const Provenance& kept, const GoldenRecord& made, const Scene& now,
                             const std::vector<Setting>& settings = {});

}  // namespace corda::golden
