#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/scene_renderer.hpp"

namespace corda {
namespace film {

/// Per-thread drawing state.
struct DrawContext {
    DrawContext(const Scene& scene, const System& system, const FilmDef& def)
        : renderer(scene, system, def.backend, def.require_gpu),
          trails(renderer.traced(), scene.style.trail_s, scene.video.scene_rate()) {}

    SceneRenderer renderer;
    TrailRecorder trails;
    State state;
    Figures figures;               ///< of the state
    std::optional<Energy> energy;  ///< of the state, if it is shown in place of the energy error
};

}  // namespace film

/// Draws the frames of a film without copying them, with an OpenGL context of its own, which is current on
/// its thread as long as it lives; afterwards the previous one is current again. Several threads may make and
/// use renderers of one film, each its own, as long as none uses the film itself.
class FilmRenderer : NonCopyable {
  public:
    /// `canvas`: keeps the OpenGL canvas of this thread for the next renderer. This renderer takes it, or
    /// opens one if there is none, and puts it back when it dies. Null: none is kept. Throws corda::Error:
    /// kNoGl, and what Film::camera() throws.
    explicit FilmRenderer(Film& film, film::OwnedCanvas* canvas = nullptr);
    ~FilmRenderer();

    /// Draws the frame at a time; returns what may differ from the last one. Throws as Film::still().
    Damage draw(double time_s);
    /// The last frame.
    [[nodiscard]] const Image& image() const { return context_->renderer.image(); }
    /// True if the last frame was empty.
    [[nodiscard]] bool shows_nothing() const { return context_->renderer.shows_nothing(); }

    // What rooms above need of a film beyond its public interface. None may be called while another thread
    // uses the film.

    /// True if frames before `end` can be drawn in any order without another simulation. Simulates the motion
    /// as far as they need it.
    [[nodiscard]] static bool can_draw_in_any_order(Film& film, std::int64_t end);
    /// The poses at one or more times in one picture: earlier ones fainter, the last one opaque and on top.
    /// Needs no OpenGL. Throws corda::Error as Film::state_at(), and kUsage for poses with too many
    /// lines in total.
    [[nodiscard]] static view::DrawList list_poses(Film& film, std::span<const double> times_s);
    /// Draws list_poses() with the film's own context.
    [[nodiscard]] static Image draw_poses(Film& film, std::span<const double> times_s);
    /// The same motion in pictures of another size, style or overlay, without a plot and without another
    /// simulation. `look` has the bodies and the world of the film's scene. Throws corda::Error (kInternal)
    /// for another colouring, other arrows, a longer trail or a plot.
    [[nodiscard]] static Film another_look(const Film& film, const Scene& look);
    /// Reads the states at these increasing times in at most one simulation and keeps them whatever the
    /// memory budget is. Throws as Film::state_at().
    static void keep(Film& film, std::span<const double> times_s);
    /// True if the frame at a time would be empty. Needs no OpenGL. Throws as Film::state_at().
    [[nodiscard]] static bool is_empty(Film& film, double time_s);

    /// The motion, for a SharedMotion::Activity.
    [[nodiscard]] static film::SharedMotion& motion_of(Film& film);

  private:
    Film* film_;
    film::OwnedCanvas* lent_;
    std::unique_ptr<film::DrawContext> context_;
    film::SceneRenderer::Use use_;
};

/// The files that render_video() would write of a whole film under `name`, in memory: one video, or a picture
/// per frame. Throws corda::Error as it does.
[[nodiscard]] std::vector<std::string> video_files(Film& film, FilmRenderer& renderer,
                                                   const std::string& name);

}  // namespace corda
