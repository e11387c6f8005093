#pragma once

#include <vector>

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Turns states into draw lists: which layers a scene has is settled once, their capsules anew each frame.
class SceneView {
  public:
    /// `rope_styles` has one entry a rope of `system`, which must outlive this. Throws corda::Error (invalid scene)
    /// where the ropes need more than kMaxLayers colours.
    SceneView(const sim::System& system, const StyleDef& style, std::vector<RopeStyleDef> rope_styles, int width,
              int height);

    /// Pixels around a particle's centre that the widest thing drawn on it can reach.
    [[nodiscard]] double clearance_px() const;

    /// Writes the frame of `state` into `list`, whose memory is used again.
    void draw(const sim::State& state, const Camera& camera, DrawList& list) const;

  private:
    struct LayerPlan;
    struct RopeLook {
        std::size_t layer = 0;
        double radius_px = 0.0;
    };

    const sim::System* system_;
    StyleDef style_;
    int width_;
    int height_;
};

}  // namespace corda::view
