#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "corda/pipeline/provenance.hpp"

namespace corda::golden {

/// How a film's picture at a time is made.
[[nodiscard]] GoldenRecord record_of(Film& film, double time_s);

/// The texts of a golden PNG. `film` is what the picture was drawn from: `still --from` draws it again.
[[nodiscard]] PngInfo to_png_info(GoldenRecord record, const Film& film, double time_s);

/// Settings that give `scene` the solver and the camera of `made`, as far as the scene itself leaves them
/// open: a method or a camera that the scene names is what a golden test checks.
[[nodiscard]] std::vector<Setting> freezing(const Scene& scene, const std::optional<GoldenRecord>& made);

/// The values of the keys that may change pixels; see digest().
[[nodiscard]] std::map<std::string, std::string> pixel_digest(const Scene& scene);

/// The changes of a scene since its picture was kept, of the keys that may change pixels: "world.drag is 0.2
/// and was 0, rope[0].hang.links is 31 and was 30". Those that `settings` make say so. Empty if there are
/// none, or the kept picture does not carry its scene.
[[nodiscard]] std::string scene_change(const std::string& reference, const Scene& now,
                                       const std::vector<Setting>& settings = {});

/// Why pictures differ.
struct Cause {
    std::string text;
    std::string group;  ///< the same for all pictures that differ for this reason, whatever the figures
};

/// Cause::group of pictures that nothing known distinguishes.
inline constexpr const char* kPixelsDiffer = "pixels differ";

/// The most likely cause of the difference from a kept picture, in words. `fonts` as Provenance::fonts.
[[nodiscard]] Cause cause_of(const Provenance& kept, const GoldenRecord& now,
                             const std::vector<std::string>& fonts);

/// The largest distance between particles in m; empty if positions are not known or differ in number.
[[nodiscard]] std::optional<double> largest_distance_m(const GoldenRecord& a, const GoldenRecord& b);

}  // namespace corda::golden
