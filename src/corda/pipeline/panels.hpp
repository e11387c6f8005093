#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/pipeline/film_renderer.hpp"

namespace corda::pipeline {

/// Objects that are destroyed in the reverse order of their making.
template <class T>
struct Nested : std::deque<T>, NonCopyable {
    ~Nested() {
        while (!this->empty()) this->pop_back();
    }
};

/// True if the grounds of all scenes are opaque.
[[nodiscard]] bool are_opaque(std::span<const Scene> scenes);

/// Films side by side in one film, row by row; of a single film, that film. Frame k shows frame k of each, or
/// its last one.
struct Panels {
    /// The films must outlive this. Throws as panels_video().
    Panels(std::span<Film> films, int columns);

    [[nodiscard]] static double shown_s(const Film& film, std::int64_t k) {
        return film.time_s(std::min(k, film.frame_count() - 1));
    }
    /// The time of frame `k` in the first scene, which may have ended.
    [[nodiscard]] double time_s(std::int64_t k) const { return video.scene_rate().time_s(k); }
    /// See FilmRenderer.
    [[nodiscard]] bool can_draw_in_any_order(std::int64_t end) const;
    /// True if a panel of frame `k` would be empty.
    [[nodiscard]] bool have_empty(std::int64_t k) const;

    std::span<Film> films;
    std::vector<Scene> scenes;
    int columns;
    VideoDef video;
};

/// Draws the frames of panels; see FilmRenderer for contexts and threads.
class PanelRenderer {
  public:
    explicit PanelRenderer(const Panels& panels);

    /// Draws frame `k`; returns what may differ from the last one. Throws as Film::still().
    Damage draw(std::int64_t k);
    [[nodiscard]] const Image& image() const;
    /// True if a panel of the last frame was empty.
    [[nodiscard]] bool shows_nothing() const;

  private:
    const Panels* panels_;
    Nested<FilmRenderer> renderers_;
    Image image_;  ///< of several panels
};

}  // namespace corda::pipeline
