#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/scene/scene.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/overlay.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::film {

/// Traces of the motion up to a state.
struct Traces {
    std::span<const view::Trail> trails;  ///< one per particle traced(), or none
    double plotted_s = 0.0;               ///< end of the curves of the live plots
};

/// An open OpenGL context and its frame renderer. The context dies last.
struct Canvas {
    explicit Canvas(const gl::ContextDef& def) : context(def) {}
    gl::Context context;
    std::unique_ptr<render::FrameRenderer> renderer;
    bool has_checked_tints = false;

    /// Deletes a canvas, with its context current, or leaks it if that is impossible: OpenGL objects can only
    /// be deleted in their own context, which may be lost, in use by another thread, or that of a parent
    /// process.
    struct Delete {
        void operator()(Canvas* canvas) const;
    };
};
using OwnedCanvas = std::unique_ptr<Canvas, Canvas::Delete>;

/// Draws a scene's bodies at any positions. The first Use opens OpenGL.
class SceneRenderer : NonCopyable {
  public:
    /// `scene` and its `system` must outlive the renderer. Throws corda::Error: kUsage for an unknown
    /// backend, kInvalidScene for an invalid size, style or camera.
    SceneRenderer(const Scene& scene, const System& system, const std::string& backend, bool require_gpu);

    /// True if pictures depend on the whole motion: the camera, the supports of pins, or a plot does.
    [[nodiscard]] bool needs_motion() const;
    /// Fits supports, colour scale and camera to the bounds of each particle and the histogram of the
    /// quantity that colours show. Returns the scene's camera with center and height filled in, so that all
    /// is in view.
    CameraDef fit(std::span<const MotionBounds> motion, const sim::Histogram& histogram = {});
    /// The path of the scene's camera, which moves. `camera`: centre and height of one that does not; it gets
    /// the height of one that follows something, unless the scene gives that. `end_s`: end of the motion, at
    /// whose frame times `state_at` is called in order.
    [[nodiscard]] view::CameraTrack track(double end_s,
                                          const std::function<const State&(double time_s)>& state_at,
                                          CameraDef& camera) const;
    /// The extents of arrows up to `end_s`, at whose frame times and arrow_times_s() `state_at` is called in
    /// order.
    [[nodiscard]] view::ArrowExtents arrow_extents(
        double end_s, const std::function<const State&(double time_s)>& state_at) const;
    /// Sets the scale of arrows, before fit().
    void set_arrows(const view::ArrowExtents& extents) {
        view_.set_arrows(extents);
        overlay_.set_arrows(view_.arrows().pixels_per_unit(), extents.longest(), extents.is_cut());
    }
    void set_plots(std::span<const view::PlotData> data) { overlay_.set_plots(data, view_.body_colors()); }
    [[nodiscard]] std::span<const view::PlotPanel> plots() const { return overlay_.plots(); }
    /// Lower bound on the scale of the camera that fit() returns for a motion within `bounds`.
    [[nodiscard]] double largest_pixels_per_metre(const MotionBounds& bounds) const;
    /// The map to pixels of a camera with center and height.
    [[nodiscard]] view::Camera map_of(const CameraDef& camera) const;

    /// Opens OpenGL, and the frame renderer unless only the context is needed, and makes the context current.
    /// Restores the thread's previous context at the end. Uses of several renderers may nest. Throws
    /// corda::Error (kNoGl).
    enum class Needs { kDrawing, kContext };
    class Use {
      public:
        explicit Use(SceneRenderer& renderer, Needs needs = Needs::kDrawing) { renderer.open(needs); }

      private:
        gl::SavedContext saved_;
    };

    /// Takes the canvas of another renderer of this thread, which saves opening OpenGL; may be empty.
    void set_canvas(OwnedCanvas canvas) {
        canvas_ = std::move(canvas);
        has_others_ = canvas_ != nullptr;
    }
    /// Gives the canvas away. The next Use opens OpenGL again.
    [[nodiscard]] OwnedCanvas take_canvas() { return std::move(canvas_); }

    /// See view::SceneView::traced().
    [[nodiscard]] std::vector<std::size_t> traced() const { return view_.traced(); }
    /// Draws a state with its caption and the traces to it; returns what may differ from the last picture.
    /// Throws corda::Error: kNoGl, kInterrupted if cancelled. Requires a Use.
    Damage draw(const State& state, const view::Camera& map, const view::Caption& caption = {},
                const Traces& traces = {});
    /// True if a picture of a state would show only the ground. Draws nothing.
    [[nodiscard]] bool would_show_nothing(const State& state, const view::Camera& map, const Traces& traces);
    /// See Film::mask(). Draws nothing.
    [[nodiscard]] std::vector<std::uint8_t> mask(const State& state, const view::Camera& map);
    /// Starts an exposure; discards an unfinished one. Requires a Use.
    void begin_exposure();
    /// Adds a state to the exposure. Throws as draw().
    void expose(const State& state, const view::Camera& map, const Traces& traces);
    /// Turns the exposure into a picture with a caption; returns what may differ from the last picture.
    Damage develop(const view::Caption& caption, const view::Camera& map);
    /// Draws a list of this renderer's size like draw().
    Damage draw(view::DrawList list);
    /// Adds the places of the labels to a caption.
    void locate_labels(const State& state, const view::Camera& map, view::Caption& caption) const {
        view::locate(overlay_.labels(), state, map, caption);
    }
    /// Adds the overlay to a list, without the lines of draw_curves().
    void annotate(const view::Caption& caption, const view::Camera& map, view::DrawList& list) {
        overlay_.draw(caption, map.pixels_per_metre(), list);
    }
    /// Adds one of several poses to a list; returns the place of its time.
    [[nodiscard]] view::PoseTime add_pose(const State& state, const view::Camera& map, double opacity,
                                          view::DrawList& list) const;
    /// Adds the times of all poses.
    void annotate_poses(std::span<const double> times_s, std::vector<view::PoseTime> poses,
                        view::DrawList& list);
    void draw_curves(double time_s, view::DrawList& list) const { overlay_.draw_curves(time_s, list); }
    [[nodiscard]] const view::SceneView& view() const { return view_; }
    /// The last picture.
    [[nodiscard]] const Image& image() const { return canvas_->renderer->image(); }
    /// True if it shows only the ground.
    [[nodiscard]] bool shows_nothing() const { return shows_nothing_; }
    /// Requires a Use.
    [[nodiscard]] const gl::Context& context() const { return canvas_->context; }

  private:
    /// Height of a picture in which the origin of these bounds of each particle is in the middle of what
    /// panels leave, so that all bodies and arrows are in view.
    [[nodiscard]] double height_about(std::span<const MotionBounds> motion,
                                      const view::ArrowExtents& arrows) const;
    void open(Needs needs);
    /// Fills list_ with a state and its traces, without the caption.
    void list(const State& state, const view::Camera& map, const Traces& traces);
    /// While it lives, the context is current again after check_cancelled(): a callback may leave another
    /// one.
    [[nodiscard]] CancelScope keep_current();
    Damage paint();
    /// Checks the driver's tinted layers if the list is the first one that has some.
    void check_tints();

    const Scene* scene_;
    const System* system_;
    gl::ContextDef gl_;
    view::SceneView view_;
    view::Overlay overlay_;
    view::DrawList list_;
    OwnedCanvas canvas_;
    bool has_others_ = false;  ///< the canvas has the frame renderer of another scene
    bool shows_nothing_ = true;
};

}  // namespace corda::film
