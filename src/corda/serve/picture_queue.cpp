#include "corda/serve/picture_queue.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace corda::serve {

PictureQueue::PictureQueue(std::int64_t frames, std::size_t max_bytes, std::int64_t playhead)
    : frames_(frames), max_bytes_(max_bytes), playhead_(std::clamp<std::int64_t>(playhead, 0, frames - 1)) {}

const Picture* PictureQueue::find(std::int64_t k) const {
    const auto found = pictures_.find(k);
    return found == pictures_.end() ? nullptr : &found->second;
}

void PictureQueue::await(std::int64_t k) {
    playhead_ = k;
    waiting_.insert(k);
}

/// How many frames the film plays from the playhead to frame `k`.
std::int64_t PictureQueue::distance(std::int64_t k) const {
    return k >= playhead_ ? k - playhead_ : k - playhead_ + frames_;
}

std::optional<std::int64_t> PictureQueue::next() const {
    if (is_awaited(playhead_) && !pictures_.contains(playhead_)) return playhead_;
    const auto is_missing = [&](std::int64_t k) { return !pictures_.contains(k); };
    if (const auto found = std::ranges::find_if(waiting_, is_missing); found != waiting_.end()) return *found;
    if (std::ssize(pictures_) >= frames_) return std::nullopt;
    std::int64_t ahead = 0;
    while (pictures_.contains((playhead_ + ahead) % frames_)) ++ahead;
    const auto is_farther = [&](const auto& entry) { return distance(entry.first) > ahead; };
    // Half of the room, so that a frame that is drawn ahead is not itself the first one to go.
    const bool has_room = bytes_ < max_bytes_ / 2 || std::ranges::any_of(pictures_, is_farther);
    return has_room ? std::optional((playhead_ + ahead) % frames_) : std::nullopt;
}

void PictureQueue::keep(std::int64_t k, Picture picture) {
    bytes_ += picture.png.size();
    pictures_.insert_or_assign(k, std::move(picture));
    const auto rank = [&](const auto& entry) { return is_awaited(entry.first) ? -1 : distance(entry.first); };
    while (bytes_ > max_bytes_ && pictures_.size() > 1) {
        const auto last = std::ranges::max_element(pictures_, {}, rank);
        if (is_awaited(last->first)) break;
        bytes_ -= last->second.png.size();
        pictures_.erase(last);
    }
}

}  // namespace corda::serve
