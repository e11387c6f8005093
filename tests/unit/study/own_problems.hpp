#pragma once

#include "benchmark/study/reference/ropes.hpp"
#include "corda/scene/scene.hpp"

namespace corda::study {

/// A scene of one rope.
inline Scene scene_with(const RopeDef& rope, double duration_s) {
    Scene scene;
    scene.name = "Own rope-1";
    scene.ropes = {rope};
    scene.body_styles.resize(1);
    scene.world.duration_s = duration_s;
    return scene;
}

}  // namespace corda::study
