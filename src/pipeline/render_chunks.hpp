#pragma once

#include <cstdint>

#include "corda/media/chunks/video_writer.hpp"
#include "corda/pipeline/film.hpp"

namespace corda::pipeline {

/// Draws and encodes the frames of a film from the end of what `writer` has up to `end`, in chunks, several
/// at a time, each by a thread of its own. `from` is the film's number of the writer's first frame. The
/// frames have the bytes that FilmRenderer and VideoWriter::write() give. `result` counts the empty ones.
///
/// `on_progress` is called by this thread alone, with the number of frames drawn. Requires
/// FilmRenderer::can_draw_in_any_order(film, end). Throws corda::Error: kEncoder, kNoGl, kIo, and
/// kInterrupted if asked to stop; then the writer has the frames before the first that was not drawn. Returns
/// false, with nothing done, if the system starts no thread.
[[nodiscard]] bool render_chunks(Film& film, std::int64_t from, std::int64_t end, int jobs,
                                 const OnProgress& on_progress, media::VideoWriter& writer, Rendered& result);

}  // namespace corda::pipeline
