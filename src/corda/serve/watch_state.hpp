// State that the thread of a Watch shares with the threads of requests.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/serve/film_render.hpp"
#include "corda/serve/picture_queue.hpp"
#include "corda/serve/scene_numbers.hpp"
#include "corda/serve/watch.hpp"

namespace corda::serve {

/// A film as requests see it. A film that takes its place is another object.
struct ShownFilm {
    std::int64_t number;
    Film film;             ///< in the size of the scene
    nlohmann::json words;  ///< what the page says of it
    PictureQueue pictures;
    int width_px = 0;  ///< of the pictures
    int height_px = 0;
    bool are_curves_wanted = false;
    std::optional<std::string> curves = {};
};

inline constexpr int kFirstSidePx = 960;  // until the page says what room it has

/// The film that is shown, and what there is to do.
struct WatchState {
    explicit WatchState(WatchDef its)
        : def(std::move(its)),
          side_px(def.longest_side_px.value_or(kFirstSidePx)),
          fits(!def.longest_side_px) {}

    std::mutex mutex;  ///< of all below
    std::condition_variable changed;
    WatchDef def;
    int side_px;  ///< longest side of the pictures
    bool fits;    ///< it follows the room that the page has
    bool is_ending = false;
    bool is_reload_asked = true;
    /// Changes with all below. It starts from the clock, so that a page notices another program at its
    /// address.
    std::int64_t version = std::chrono::duration_cast<std::chrono::milliseconds>(
                               std::chrono::system_clock::now().time_since_epoch())
                               .count();
    bool is_busy = true;    ///< the scene is being loaded and simulated
    double progress = 0.0;  ///< of that, 0 .. 1
    std::vector<Problem> problems;
    std::string text;  ///< of the file as it was loaded last
    std::vector<SceneNumber> numbers;
    NumberChanges changes;
    std::int64_t films = version;     ///< number of the last film
    std::shared_ptr<ShownFilm> film;  ///< the last good one; null before the first
    FilmRender render{[this] {
        {
            const std::lock_guard lock(mutex);
            ++version;
        }
        changed.notify_all();
    }};
};

/// Calls `change` under the lock, and wakes who waits.
template <class Change>
void update(WatchState& state, const Change& change) {
    {
        const std::lock_guard lock(state.mutex);
        change();
    }
    state.changed.notify_all();
}

/// A film, and what the page says of it, to take the place of the last one. The lock is held.
std::shared_ptr<ShownFilm> next_film(WatchState& state, const Film& film, const nlohmann::json& words);

/// The thread of a watch: loads the scene, draws frames and reads curves until the state is ending.
void work(WatchState& state);

}  // namespace corda::serve
