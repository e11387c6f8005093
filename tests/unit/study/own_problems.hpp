#pragma once

#include "corda/reference/ropes.hpp"
#include "corda/scene/scene.hpp"
#include "corda/study/measure.hpp"

namespace corda::study {

/// A problem without a reference.
inline Problem problem_with(const RopeDef& rope, double duration_s) {
    Problem problem;
    problem.id = "own";
    problem.title = "A rope";
    problem.ropes = {rope};
    problem.length_m = reference::length_m(rope);
    problem.world.duration_s = duration_s;
    return problem;
}

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
