#pragma once

#include "corda/pipeline/film.hpp"
#include "corda/pipeline/motion.hpp"
#include "corda/pipeline/stage.hpp"
#include "corda/pipeline/tracks.hpp"

namespace corda::pipeline {

/// What one thread draws a film with.
struct Brush {
    Brush(const Scene& scene, const System& system, const FilmDef& def)
        : stage(scene, system, def.backend, def.require_gpu),
          tracks(stage.traced(), scene.style.trail_s, scene.video.fps) {}

    Stage stage;
    Tracks tracks;
    State state;
    Figures figures;         ///< of the state
    bool is_silent = false;  ///< nobody is asked while the motion is simulated
};

/// Keeps a brush silent.
class Silence {
  public:
    explicit Silence(Brush& brush) : brush_(&brush) { brush.is_silent = true; }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
    ~Silence() { brush_->is_silent = false; }

  private:
    Brush* brush_;
};

}  // namespace corda::pipeline
