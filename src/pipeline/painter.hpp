#pragma once

#include <span>

#include "corda/pipeline/film.hpp"
#include "corda/pipeline/stage.hpp"

namespace corda {

/// Draws a film's frames one after the other without copying them, for a caller that encodes them. The film's
/// context is current on this thread for as long as it lives; afterwards, the one before is again.
class FilmPainter {
  public:
    /// Throws corda::Error (kNoGl).
    explicit FilmPainter(const Film& film);
    FilmPainter(const FilmPainter&) = delete;
    FilmPainter& operator=(const FilmPainter&) = delete;
    ~FilmPainter() = default;

    /// Draws the picture at a time; returns what may differ from the last one that this painter drew: all,
    /// if somebody else has drawn the film since. Asks `on_progress` as Film::still().
    Damage draw(double time_s, const OnProgress& on_progress = {});
    /// Draws a list of the film's size.
    void draw(view::DrawList list, const OnProgress& on_progress = {});
    /// The poses at some times, at least one, in one picture: the fainter the earlier, the last on top in
    /// full. Needs no OpenGL. Asks `on_progress` at each. Throws corda::Error as Film::state_at(),
    /// kInterrupted, and kUsage for several poses of more lines than memory is meant for.
    [[nodiscard]] static view::DrawList poses(const Film& film, std::span<const double> times_s,
                                              const OnProgress& on_progress = {});
    /// The last picture of the film.
    [[nodiscard]] const Image& image() const;

  private:
    const Film* film_;
    pipeline::Stage::Use use_;
    std::int64_t pictures_ = -1;  ///< the stage's count after the last draw
};

}  // namespace corda
