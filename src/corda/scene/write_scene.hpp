#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/scene/scene.hpp"

namespace corda {

/// A scene file in TOML that gives exactly this scene: parse_scene() of it has the same bits. The parts that
/// change no picture are left out: the name, the source, video.jobs and [golden]. Numbers have as many digits
/// as it takes. Bodies have their shapes (Scene::shapes); a straight rope and a grid that code has filled in
/// are recognised, other bodies are written point by point. Throws corda::Error (kUsage) for a scene that no
/// file can give.
[[nodiscard]] std::string write_scene(const Scene& scene);

/// The tables [solver], [[solver.bodies]] and [camera] alone. Throws as write_scene().
[[nodiscard]] std::string write_solver_and_camera(const Scene& scene);

/// The values of a written scene by their keys: "video.crf", "rope[0].hang.links". Scenes of equal values
/// have equal frames, whatever they were read from.
[[nodiscard]] std::map<std::string, std::string> values_of(const Scene& scene);

/// A key whose value differs.
struct KeyChange {
    std::string key;
    std::optional<std::string> now;     ///< none: it is not given
    std::optional<std::string> before;  ///< none: it was not given
    bool is_set = false;                ///< a setting gives the value, not the file
};

/// All keys whose values differ; those of `now` first.
[[nodiscard]] std::vector<KeyChange> differences(const std::map<std::string, std::string>& now,
                                                 const std::map<std::string, std::string>& before);

/// "video.crf is 18 and was 20, world.drag is 1 and was 0 (by --set)". Many end in "and 3 more".
[[nodiscard]] std::string changes_text(const std::vector<KeyChange>& changes);

}  // namespace corda
