#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/scene/scene.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/overlay.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::pipeline {

/// The part of the motion up to a state that its picture shows.
struct Traces {
    std::span<const view::Trail> trails;  ///< one per particle traced(), or none
    double plotted_s = 0.0;               ///< the time to which the curves of the live plot go
};

/// Draws a scene's bodies at any positions. The first picture opens OpenGL.
class SceneRenderer {
  public:
    /// `scene` and `system`, its own, must outlive the renderer. Throws corda::Error: kUsage for an unknown
    /// backend, kInvalidScene for a size, style or camera that cannot be.
    SceneRenderer(const Scene& scene, const System& system, const std::string& backend, bool require_gpu);
    SceneRenderer(const SceneRenderer&) = delete;
    SceneRenderer& operator=(const SceneRenderer&) = delete;
    ~SceneRenderer();

    /// Whether pictures depend on the whole motion: by the camera, by what pins hang from, or by a plot.
    [[nodiscard]] bool needs_motion() const;
    /// Fits what follows from the motion to the bounds of each particle and the spread of the quantity that
    /// colours tell. Returns the scene's camera with center and height filled in, so that all is in view.
    CameraDef fit(std::span<const MotionBounds> motion, const sim::Spread& spread = {});
    /// What the live plot shows.
    void set_plot(const view::PlotData& data) { overlay_.set_plot(data, view_.body_colors()); }
    /// At least the scale of the camera that fit() will return for a motion within `bounds`.
    [[nodiscard]] double largest_pixels_per_metre(const MotionBounds& bounds) const;
    /// The map to pixels of a camera with center and height.
    [[nodiscard]] view::Camera map_of(const CameraDef& camera) const;

    /// Opens OpenGL, and what draws unless only the context is asked for; at the end, what was the thread's
    /// context before is so again. Uses may nest. Throws corda::Error (kNoGl).
    enum class Needs { kDrawing, kContext };
    class Use {
      public:
        explicit Use(SceneRenderer& renderer, Needs needs = Needs::kDrawing) { renderer.open(needs); }

      private:
        gl::SavedContext saved_;
    };

    /// What draw() throws if `on_progress` itself has drawn this renderer: its picture is the last one now.
    struct Overdrawn : std::exception {};

    /// See view::SceneView::traced().
    [[nodiscard]] std::vector<std::size_t> traced() const { return view_.traced(); }
    /// Draws a state, with what the overlay says of it and the traces to it; returns what may differ
    /// from the last picture. Asks `on_progress` again and again if the picture is large. Throws
    /// Overdrawn, and corda::Error: kNoGl, kInterrupted. Requires a Use.
    Damage draw(const State& state, const view::Camera& map, const view::Caption& caption = {},
                const Traces& traces = {}, const OnProgress& on_progress = {});
    /// Whether a picture of a state would show nothing but the ground. Draws nothing.
    [[nodiscard]] bool would_show_nothing(const State& state, const view::Camera& map, const Traces& traces);
    /// Begins the exposure of a picture, whatever became of the last one, and returns its number. Requires a
    /// Use.
    [[nodiscard]] std::int64_t begin_exposure();
    /// Adds a state to the exposure that develop() makes a picture of. Asks and throws as draw().
    void expose(std::int64_t picture, const State& state, const view::Camera& map, const Traces& traces,
                const OnProgress& on_progress = {});
    /// Makes the exposure a picture, with what the overlay says of it; returns what may differ from the last
    /// one. Throws Overdrawn.
    Damage develop(std::int64_t picture, const view::Caption& caption, const view::Camera& map);
    /// Draws a list of this renderer's size, in the same way.
    Damage draw(view::DrawList list, const OnProgress& on_progress = {});
    /// Adds what the overlay says to a list, without the curves of the plot.
    void annotate(const view::Caption& caption, const view::Camera& map, view::DrawList& list) {
        overlay_.draw(caption, map.pixels_per_metre(), list);
    }
    void draw_curves(double time_s, view::DrawList& list) const { overlay_.draw_curves(time_s, list); }
    [[nodiscard]] const view::SceneView& view() const { return view_; }
    /// The last picture.
    [[nodiscard]] const Image& image() const { return canvas_->renderer->image(); }
    /// Whether nothing was to be drawn on it but the ground.
    [[nodiscard]] bool shows_nothing() const { return shows_nothing_; }
    /// How many pictures were drawn.
    [[nodiscard]] std::int64_t pictures() const { return pictures_; }
    /// Requires a Use.
    [[nodiscard]] const gl::Context& context() const { return canvas_->context; }

  private:
    /// The context dies after the renderer.
    struct Canvas {
        explicit Canvas(const gl::ContextDef& def) : context(def) {}
        gl::Context context;
        std::optional<render::FrameRenderer> renderer;
        bool has_checked_tints = false;
    };

    void open(Needs needs);
    /// Makes the list what a state shows, but for the overlay's words.
    void list(const State& state, const view::Camera& map, const Traces& traces);
    /// Asks `on_progress` whether to go on with the picture that was begun last.
    [[nodiscard]] OnProgress asking(const OnProgress& on_progress);
    Damage paint(const OnProgress& on_progress);
    /// Lets the driver draw what the list needs for the first time in a small picture, which is checked.
    void check_tints();

    const Scene* scene_;
    const System* system_;
    gl::ContextDef gl_;
    view::SceneView view_;
    view::Overlay overlay_;
    view::DrawList list_;
    std::unique_ptr<Canvas> canvas_;
    std::int64_t pictures_ = 0;
    bool shows_nothing_ = true;
};

}  // namespace corda::pipeline
