#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/arrows.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/supports.hpp"

namespace corda::view {

/// A former position of a particle.
struct TrailPoint {
    double age_s = 0.0;
    Vec2 at_m;  ///< relative to the system's origin
    Vec2 velocity_m_s;
};

/// The path of a particle in order of time, up to its place in the picture.
using Trail = std::vector<TrailPoint>;

/// A point of a trail in pixels, with its remaining strength: 1 now, 0 at the end of the trail.
struct FadingPoint {
    PixelPoint at;
    double left = 0.0;
    PixelPoint slope;  ///< change of `at` per unit of `left`
};

/// Capsules in a picture for all its trails. Many points have fewer each, down to the least.
inline constexpr double kPiecesOfTrails = 1 << 20;
inline constexpr double kMinPiecesPerPoint = 4.0;
inline constexpr double kMaxPiecesPerPoint = 64.0;
inline constexpr double kCapsuleBytes = sizeof(Capsule);

/// Adds the cubics through the points of a path, which must differ in age, with their slopes. The curve fades
/// in alpha and width; where it crosses itself, the younger part shows. `radius_px` is the radius at the
/// young end. Between two points there are at most `max_pieces` capsules.
void add_trail(std::span<const FadingPoint> points, double radius_px, Color color, DrawList& list,
               double max_pieces = kMaxPiecesPerPoint);

/// The free end of an open rope that has one, at the latest once pins are let go, preferably its last
/// particle.
[[nodiscard]] std::optional<std::size_t> free_end(const System& system, const Body& body);

/// One free end per open rope that has one.
[[nodiscard]] std::vector<std::size_t> free_ends(const System& system);

/// The particles whose paths are drawn, body by body, each once; none without trails.
[[nodiscard]] std::vector<std::size_t> traced_particles(const System& system, const StyleDef& style);

/// The data of a whole motion that all its pictures show.
struct WholeMotion {
    /// The bounds of each particle. They choose the supports; without bounds there are none.
    std::span<const MotionBounds> bounds = {};
    /// Colours links by a quantity, whose fields the states must then have.
    std::optional<ColorScale> scale = {};
    ArrowLayer arrows = {};
};

/// A payload, or a mass of a pendulum.
struct Ball {
    std::size_t particle = 0;
    std::size_t link = 0;    ///< a link that ends there
    double radius_px = 0.0;  ///< at least
    double radius_m = 0.0;   ///< and at least

    [[nodiscard]] double radius_in(const Camera& camera) const {
        return std::max(radius_px, radius_m * camera.pixels_per_metre());
    }
};

/// How a body is drawn.
struct BodyView {
    Color color;                     ///< of its first link if links differ
    std::vector<Color> link_colors;  ///< in turn; empty: `color`
    double radius_px = 0.0;          ///< of its first link
    double end_radius_px = 0.0;      ///< and of its last
    double pinned_marker_radius_px = 0.0;
    double free_marker_radius_px = 0.0;
    bool is_merged = false;  ///< drawn in the layer of the body before
    std::optional<LabelAt> label_at = {};
    std::vector<Ball> balls = {};
    /// Particles that lose all their links, drawn from then on: `link` is the last that is cut.
    std::vector<Ball> dots = {};
};

/// The content, colours and sizes of all pictures of a scene. Positions come with a state.
///
/// From back to front: trails; imaginary bars; each body, its links and then its balls; real bars, markers of
/// free particles; arrows; supports, markers of pinned particles.
struct SceneView {
    const System* system;
    Vec2 gravity_m_s2;
    StyleDef style;
    ThemeColors colors;
    int width_px;
    int height_px;
    double side_px;  ///< the shorter one
    double rope_width_px;
    std::optional<ColorScale> scale;
    std::vector<std::size_t> traced;
    ArrowLayer arrows;
    std::vector<BodyView> bodies = {};
    std::size_t ball_count = 0;
    Supports supports = {};
};

/// `body_styles` has an entry per body of `system`; one that is missing overrides nothing. `system` must
/// outlive the view.
[[nodiscard]] SceneView make_scene_view(const System& system, Vec2 gravity_m_s2, const StyleDef& style,
                                        const std::vector<BodyStyleDef>& body_styles, int width_px,
                                        int height_px, const WholeMotion& motion = {});

/// Extents of everything drawn for particles that stay within `bounds`.
[[nodiscard]] std::vector<Drawn> drawn(const SceneView& view, std::span<const MotionBounds> bounds);
/// The same without supports and arrows.
[[nodiscard]] std::vector<Drawn> drawn_bodies(const SceneView& view, std::span<const MotionBounds> bounds);

/// The colour of each body, of its first link if links differ.
[[nodiscard]] std::vector<Color> body_colors(const SceneView& view);

/// Writes the frame of `state` to `list`, with a trail for each traced particle, or none. Memory that `list`
/// holds is reused.
void draw(const SceneView& view, const State& state, const Camera& camera, DrawList& list,
          std::span<const Trail> trails = {});

// The steps of draw(), for several poses in one picture: draw_pose() once per pose, the others once.
void start(const SceneView& view, DrawList& list);
/// A pin that moved and was let go by `time_s` has no trail any more.
void draw_trails(const SceneView& view, std::span<const Trail> trails, double time_s, const Camera& camera,
                 DrawList& list);
void draw_pose(const SceneView& view, const State& state, const Camera& camera, DrawList& list);
/// Draws the supports at the places of a state: those that are there at its time, or, for several poses, at
/// that of the first one.
void draw_supports(const SceneView& view, const State& state, const Camera& camera, DrawList& list,
                   std::optional<double> first_s = {});

/// Draws the links and balls of bodies first <= b < end in one layer.
void draw_bodies(const SceneView& view, std::size_t first, std::size_t end, const State& state,
                 const Camera& camera, DrawList& list);

}  // namespace corda::view
