#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Turns states into draw lists. What is drawn, and in which layer, is settled once; where, anew each frame.
///
/// From back to front: imaginary bars, the links of ropes and nets (one layer a colour), real bars, free
/// particles, pinned particles.
class SceneView {
  public:
    /// `body_styles` has one entry a body of `system`, which must outlive this. Throws corda::Error
    /// (kInvalidScene) where the scene needs more than kMaxLayers layers.
    SceneView(const sim::System& system, const StyleDef& style, const std::vector<BodyStyleDef>& body_styles,
              int width, int height);

    /// Pixels around a particle's centre that the widest thing drawn on it reaches.
    [[nodiscard]] double clearance_px() const { return clearance_px_; }

    /// Writes the frame of `state` into `list`, whose memory is used again.
    void draw(const sim::State& state, const Camera& camera, DrawList& list) const;

  private:
    /// A line from particle a to particle b, or a disc where they are the same.
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

    const sim::System* system_;
    Color background_;
    int width_;
    int height_;
    double rope_width_px_;
    std::vector<double> body_radius_px_;  // one a body
    double clearance_px_ = 0.0;
    std::vector<ItemLayer> layers_;
};

}  // namespace corda::view
