#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace corda::serve {

/// A frame as a PNG, or why there is none.
struct Picture {
    std::string png;
    std::string error;
};

/// The pictures of a film that are kept, and which one is drawn next. One thread at a time uses it.
class PictureQueue {
  public:
    /// `frames`: length of the film. `max_bytes`: room for pictures. `playhead`: the frame that is shown.
    PictureQueue(std::int64_t frames, std::size_t max_bytes, std::int64_t playhead);

    [[nodiscard]] std::int64_t frames() const { return frames_; }
    [[nodiscard]] std::int64_t playhead() const { return playhead_; }
    /// The picture of frame `k`; null if it is not kept.
    [[nodiscard]] const Picture* find(std::int64_t k) const;

    /// A request begins to wait for frame `k`, which is the playhead from then on.
    void await(std::int64_t k);
    /// It waits no longer.
    void leave(std::int64_t k) { waiting_.erase(waiting_.find(k)); }
    [[nodiscard]] bool is_awaited(std::int64_t k) const { return waiting_.contains(k); }

    /// The frame to draw next: one that is awaited, or the next one after the playhead while there is room.
    [[nodiscard]] std::optional<std::int64_t> next() const;
    /// Keeps a picture. Those that are played last go if there is no room; one that is awaited stays.
    void keep(std::int64_t k, Picture picture);

  private:
    [[nodiscard]] std::int64_t distance(std::int64_t k) const;

    std::int64_t frames_;
    std::size_t max_bytes_;
    std::int64_t playhead_;
    std::multiset<std::int64_t> waiting_;  ///< a frame per request
    std::map<std::int64_t, Picture> pictures_;
    std::size_t bytes_ = 0;
};

}  // namespace corda::serve
