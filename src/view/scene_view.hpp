#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Turns states into draw lists. Construction decides what is drawn and in which layer; each frame decides
/// where.
///
/// From back to front: imaginary bars, the links of ropes and nets (one layer per colour), real bars, free
/// particles, pinned particles.
class SceneView {
  public:
    /// `body_styles` has an entry per body of `system`; one that is missing overrides nothing. `system` must
    /// outlive this. Throws corda::Error (kInvalidScene) for a style that validate() refuses, and if the
    /// scene needs more than kMaxLayers layers.
    SceneView(const System& system, const StyleDef& style, const std::vector<BodyStyleDef>& body_styles,
              int width, int height);

    /// Half of the widest line or marker: how far a drawn thing extends around a particle, in pixels.
    [[nodiscard]] double clearance_px() const { return clearance_px_; }

    /// Writes the frame of `state` to `list`. Memory that `list` holds is reused.
    void draw(const State& state, const Camera& camera, DrawList& list) const;

  private:
    /// A line from particle a to particle b; a disc if they are the same.
    struct Item {
        std::size_t a;
        std::size_t b;
        double radius_px;
    };
    struct ItemLayer {
        Color color;
        std::vector<Item> items;
    };

    void add_bars(const StyleDef& style, bool real);
    void add_bodies(const StyleDef& style, const std::vector<BodyStyleDef>& body_styles);
    void add_markers(const StyleDef& style, bool pinned);
    ItemLayer& layer_of(Color color, std::size_t first_layer);

    const System* system_;
    Color background_;
    int width_;
    int height_;
    double rope_width_px_;
    std::vector<double> body_radius_px_;  // per body
    double clearance_px_ = 0.0;
    std::vector<ItemLayer> layers_;
};

}  // namespace corda::view
