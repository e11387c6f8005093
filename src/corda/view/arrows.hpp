#pragma once

#include <array>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Ropes with at most this many links are drawn as pendulums: balls for their masses, tensions at both ends
/// of links.
inline constexpr std::size_t kLinksOfPendulum = 3;

/// The fields of a state from which arrows are computed.
[[nodiscard]] inline StateFields fields_of(Arrows arrows) {
    return {.velocities = arrows == Arrows::kVelocity, .tensions = arrows == Arrows::kTension};
}

/// An arrow that starts at a particle.
struct Arrow {
    Vec2 at_m;   ///< relative to the system's origin
    Vec2 value;  ///< y up, in m/s or N
    /// Along the body from there to the next support in the direction of the arrow.
    double to_support_m = HUGE_VAL;
};

/// Extent of arrows during a motion.
class ArrowExtents {
  public:
    /// Includes the arrows of a state. `is_instant`: it is one of those that set the scale.
    void include(std::span<const Arrow> arrows, bool is_instant);
    /// Size of the longest arrow that is drawn to scale; 0 without arrows. It is a bound of all, or a round
    /// number if that is less: at least 1.5 times the largest arrow of 9 in 10 instants.
    [[nodiscard]] double longest() const;
    [[nodiscard]] double largest() const { return largest_; }
    /// True if some are larger than the longest.
    [[nodiscard]] bool is_cut() const { return longest() < largest_; }
    /// Adds the extents of arrows with this scale, and of their heads, to a list. Those above `longest` have
    /// its length.
    void list(double longest, double pixels_per_unit, double head_px, std::vector<Drawn>& drawn) const;

  private:
    double largest_ = 0.0;
    std::vector<double> instants_;  ///< the largest arrow of each
    /// Where arrows to the left, right, top, bottom start, by their extent, rounded up to 4 bits.
    std::array<std::map<double, MotionBounds>, 4> starts_;
};

/// Adds an arrow with a filled head to the last layer, or with two heads if it is cut; a short one has a
/// small head. `side_px`: the shorter side of the frame.
void add_arrow(PixelPoint from, PixelPoint to, double side_px, bool has_halo, bool is_cut, DrawList& list);

/// The scale of arrows, the same in all pictures of a film.
struct ArrowScale {
    double pixels_per_unit = 0.0;  ///< 0: there are no arrows
    double longest = 0.0;          ///< the size of the longest one
    bool is_cut = false;           ///< some are larger
};

/// The particles of a scene that have arrows: of many particles, or many bodies, only some.
class ArrowPlaces {
  public:
    ArrowPlaces() = default;
    /// `system` must outlive this.
    ArrowPlaces(const System& system, Vec2 gravity_m_s2, Arrows kind);

    /// The arrows of a state, which must have fields_of() them; those along a rope at least `apart_m` apart,
    /// and as far from the support that they point to.
    [[nodiscard]] std::vector<Arrow> of(const State& state, double apart_m = 0.0) const;

  private:
    /// A free particle. Tension pulls it along `bar`.
    struct Place {
        std::size_t particle;
        std::size_t bar;
        double path_m;        ///< along the rope from the place before; HUGE_VAL: the arrow is not along it
        double to_support_m;  ///< see Arrow
    };

    /// The path from a particle along bar `k` and those before it to the next pin; HUGE_VAL without one.
    [[nodiscard]] double to_support_m(std::size_t particle, std::size_t k) const;

    const System* system_ = nullptr;
    Vec2 gravity_m_s2_;
    Arrows kind_ = Arrows::kNone;
    std::vector<Place> places_;
};

/// The arrows of a scene, with one scale for all pictures; none by default.
class ArrowLayer {
  public:
    ArrowLayer() = default;
    /// The extents during the motion set the scale; without extents nothing is drawn.
    ArrowLayer(ArrowPlaces places, const StyleDef& style, double side_px, const ArrowExtents& extents = {});

    [[nodiscard]] const ArrowPlaces& places() const { return places_; }
    /// Adds the extents of all arrows, as a camera that moves sees them if `extents` are given, to a list.
    void list(std::vector<Drawn>& drawn, const ArrowExtents* extents = nullptr) const;
    /// Draws the arrows that are longer than their heads. Usual ones of tension in a rope do not touch,
    /// and one that would reach a support is moved back along its line.
    void draw(const State& state, const Camera& camera, DrawList& list) const;
    [[nodiscard]] const ArrowScale& scale() const { return scale_; }

  private:
    ArrowPlaces places_;
    Color color_;
    double side_px_ = 0.0;
    ArrowExtents extents_;
    ArrowScale scale_;
    double usual_ = 0.0;  ///< most arrows are no longer
};

}  // namespace corda::view
