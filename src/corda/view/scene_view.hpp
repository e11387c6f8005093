#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
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

/// One free end per open rope that has one, preferably the last particle.
[[nodiscard]] std::vector<std::size_t> free_ends(const System& system);

/// The label of a body, next to one of its particles.
struct BodyLabel {
    std::string text;
    std::size_t particle = 0;
    /// The label continues the line from this particle; if it is `particle`, the label is above it.
    std::size_t from = 0;
    double clear_px = 0.0;  ///< free distance around the particle
    int row = 0;            ///< above other labels of the same place
};

/// Turns states into draw lists. The content and its layers are chosen at construction, positions per frame.
///
/// From back to front: trails; imaginary bars; each body, its links and then its balls; real bars, markers of
/// free particles; arrows; supports, markers of pinned particles.
class SceneView {
  public:
    /// `body_styles` has an entry per body of `system`; one that is missing overrides nothing. `system` must
    /// outlive this.
    SceneView(const System& system, Vec2 gravity_m_s2, const StyleDef& style,
              const std::vector<BodyStyleDef>& body_styles, int width, int height);

    /// Colours links by a quantity, whose fields the states must then have.
    void set_scale(const ColorScale& scale) { scale_ = scale; }
    /// That scale; std::nullopt if colours show no quantity.
    [[nodiscard]] const std::optional<ColorScale>& scale() const { return scale_; }
    /// Sets the scale of arrows by their extents during the motion. There are none before the call.
    void set_arrows(const ArrowExtents& extents) { arrows_.set_extents(extents); }
    [[nodiscard]] const ArrowLayer& arrows() const { return arrows_; }
    /// Chooses the supports by the bounds of each particle. There are none before the call.
    void set_motion(std::span<const MotionBounds> motion);
    /// Extents of everything drawn for particles that stay within `motion`.
    [[nodiscard]] std::vector<Drawn> drawn(std::span<const MotionBounds> motion) const;
    /// The same without supports.
    [[nodiscard]] std::vector<Drawn> drawn_bodies(std::span<const MotionBounds> motion) const;

    /// The colour of each body; of its first link if links differ.
    [[nodiscard]] std::vector<Color> body_colors() const;

    /// The labels of bodies that have one: where its style says, else above its first pin, unless another
    /// label's body is pinned there too, at its free end, or above its first particle. Several above one pin
    /// are in rows. Final after set_motion().
    [[nodiscard]] std::vector<BodyLabel> labels() const;

    /// A label of a particle: beyond the end of a rope, otherwise above it.
    [[nodiscard]] BodyLabel label_at(std::size_t particle, std::string text) const;

    /// The particles whose paths are drawn, body by body, each once; none without trails.
    [[nodiscard]] const std::vector<std::size_t>& traced() const { return traced_; }

    /// Writes the frame of `state` to `list`, with a trail for each of the particles traced(), or none.
    /// Memory that `list` holds is reused.
    void draw(const State& state, const Camera& camera, DrawList& list,
              std::span<const Trail> trails = {}) const;

    // The steps of draw(), for several poses in one picture: draw_pose() once per pose, the others once.
    void start(DrawList& list) const;
    void draw_trails(std::span<const Trail> trails, const Camera& camera, DrawList& list) const;
    void draw_pose(const State& state, const Camera& camera, DrawList& list) const;
    /// Draws the links and balls of one body.
    void draw_body(std::size_t i, const State& state, const Camera& camera, DrawList& list) const {
        draw_bodies(i, i + 1, Positions(state, camera), list);
    }
    /// Draws the supports, which never move; any `state` will do.
    void draw_supports(const State& state, const Camera& camera, DrawList& list) const;

  private:
    struct Ball {
        std::size_t particle;
        std::size_t link;  ///< a link that ends there
        double radius_px;
    };
    struct BodyLook {
        Color color;
        std::vector<Color> link_colors;  ///< in turn; empty: `color`
        double radius_px;                ///< of its first link
        double end_radius_px;            ///< and of its last
        bool is_merged;                  ///< drawn in the layer of the body before
        std::optional<LabelAt> label_at;
        std::vector<Ball> balls;
    };
    /// A state as the camera sees it.
    class Positions {
      public:
        Positions(const State& state, const Camera& camera) : state_(&state), camera_(&camera) {}
        [[nodiscard]] PixelPoint px(std::size_t particle) const {
            return {camera_->x_px(state_->x_m[particle]), camera_->y_px(state_->y_m[particle])};
        }
        [[nodiscard]] double distance_m(const Bar& bar) const {
            return sim::length(state_->x_m[bar.b] - state_->x_m[bar.a],
                               state_->y_m[bar.b] - state_->y_m[bar.a]);
        }
        [[nodiscard]] double pixels_per_metre() const { return camera_->pixels_per_metre(); }
        [[nodiscard]] const State& state() const { return *state_; }

      private:
        const State* state_;
        const Camera* camera_;
    };

    [[nodiscard]] BodyLabel label_of(std::size_t body) const;
    [[nodiscard]] double link_radius_px(std::size_t body, std::size_t link) const;
    [[nodiscard]] std::vector<Ball> balls_of(std::size_t body) const;
    [[nodiscard]] double marker_radius_px(std::size_t body, bool pinned) const;
    /// Includes the positions that slack links of a string may reach.
    void include_slack(const Body& body, std::span<const MotionBounds> motion, MotionBounds& bounds) const;
    [[nodiscard]] Tint tint_of(std::size_t body, std::size_t link, const State& state) const;
    /// Gives a row of merged bodies its gradient of colours.
    void color_merged(const std::vector<BodyStyleDef>& body_styles);
    /// Draws the bodies first <= i < end in one layer.
    void draw_bodies(std::size_t first, std::size_t end, const Positions& positions, DrawList& list) const;
    void draw_links(std::size_t i, bool is_tinted, double halo_per_radius, const Positions& positions,
                    DrawList& list) const;
    void draw_slack(const Bar& link, double radius_px, double halo_px, Tint tint, const Positions& positions,
                    DrawList& list) const;
    void draw_bars(bool real, const Positions& positions, DrawList& list) const;
    void draw_markers(bool pinned, const Positions& positions, DrawList& list) const;

    const System* system_;
    Vec2 gravity_m_s2_;
    StyleDef style_;
    Look look_;
    int width_;
    int height_;
    double side_px_;  ///< the shorter one
    double rope_width_px_;
    std::vector<std::size_t> free_ends_;
    std::vector<std::size_t> traced_;
    std::vector<BodyLook> bodies_;
    std::size_t ball_count_ = 0;
    Supports supports_;
    std::optional<ColorScale> scale_;
    ArrowLayer arrows_;
};

}  // namespace corda::view
