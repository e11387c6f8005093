#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Supports of pinned particles: a hatched plate if no part of the body ever rises above the pin, otherwise a
/// ring. "Above" is the axis direction closest to the one against gravity; without gravity all supports are
/// rings, as are those of pins that move. Touching plates are merged.
class Supports {
  public:
    Supports() = default;
    /// `motion`: the bounds of each particle. `side_px`: the shorter side of the frame. `line_px`: the radius
    /// of the lines of each body.
    Supports(const System& system, Vec2 gravity_m_s2, std::span<const MotionBounds> motion, double side_px,
             std::span<const double> line_px);

    /// Adds the extents of the supports.
    void list(std::vector<Drawn>& drawn) const;
    /// Draws those that are there at `time_s`, at the places of a state then or later, into the last layer of
    /// `list`.
    void draw(const State& state, double time_s, const Camera& camera, DrawList& list) const;

  private:
    /// Along the plate to the right, and upwards from it.
    struct Local {
        double along = 0.0;
        double up = 0.0;
    };

    struct Plate {
        Vec2 pin_m;
        double width_px = 0.0;   ///< enough to hide the round end of a line
        double release_s = 0.0;  ///< when its pin is let go; infinite for most
    };
    struct Ring {
        Vec2 center_m;
        double radius_px = 0.0;
        double release_s = 0.0;
        std::optional<std::size_t> moving;  ///< the particle in its centre, if it moves
        MotionBounds way;                   ///< of that
        [[nodiscard]] Vec2 center_at(const State& state) const {
            return moving ? Vec2{state.x_m[*moving], state.y_m[*moving]} : center_m;
        }
    };

    void add_pins(const System& system, const Body& body, std::span<const MotionBounds> motion,
                  double line_px);
    [[nodiscard]] Local local(Vec2 v) const { return {dot(v, left_of(up_)) * -1.0, dot(v, up_)}; }
    void draw_plate(PixelPoint first, double length_px, double plate_px, DrawList& list) const;

    double side_px_ = 0.0;
    Vec2 up_;  ///< a unit vector along an axis, y up; 0 without gravity
    bool has_releases_ = false;
    std::vector<Plate> plates_;  ///< in the order in which they may touch
    std::vector<Ring> rings_;
};

}  // namespace corda::view
