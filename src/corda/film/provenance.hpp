#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "corda/media/defs.hpp"
#include "corda/scene/scene.hpp"

namespace corda {

/// A moment that a picture shows: a frame, or a time.
struct PictureTime {
    std::optional<std::int64_t> frame;
    double time_s = 0.0;  ///< if it is no frame

    friend bool operator==(const PictureTime&, const PictureTime&) = default;
};

/// How a picture was drawn of its scene.
struct PictureOrigin {
    std::string command = {};             ///< "still", "strobe" or "sheet"; "frame" of a sequence
    std::vector<PictureTime> times = {};  ///< that it shows
    /// Other times of the same command: they are part of the motion that the camera is fitted to.
    std::vector<double> film_times_s = {};
    int columns = 0;  ///< of a sheet; 0: not given
    double shutter = 0.0;
    std::optional<double> pixels_per_inch = {};
    std::optional<double> font_pt = {};  ///< of all letters

    friend bool operator==(const PictureOrigin&, const PictureOrigin&) = default;
};

/// How a golden picture was made, besides its scene.
struct GoldenRecord {
    std::string renderer = {};  ///< GL_RENDERER
    /// Keys of solver and camera that the scene leaves open, with the values that were chosen.
    std::map<std::string, std::string> chosen = {};
};

/// Origin of a file.
struct Provenance {
    /// Of the text that a file carries. QuickTime's comments end at 64 KiB.
    static constexpr std::size_t kMaxBytes = std::size_t{32} << 10;

    std::string corda = {};              ///< the version that made it
    std::string name = {};               ///< Scene::name, printable
    std::string scene = {};              ///< the text of the scene
    std::vector<Setting> settings = {};  ///< in place of what the text says
    std::string left_out = {};           ///< why there is no scene; empty if there is one
    std::string frames = {};             ///< of a video or a sequence of pictures: "FIRST:END"
    std::optional<PictureOrigin> picture = {};
    std::optional<GoldenRecord> golden = {};  ///< of a picture that `corda golden` keeps
};

/// The keyword of the text in a PNG, and the key in the comment of a video.
inline constexpr const char* kProvenanceKeyword = "Provenance";
inline constexpr const char* kProvenanceKey = "provenance";

/// The provenance of a file that this version makes from `scene`: its text and settings without video.jobs,
/// which changes no byte; of a scene that code has filled in or changed, write_scene(). Without the scene if
/// that is too large, or code alone can say it. No folder, host or date is part of it.
[[nodiscard]] Provenance provenance_of(const Scene& scene);

/// As a JSON object of at most kMaxBytes. A scene that does not fit is compressed; if that does not suffice,
/// left out.
[[nodiscard]] std::string provenance_text(Provenance provenance);

/// Why a file with such a text carries no scene; empty if it does.
[[nodiscard]] std::string left_out_of(const std::string& text);

/// Provenance in the texts of a PNG; without a name if there is none, or it is damaged.
[[nodiscard]] Provenance provenance_in(const PngInfo& info);

/// Reads what a PNG or a video carries.
/// Throws corda::Error: kIo if the file cannot be read, kUsage if it carries nothing, or what it carries is
/// damaged.
[[nodiscard]] Provenance read_provenance(const std::string& path);

/// The scene of a file, with `settings` in place of what it says; messages name the file. Throws corda::Error
/// (kUsage) for a file without one.
[[nodiscard]] Scene scene_of(const Provenance& provenance, const std::string& path,
                             const std::vector<Setting>& settings = {});

}  // namespace corda
