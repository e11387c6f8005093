#include "corda/pipeline/render_chunks.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "corda/media/chunk.hpp"
#include "corda/pipeline/painter.hpp"

namespace corda::pipeline {
namespace {

/// A chunk as it comes from a thread.
struct Made {
    media::Chunk chunk;
    std::int64_t empty_frames = 0;
    double first_empty_s = 0.0;
    bool is_whole = true;
};

/// The chunks of some frames, from whoever makes them to the one who writes them in order.
class Chunks {
  public:
    Chunks(const Film& film, const media::VideoWriter& writer, std::int64_t from, std::int64_t end, int jobs)
        : film_(&film),
          writer_(&writer),
          from_(from),
          end_(end),
          length_(writer.frames_per_chunk()),
          next_(from / length_),
          written_(next_),
          ahead_(2 * static_cast<std::int64_t>(jobs)) {
        try {
            for (int i = 0; i < jobs; ++i) threads_.emplace_back([this] { work(); });
        } catch (const std::system_error&) {  // fewer will do
            if (threads_.empty())
                throw Error(ExitCode::kTemporary,
                            "the system starts no thread; make one chunk at a time (jobs 1)");
        }
    }
    Chunks(const Chunks&) = delete;
    Chunks& operator=(const Chunks&) = delete;
    ~Chunks() {
        stop();
        for (std::thread& thread : threads_) thread.join();
    }

    /// The next chunk in order; std::nullopt if it is not there after a moment.
    std::optional<Made> wait() {
        constexpr std::chrono::milliseconds kMoment{50};
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kMoment, [this] { return is_ready(); });
        if (!is_ready()) return std::nullopt;
        if (const auto failed = failures_.find(written_); failed != failures_.end())
            std::rethrow_exception(failed->second);
        auto node = made_.extract(written_++);
        changed_.notify_all();
        return std::move(node.mapped());
    }

    /// Makes the threads end: each with the frames of its chunk that it has drawn.
    void stop() {
        const std::lock_guard lock(mutex_);
        is_stopped_ = true;
        changed_.notify_all();
    }

    /// After stop(): the next chunk in order, as far as it got; std::nullopt if there is none.
    std::optional<Made> rest() {
        for (std::thread& thread : threads_) thread.join();
        threads_.clear();
        auto node = made_.extract(written_++);
        return node.empty() ? std::nullopt : std::optional(std::move(node.mapped()));
    }

    [[nodiscard]] std::int64_t drawn() const { return drawn_; }

  private:
    [[nodiscard]] bool is_ready() const { return made_.contains(written_) || failures_.contains(written_); }

    /// The next chunk to make, once it is not too far ahead; std::nullopt at the end.
    std::optional<std::int64_t> take() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return is_stopped_ || next_ < written_ + ahead_; });
        if (is_stopped_ || next_ * length_ >= end_) return std::nullopt;
        return next_++;
    }

    void work() {
        std::optional<FilmPainter> painter;
        while (const auto number = take()) {
            Made made;
            std::exception_ptr failure;
            try {
                if (!painter) {
                    const std::lock_guard lock(making_);
                    painter.emplace(*film_, FilmPainter::Apart{});
                }
                made = make(*number, *painter);
            } catch (...) {
                failure = std::current_exception();
            }
            const std::lock_guard lock(mutex_);
            if (failure)
                failures_.emplace(*number, failure);
            else
                made_.emplace(*number, std::move(made));
            changed_.notify_all();
        }
    }

    Made make(std::int64_t number, FilmPainter& painter) {
        Made made;
        const OnProgress goes_on = [this](std::int64_t, std::int64_t) { return !is_stopped_; };
        const std::int64_t first = std::max(from_, number * length_);
        const std::int64_t end = std::min(end_, (number + 1) * length_);
        media::ChunkEncoder encoder = writer_->chunk_encoder(first);
        for (std::int64_t k = first; k < end && !is_stopped_; ++k) {
            const double time_s = film_->time_s(k);
            try {
                const Damage damage = painter.draw(time_s, goes_on);
                if (painter.shows_nothing() && made.empty_frames++ == 0) made.first_empty_s = time_s;
                encoder.encode(painter.image(), damage, k + 1 == end);
            } catch (const Error& error) {
                if (error.code() != ExitCode::kInterrupted || !is_stopped_) throw;
                break;
            }
            ++drawn_;
        }
        made.is_whole = encoder.frames() == end - first;
        if (made.is_whole || number == written_) made.chunk = encoder.finish();  // of others nothing is kept
        return made;
    }

    const Film* film_;
    const media::VideoWriter* writer_;
    std::int64_t from_;
    std::int64_t end_;
    std::int64_t length_;
    std::mutex making_;  ///< of painters, one by one
    std::mutex mutex_;   ///< of what follows
    std::condition_variable changed_;
    std::int64_t next_;                  ///< to be made
    std::atomic<std::int64_t> written_;  ///< all before this one
    std::int64_t ahead_;                 ///< how many may be made or waiting at a time
    std::map<std::int64_t, Made> made_;
    std::map<std::int64_t, std::exception_ptr> failures_;
    std::atomic<std::int64_t> drawn_ = 0;
    std::atomic<bool> is_stopped_ = false;
    std::vector<std::thread> threads_;
};

void add(Made made, media::VideoWriter& writer, Rendered& result) {
    if (made.empty_frames > 0 && result.empty_frames == 0) result.first_empty_s = made.first_empty_s;
    result.empty_frames += made.empty_frames;
    writer.append(std::move(made.chunk));
}

}  // namespace

void render_chunks(const Film& film, std::int64_t from, std::int64_t end, int jobs,
                   const OnProgress& on_progress, media::VideoWriter& writer, Rendered& result) {
    const std::int64_t had = writer.frames();
    Chunks chunks(film, writer, from + had, end, jobs);
    try {
        while (writer.frames() < end - from) {
            if (auto made = chunks.wait()) add(std::move(*made), writer, result);
            report_progress(on_progress, had + chunks.drawn(), end - from);
        }
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
        chunks.stop();
        bool is_whole = true;
        while (is_whole) {
            auto made = chunks.rest();
            is_whole = made && made->is_whole;
            if (made) add(std::move(*made), writer, result);
        }
        throw;
    }
}

}  // namespace corda::pipeline
