#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "corda/pipeline/film.hpp"
#include "corda/pipeline/scene_renderer.hpp"

namespace corda {
namespace pipeline {
struct DrawContext;
}

/// Draws a film's frames one after the other without copying them, for a caller that encodes them. A context
/// is current on this thread for as long as it lives; afterwards, the one before is again.
class FilmRenderer {
  public:
    /// Draws with the film's own context. Throws corda::Error (kNoGl).
    explicit FilmRenderer(const Film& film);
    /// Draws with an OpenGL context of its own, so that several renderers of a film can draw side by side,
    /// each in the thread that made it. Make them one at a time. Throws corda::Error (kNoGl).
    struct OwnContext {};
    FilmRenderer(const Film& film, OwnContext);
    FilmRenderer(const FilmRenderer&) = delete;
    FilmRenderer& operator=(const FilmRenderer&) = delete;
    ~FilmRenderer();

    /// True if frames before `end` can be drawn in any order without being simulated again. Simulates what
    /// has not been yet.
    [[nodiscard]] static bool can_draw_in_any_order(const Film& film, std::int64_t end);

    /// Draws the picture at a time; returns what may differ from the last one that this renderer drew: all,
    /// if somebody else has drawn the film since. Asks `on_progress` as Film::still().
    Damage draw(double time_s, const OnProgress& on_progress = {});
    /// Draws a list of the film's size.
    void draw(view::DrawList list, const OnProgress& on_progress = {});
    /// The poses at some times, at least one, in one picture: earlier ones fainter, the last on top in
    /// full. Needs no OpenGL. Asks `on_progress` at each. Throws corda::Error as Film::state_at(),
    /// kInterrupted, and kUsage for several poses of more lines than memory is meant for.
    [[nodiscard]] static view::DrawList poses(const Film& film, std::span<const double> times_s,
                                              const OnProgress& on_progress = {});
    /// The same motion in pictures of another size, style or overlay, without a plot: nothing is simulated
    /// again. `look` has the bodies, the world and the colouring of the film's scene. Not to be used while
    /// the film is by another thread. Throws corda::Error (kInternal) for another colouring or a plot.
    [[nodiscard]] static Film another_look(const Film& film, const Scene& look);
    /// Reads the states at these times, in order and at most one pass over the motion, and keeps them: what
    /// is beyond the film's memory budget is not simulated for each picture. Throws as Film::state_at().
    static void keep(const Film& film, std::span<const double> times_s);
    /// Whether the frame at a time would show nothing. Draws nothing and needs no OpenGL. Must not be called
    /// while another thread uses the film. Throws as Film::state_at().
    [[nodiscard]] static bool is_empty(const Film& film, double time_s);
    /// The last picture.
    [[nodiscard]] const Image& image() const;
    /// True if the last picture was empty.
    [[nodiscard]] bool shows_nothing() const;

  private:
    const Film* film_;
    std::unique_ptr<pipeline::DrawContext> own_;
    pipeline::DrawContext* drawing_;
    pipeline::SceneRenderer::Use use_;
    CameraDef camera_;
    std::int64_t pictures_ = -1;  ///< the renderer's count after the last draw
};

}  // namespace corda
