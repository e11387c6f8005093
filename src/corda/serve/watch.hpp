#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/serve/server.hpp"

namespace corda::serve {

/// How a scene is watched.
struct WatchDef {
    std::string path;               ///< of the scene file
    std::vector<Setting> settings;  ///< in the place of values of the file
    /// Of the pictures, which keep the shape of video.size; empty: as the page has room.
    std::optional<int> longest_side_px = {};
    std::size_t picture_bytes = std::size_t{96} << 20U;  ///< room for pictures that are kept
    FilmDef film;                                        ///< how to reach OpenGL
    /// Called on a thread of the watch with the problems that keep it from showing the file, and with none
    /// once it shows the file again; may be empty.
    std::function<void(const std::vector<Problem>&)> on_problems = {};
};

struct WatchState;

/// A scene file as a film that follows the file, for a page of a Server. A thread of its own simulates and
/// draws; a change of the file or of a number interrupts it, and the last good film stays until the next one
/// is there.
class Watch : NonCopyable {
  public:
    /// Begins to load the scene; its errors are shown by the page.
    explicit Watch(WatchDef def);
    ~Watch();

    /// Ends all work, a render as well, and answers the requests that wait. To be called before the server
    /// ends.
    void end();

    /// Loads the scene again, because its file has changed.
    void reload();

    /// Answers a request of the page:
    ///   "", "style.css", "watch.js"       the page
    ///   "state?after=V"                   JSON: film, errors and numbers; status 204 if their version is V
    ///   "frame/K.png?film=N"              frame K of film N, made smaller
    ///   "still/K.png?film=N"              the file that `still --frame K` writes of the scene
    ///   "curves?film=N"                   JSON: angle and energy at the times of frames
    ///   POST "number" {"key", "value"}    another value of a number of the scene; null: that of the file
    ///   POST "write"                      writes the changed numbers to the scene file
    ///   POST "side" {"px", "fits"}        another longest side of the pictures; whether it is the page's room
    ///   POST "render" {"ending", "force"} renders the film beside the scene file; "mp4", "webm", "mov", "gif"
    ///   POST "stop"                       ends that
    [[nodiscard]] Response answer(const Request& request);

  private:
    std::unique_ptr<WatchState> state_;
    std::jthread thread_;
};

}  // namespace corda::serve
