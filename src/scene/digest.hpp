#pragma once

#include <map>
#include <string>

#include "corda/scene/scene.hpp"

namespace corda {

/// What a scene is made of, by the names of the keys of scene files ("video.crf", "rope[0].mass"): the value
/// of each as text, exact; of a long one a hash. Scenes of equal digests have equal frames,
/// whatever they were read from. Without the name, the source, and what changes no byte of a video. A scene
/// of more than a hundred bodies has one hash for all of them.
[[nodiscard]] std::map<std::string, std::string> digest(const Scene& scene);

/// "video.crf is 18 and was 20": the first of `digest` that differs from those of `other`; empty if they are
/// equal.
[[nodiscard]] std::string first_difference(const std::map<std::string, std::string>& digest,
                                           const std::map<std::string, std::string>& other);

}  // namespace corda
