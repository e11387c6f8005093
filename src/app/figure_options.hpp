#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "corda/pipeline/film.hpp"
#include "shots.hpp"

namespace corda::app {

/// What `still`, `strobe` and `sheet` have in common.
struct FigureOptions {
    SceneOptions scene;
    GlOptions gl;
    EmptyPictures empty;
    ShotOptions shots;
    std::string output;
    std::optional<double> width_mm;
    std::optional<double> pixels_per_inch;
    double shutter = 0.0;
    bool force = false;
    bool dry_run = false;

    /// `output_help` says what the output may be.
    void add_to(CLI::App& command, const std::string& output_help);
    /// The scene, with the picture size that `--width-mm` asks for.
    [[nodiscard]] Scene load() const;
    [[nodiscard]] Film film_of(const Console& console, const Scene& scene,
                               const std::vector<Shot>& some) const;
    /// What the file of a figure says of itself. `width_px`: of the whole picture.
    [[nodiscard]] PngInfo describe(const Scene& scene, const std::vector<Shot>& some, int width_px) const;
    /// Makes the only picture of a command, and reports it.
    ExitCode write_one(const Console& console, const Scene& scene, const std::vector<Shot>& some,
                       const FigureDef& def) const;
};

}  // namespace corda::app
