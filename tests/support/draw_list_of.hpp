#pragma once

#include "corda/pipeline/film.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::test {

/// What a scene draws at a state, made apart from Film: what the reference renderer is to draw too.
inline view::DrawList draw_list_of(const Scene& scene, const System& system, const CameraDef& camera,
                                   const State& state) {
    const int width_px = scene.video.width_px;
    const int height_px = scene.video.height_px;
    const view::SceneView scene_view(system, scene.style, scene.body_styles, width_px, height_px);
    view::DrawList list;
    scene_view.draw(state, view::Camera(camera, system.origin_m, width_px, height_px), list);
    return list;
}

/// What a film draws at a time.
inline view::DrawList draw_list_of(const Film& film, double time_s) {
    return draw_list_of(film.scene(), film.system(), film.camera(), film.state_at(time_s));
}

}  // namespace corda::test
