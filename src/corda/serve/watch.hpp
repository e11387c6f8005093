#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "corda/core/file.hpp"
#include "corda/film/film.hpp"
#include "corda/serve/server.hpp"

namespace corda::serve {

/// How a scene is watched.
struct WatchDef {
    std::string path;               ///< of the scene file
    std::vector<Setting> settings;  ///< in the place of values of the file
    int longest_side_px = 640;      ///< of the pictures, which keep the shape of video.size
    std::size_t picture_bytes = std::size_t{96} << 20U;  ///< room for pictures that are kept
    FilmDef film;                                        ///< how to reach OpenGL
    /// Called on a thread of the watch with the problems that keep it from showing the file; may be empty.
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
    std::unique_ptr<WatchState> state_;
    std::jthread thread_;
};

/// Notices changes of a file, also by programs that put another file in its place.
class FileWatch {
  public:
    /// Throws corda::Error: kTemporary if the system watches no more files, kIo if there is no such folder.
    explicit FileWatch(const std::string& path);

    /// Waits up to `timeout_ms` for a change of the folder. Whether the file has changed, its time, size and
    /// number tell, also on file systems of other machines, which report nothing.
    [[nodiscard]] bool wait(int timeout_ms);

  private:
    struct Stamp {
        long long seconds = 0;
        long long nanoseconds = 0;
        long long bytes = -1;  ///< -1: there is no file
        unsigned long long number = 0;

        friend bool operator==(const Stamp&, const Stamp&) = default;
    };
    [[nodiscard]] Stamp stamp() const;

    std::string path_;
    Descriptor inotify_;
    Stamp last_;
};

}  // namespace corda::serve
