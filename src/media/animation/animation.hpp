#pragma once

#include <cstdint>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/rational.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Pictures of which an animation is made.
struct AnimationDef {
    std::string part_path;    ///< they are exact
    std::uint64_t bytes = 0;  ///< number of its first bytes to read
    std::int64_t frames = 0;  ///< number of its first pictures
    Rational fps;
    int threads = 1;  ///< change the time that it takes, and no byte
};

/// Refuses an animation of one frame that would be a picture. Throws corda::Error (kUsage).
void check_animation_frames(const Ending& ending, std::int64_t frames);

/// Makes an animation of an ending. A few pictures per thread are in memory at a time, and of a .webp what is
/// encoded. Throws corda::Error: kIo, kEncoder, kInterrupted if `on_progress` asks to stop.
void write_animation(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                     OutputFile& output);

// As write_animation, of one format: Codec::write.

/// One palette for all frames; each frame holds the pixels that changed.
void write_gif(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
               OutputFile& output);
/// Lossless, with all levels of transparency; each frame is the rectangle that has changed. (libavcodec's
/// encoder tries all ways to lay a frame over the last one, in four times the time for more bytes.)
void write_apng(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                OutputFile& output);
/// The same.
void write_webp(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                OutputFile& output);

}  // namespace corda::media
