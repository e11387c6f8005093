#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "corda/media/defs.hpp"
#include "corda/pipeline/film.hpp"

namespace corda::golden {

/// The record in a golden picture of the way it was made.
struct Provenance {
    std::string version;   ///< of Corda
    std::string scene;     ///< its name
    std::string renderer;  ///< GL_RENDERER
    std::string solver;    ///< setting "solver={...}"; empty if it is not known
    std::string center;    ///< setting "camera.center=[...]"
    std::string height;    ///< setting "camera.height=..."
    std::string margin;    ///< camera.margin, to which both were fitted; empty if it is not known
    std::string state;     ///< FNV-1a of the positions' bits, in hexadecimal
    /// x and y of each particle in turn; of more than kMaxKept, of every second, third, ... alone.
    std::vector<double> positions_m;

    static constexpr std::size_t kMaxKept = 256;

    /// Whether `corda golden` wrote this; other pictures are none of its business.
    [[nodiscard]] bool is_golden() const { return !state.empty(); }
    /// Whether both have the same solver and camera.
    [[nodiscard]] bool is_frozen_as(const Provenance& other) const {
        return solver == other.solver && center == other.center && height == other.height;
    }
};

/// How a film's picture at a time is made.
[[nodiscard]] Provenance provenance_of(Film& film, double time_s);

/// As the texts of a PNG. Positions are the bits of their numbers, so that they are read back exactly. `film`
/// is what the picture was drawn from: `still --from` draws it again.
[[nodiscard]] PngInfo to_png_info(const Provenance& provenance, Film& film, double time_s);

/// Texts that are missing, or not what to_png_info() writes, leave their fields empty.
[[nodiscard]] Provenance from_png_info(const PngInfo& info);

/// Settings that give `scene` the solver and the camera of `made`, as far as the scene itself leaves them
/// open: a method or a camera that the scene names is what a golden test checks.
[[nodiscard]] std::vector<Setting> freezing(const Scene& scene, const Provenance& made);

/// The changes of a scene since its picture was kept, of the keys that may change pixels: "world.drag is 0.2
/// and was 0, rope[0].hang.links is 31 and was 30". Empty if there are none, or the kept picture does not
/// carry its scene.
[[nodiscard]] std::string scene_change(const std::string& reference, const Scene& now);

/// The most likely cause of the difference of two pictures, in words.
[[nodiscard]] std::string cause_of(const Provenance& reference, const Provenance& now);

/// The largest distance between particles in m; empty if positions are not known or differ in number.
[[nodiscard]] std::optional<double> largest_distance_m(const Provenance& a, const Provenance& b);

}  // namespace corda::golden
