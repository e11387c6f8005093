#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/media/video_writer.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

namespace corda::scene {

/// A whole scene file, validated: the Defs of the modules that it speaks to.
struct Scene {
    std::string name;    ///< the file's name without folder and ending
    std::string source;  ///< the file's path, as messages name it
    sim::WorldDef world;
    std::vector<sim::RopeDef> ropes;
    std::vector<sim::NetDef> nets;
    std::vector<view::BodyStyleDef> body_styles;  ///< one a body: ropes, then nets
    sim::SolverDef solver;
    view::StyleDef style;
    view::CameraDef camera;
    media::VideoDef video;
};

/// One `--set key=value` of the command line, e.g. "video.fps=30" or "rope[0].mass=2". The value is read as
/// TOML; one that is not TOML is taken as a string.
using Setting = std::string;

/// Reads a scene file, with `settings` put in the place of what it says. Throws corda::Error: kIo where the
/// file cannot be read, kInvalidScene for anything wrong in it, kUsage for a setting that is not key=value.
[[nodiscard]] Scene load_scene(const std::string& path, const std::vector<Setting>& settings = {});

/// The same for TOML text; `source_name` stands in the messages in place of the path.
[[nodiscard]] Scene parse_scene(std::string_view toml, const std::string& source_name,
                                const std::vector<Setting>& settings = {});

/// The particles and bars of a scene at t = 0: its ropes, then its nets.
[[nodiscard]] sim::System system_of(const Scene& scene);

/// What a scene may ask for at most. Checked before any memory is taken.
struct Limits {
    static constexpr std::int64_t kFileBytes = 16 << 20;
    static constexpr std::int64_t kParticles = 1'000'000;
    static constexpr std::int64_t kBars = 20'000'000;
    static constexpr std::int64_t kSidePixels = 16384;
    static constexpr std::int64_t kFramePixels = std::int64_t{1} << 26;
    static constexpr std::int64_t kFrames = 10'000'000;
    static constexpr std::int64_t kSteps = 1'000'000'000;
    static constexpr double kBarUpdates = 1e13;      // about a day
    static constexpr double kElasticUpdates = 1e11;  // some four hours
    static constexpr double kFrameUpdates = 1e9;     // some minutes
    static constexpr double kCoordinateMetres = 1e9;
};

}  // namespace corda::scene
