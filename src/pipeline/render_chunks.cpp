#include "corda/pipeline/render_chunks.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "corda/core/clock.hpp"
#include "corda/core/ordered_workers.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/pipeline/film_renderer.hpp"

namespace corda::pipeline {
namespace {

/// A chunk as it comes from a thread.
struct Made {
    media::Chunk chunk;
    std::int64_t empty_frames = 0;
    double first_empty_s = 0.0;
    bool is_whole = true;
};

/// Makes the chunks of a film's frames from `from` on.
class ChunkMaker {
  public:
    ChunkMaker(Film& film, const media::VideoWriter& writer, std::int64_t from, std::int64_t end)
        : film_(&film), writer_(&writer), from_(from), end_(end), length_(writer.frames_per_chunk()) {}

    [[nodiscard]] std::int64_t first_chunk() const { return from_ / length_; }
    [[nodiscard]] std::int64_t end_chunk() const { return (end_ + length_ - 1) / length_; }
    /// How many frames were drawn.
    [[nodiscard]] std::int64_t drawn() const { return drawn_; }

    /// For a thread, which gets a renderer of its own.
    [[nodiscard]] OrderedWorkers<Made>::Make maker() {
        const auto renderer = std::make_shared<FilmRenderer>(*film_);
        return [this, renderer](std::int64_t number, const OrderedWorkers<Made>& all) {
            return make(number, all, *renderer);
        };
    }

  private:
    /// A chunk, or the frames of it that were drawn when all were stopped.
    Made make(std::int64_t number, const OrderedWorkers<Made>& all, FilmRenderer& renderer) {
        Made made;
        const OnProgress goes_on = [&all](std::int64_t, std::int64_t) { return !all.is_stopped(); };
        const std::int64_t first = std::max(from_, number * length_);
        const std::int64_t end = std::min(end_, (number + 1) * length_);
        media::ChunkEncoder encoder = writer_->chunk_encoder(first);
        for (std::int64_t k = first; k < end && !all.is_stopped(); ++k) {
            const double time_s = film_->time_s(k);
            try {
                const Damage damage = renderer.draw(time_s, goes_on);
                if (renderer.shows_nothing() && made.empty_frames++ == 0) made.first_empty_s = time_s;
                encoder.encode(renderer.image(), damage, k + 1 == end);
            } catch (const Error& error) {
                if (error.code() != ExitCode::kInterrupted || !all.is_stopped()) throw;
                break;
            }
            ++drawn_;
        }
        made.is_whole = encoder.frames() == end - first;
        // Of chunks that are not the next one nothing is kept.
        if (made.is_whole || number == all.taken()) finish(encoder, all, made);
        return made;
    }

    /// Encodes what the encoder has held back; once all are stopped only for a moment.
    static void finish(media::ChunkEncoder& encoder, const OrderedWorkers<Made>& all, Made& made) {
        std::optional<GoesOn> moment;
        try {
            made.chunk = encoder.finish([&] {
                if (all.is_stopped() && !moment) moment = for_a_moment();
                return !moment || (*moment)();
            });
        } catch (const Error& error) {
            if (error.code() != ExitCode::kInterrupted) throw;
            made.is_whole = false;
        }
    }

    Film* film_;
    const media::VideoWriter* writer_;
    std::int64_t from_;
    std::int64_t end_;
    std::int64_t length_;
    std::atomic<std::int64_t> drawn_ = 0;
};

void add(Made made, media::VideoWriter& writer, Rendered& result) {
    if (made.chunk.frames == 0) return;  // it was not drawn to its end, and is not the next one
    if (made.empty_frames > 0 && result.empty_frames == 0) result.first_empty_s = made.first_empty_s;
    result.empty_frames += made.empty_frames;
    writer.append(std::move(made.chunk));
}

}  // namespace

bool render_chunks(Film& film, std::int64_t from, std::int64_t end, int jobs, const OnProgress& on_progress,
                   media::VideoWriter& writer, Rendered& result) {
    const std::int64_t had = writer.frames();
    ChunkMaker maker(film, writer, from + had, end);
    OrderedWorkers<Made> chunks(maker.first_chunk(), maker.end_chunk(), jobs,
                                [&maker] { return maker.maker(); });
    if (!chunks.has_threads()) return false;
    bool is_adding = false;
    try {
        while (writer.frames() < end - from) {
            if (auto made = chunks.wait()) {
                is_adding = true;
                add(std::move(*made), writer, result);
                is_adding = false;
            }
            report_progress(on_progress, had + maker.drawn(), end - from);
        }
        return true;
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
        chunks.stop();
        bool is_whole = !is_adding;  // nothing goes behind a chunk that broke off
        while (is_whole) {
            auto made = chunks.rest();
            is_whole = made && made->is_whole;
            if (made) add(std::move(*made), writer, result);
        }
        throw;
    }
}

}  // namespace corda::pipeline
