#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "corda/pipeline/film.hpp"
#include "time_options.hpp"

namespace corda::app {

/// Options that `still`, `strobe` and `sheet` share.
struct FigureOptions {
    SceneOptions scene;
    GlOptions gl;
    EmptyPictures empty;
    TimeOptions shots;
    std::string output;
    std::optional<double> width_mm;
    std::optional<double> pixels_per_inch;
    double shutter = 0.0;
    bool force = false;
    bool dry_run = false;
    // Of the file of `--from`.
    std::vector<double> film_times_of_origin;
    int columns_of_origin = 0;

    /// `output_help` says what the output may be.
    void add_to(CLI::App& command, const std::string& output_help);
    /// The scene, with the picture size that `--width-mm` asks for.
    [[nodiscard]] Scene load(const Console& console) const;
    /// Throws CLI::RequiredError if there is no scene, or no moment that is not that of `--from`.
    void require() const;
    /// What the file of `--from`, made by `command`, tells in place of what the command line does not.
    void take_origin(const Console& console, std::string_view command);
    /// The times beside those of frames that the film of these shots records.
    [[nodiscard]] std::vector<double> film_times(const std::vector<RequestedTime>& some) const;
    [[nodiscard]] Film film_of(const Console& console, const Scene& scene,
                               const std::vector<RequestedTime>& some) const;
    /// What the file of a figure says of itself. `scene` has the size of the whole picture; `origin` gets its
    /// times, of which the film also has `all_s`.
    [[nodiscard]] PngInfo describe(const Scene& scene, const std::vector<RequestedTime>& some,
                                   PictureOrigin origin, const std::vector<double>& all_s) const;
    /// Makes the only picture of a command, and reports it.
    ExitCode write_one(const Console& console, const Scene& scene, const std::vector<RequestedTime>& some,
                       const FigureDef& def) const;

  private:
    mutable std::optional<Provenance> made_;  ///< of the scene that describe() is given
};

}  // namespace corda::app
