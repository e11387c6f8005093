#pragma once

#include "corda/pipeline/film.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::test {

/// What a film draws at a time, made apart from it: what the reference renderer is to draw too.
inline view::DrawList draw_list_of(const Film& film, double time_s) {
    const Scene& scene = film.scene();
    const int width_px = scene.video.width_px;
    const int height_px = scene.video.height_px;
    const view::SceneView scene_view(film.system(), scene.style, scene.body_styles, width_px, height_px);
    const view::Camera camera(film.camera(), film.system().origin_m, width_px, height_px);
    view::DrawList list;
    scene_view.draw(film.state_at(time_s), camera, list);
    return list;
}

}  // namespace corda::test
