#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/film/film.hpp"
#include "corda/serve/scene_numbers.hpp"
#include "corda/serve/server.hpp"

namespace corda::serve {

/// How a scene is watched.
struct WatchDef {
    std::string path;               ///< of the scene file
    std::vector<Setting> settings;  ///< in the place of values of the file
    int longest_side_px = 640;      ///< of the pictures, which keep the shape of video.size
    std::size_t picture_bytes = std::size_t{96} << 20U;  ///< room for pictures that are kept
    FilmDef film;                                        ///< how to reach OpenGL
};

/// A scene file as a film that follows the file, for a page of a Server. A thread of its own simulates and
/// draws; a change of the file or of a number interrupts it, and the last good film stays until the next one
/// is there.
class Watch : NonCopyable {
  public:
    /// Begins to load the scene; its errors are shown by the page.
    explicit Watch(WatchDef def);
    ~Watch();

    /// Ends all work, and answers the requests that wait. To be called before the server ends.
    void end();

    /// Loads the scene again, because its file has changed.
    void reload();

    /// Answers a request of the page:
    ///   "", "style.css", "watch.js"       the page
    ///   "state?after=V"                   JSON: film, errors and numbers, once their version is not V
    ///   "frame/K.png?film=N"              frame K of film N, with the bytes that `still` writes at that size
    ///   "curves?film=N"                   JSON: angle and energy at the times of frames
    ///   POST "number" {"key", "value"}    another value of a number of the scene; null: that of the file
    ///   POST "write"                      writes the changed numbers to the scene file
    ///   POST "side" {"px"}                another longest side of the pictures
    [[nodiscard]] Response answer(const Request& request);

  private:
    using Json = nlohmann::json;
    struct Picture {
        std::string png;
        std::string error;  ///< in its place
    };

    /// Calls `change` under the lock, and wakes who waits.
    template <class Change>
    void update(const Change& change);
    void work();
    void load();
    void forget_film();
    [[nodiscard]] OnProgress progress();
    void publish(Json film);
    void fail(const std::vector<Problem>& problems);
    void draw(std::int64_t k);
    void read_curves();
    [[nodiscard]] bool is_stale() const;
    [[nodiscard]] std::optional<std::int64_t> next_frame() const;
    [[nodiscard]] bool is_awaited(std::int64_t k) const { return waiting_.contains({film_number_, k}); }
    void keep(std::int64_t k, Picture picture);
    [[nodiscard]] std::int64_t distance(std::int64_t k) const;

    [[nodiscard]] Response state_after(std::int64_t version);
    [[nodiscard]] Response frame(std::int64_t k, std::int64_t film);
    [[nodiscard]] Response curves(std::int64_t film);
    [[nodiscard]] Response change_number(const Json& body);
    [[nodiscard]] Response write_file();

    WatchDef def_;
    std::optional<Film> shown_;  ///< used by the thread alone

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool is_ending_ = false;
    bool is_reload_asked_ = true;
    std::int64_t version_ = 1;  ///< of all below
    bool is_busy_ = true;       ///< the scene is being loaded and simulated
    double progress_ = 0.0;     ///< of that, 0 .. 1
    Json problems_ = Json::array();
    Json film_;  ///< the film that is shown; null before the first one
    std::int64_t film_number_ = 0;
    std::int64_t frames_ = 0;
    std::string text_;  ///< of the file as it was loaded last
    std::vector<SceneNumber> numbers_;
    NumberChanges changes_;
    std::int64_t playhead_ = 0;                                     ///< the frame that was asked for last
    std::multiset<std::pair<std::int64_t, std::int64_t>> waiting_;  ///< film and frame, per request
    std::map<std::int64_t, Picture> pictures_;
    std::size_t picture_bytes_ = 0;
    bool are_curves_wanted_ = false;
    std::optional<std::string> curves_;

    std::jthread thread_;  ///< the last member: it uses the others
};

}  // namespace corda::serve
