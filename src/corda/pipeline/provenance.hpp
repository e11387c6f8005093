#pragma once

#include <cstdint>
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

    friend bool operator==(const PictureOrigin&, const PictureOrigin&) = default;
};

/// How a golden picture was made of its scene.
struct GoldenRecord {
    static constexpr std::size_t kMaxParticles = 256;

    std::string renderer = {};     ///< GL_RENDERER
    std::string solver = {};       ///< setting "solver={...}"
    Vec2 center_m = {};            ///< of the camera
    double height_m = 0.0;         ///< of the camera
    double margin = 0.0;           ///< camera.margin, to which both were fitted
    std::string color_scale = {};  ///< see Film::color_scale(); empty also in pictures that do not say it
    std::string state = {};        ///< FNV-1a of the positions' bits, in hexadecimal
    /// x and y of each particle in turn; of more than kMaxParticles, of every second, third, ... alone.
    std::vector<double> positions_m = {};

    /// True if both have the same solver and camera.
    [[nodiscard]] bool is_frozen_as(const GoldenRecord& other) const {
        return solver == other.solver && center_m == other.center_m && height_m == other.height_m;
    }
};

/// Origin of a file.
struct Provenance {
    /// Of the text that a file carries. QuickTime's comments end at 64 KiB.
    static constexpr std::size_t kMaxBytes = std::size_t{32} << 10;

    std::string corda = {};     ///< the version that made it
    std::string name = {};      ///< Scene::name, printable
    std::string scene = {};     ///< a scene file (write_scene)
    std::string left_out = {};  ///< why there is no scene; empty if there is one
    /// Names and versions of the fonts of its title, texts and labels, besides DejaVu Sans.
    std::vector<std::string> fonts = {};
    std::string frames = {};  ///< of a video or a sequence of pictures: "FIRST:END"
    std::optional<PictureOrigin> picture = {};
    std::optional<GoldenRecord> golden = {};  ///< of a picture that `corda golden` keeps
    std::vector<Provenance> parts = {};       ///< of a video that was joined
};

/// The keyword of the text in a PNG, and the key in the comment of a video.
inline constexpr const char* kProvenanceKeyword = "Provenance";
inline constexpr const char* kProvenanceKey = "provenance";

/// The provenance of a file that this version makes from `scene`: without the scene if that takes too much
/// space or code alone can say it. No folder, host or date is part of it.
[[nodiscard]] Provenance provenance_of(const Scene& scene);

/// The provenance of videos that were joined. Parts of a joined one become its own.
[[nodiscard]] Provenance joined(const std::vector<Provenance>& videos);

/// As a JSON object of at most kMaxBytes. Scenes that do not fit are compressed; if that does not suffice,
/// left out, and then also the picture and the parts. Positions of a golden picture are the bits of their
/// numbers in hexadecimal.
[[nodiscard]] std::string provenance_text(Provenance provenance);

/// "other fonts besides DejaVu Sans: A 1.0, now none"; empty if `now` are the fonts of the file.
[[nodiscard]] std::string font_change(const Provenance& provenance, const std::vector<std::string>& now);

/// Why a file with such a text carries no scene, or not all of its parts; empty if it does.
[[nodiscard]] std::string left_out_of(const std::string& text);

/// Provenance in the texts of a PNG; without a name if there is none, or it is damaged.
[[nodiscard]] Provenance provenance_in(const PngInfo& info);

/// For which advice errors give: a file of --from, or a part of a joined video.
enum class OriginUse { kFrom, kJoin };

/// Reads what a PNG or a video carries.
/// Throws corda::Error: kIo if the file cannot be read, kUsage if it carries nothing, or what it carries is
/// damaged.
[[nodiscard]] Provenance read_provenance(const std::string& path, OriginUse use = OriginUse::kFrom);

/// The scene of a file, with `settings` in place of what it says; messages name the file. Throws corda::Error
/// (kUsage) for one with no scene, or several.
[[nodiscard]] Scene scene_of(const Provenance& provenance, const std::string& path,
                             const std::vector<Setting>& settings = {});

}  // namespace corda
