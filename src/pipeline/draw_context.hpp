#pragma once

#include "corda/pipeline/film.hpp"
#include "corda/pipeline/motion.hpp"
#include "corda/pipeline/scene_renderer.hpp"
#include "corda/pipeline/trail_recorder.hpp"

namespace corda::pipeline {

/// Per-thread drawing state.
struct DrawContext {
    DrawContext(const Scene& scene, const System& system, const FilmDef& def)
        : renderer(scene, system, def.backend, def.require_gpu),
          trails(renderer.traced(), scene.style.trail_s, scene.video.fps) {}

    SceneRenderer renderer;
    TrailRecorder trails;
    State state;
    Figures figures;         ///< of the state
    bool is_silent = false;  ///< no progress callback while the motion is simulated
};

/// Suppresses the progress callback of a draw context during its life.
class Silence {
  public:
    explicit Silence(DrawContext& drawing) : drawing_(&drawing) { drawing.is_silent = true; }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
    ~Silence() { drawing_->is_silent = false; }

  private:
    DrawContext* drawing_;
};

}  // namespace corda::pipeline
