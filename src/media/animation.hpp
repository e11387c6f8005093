#pragma once

#include <cstdint>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/rational.hpp"
#include "corda/media/format.hpp"

namespace corda::media {

/// Refuses an animation of one frame that would be a picture. Throws corda::Error (kUsage).
void check_animation_frames(const Ending& ending, std::int64_t frames);

/// Makes an animation of the first `frames` pictures of a part, which are exact: their colours and changes
/// are known only when all are there. One picture is in memory at a time, and of a .webp what is encoded.
/// Throws corda::Error: kIo, kEncoder, kInterrupted if `on_progress` asks to stop.
void write_animation(const std::string& part_path, const Ending& ending, Rational fps, std::int64_t frames,
                     const OnProgress& on_progress, OutputFile& output);

/// As write_animation, of a .webp: lossless, each frame as the rectangle that has changed.
void write_webp(const std::string& part_path, Rational fps, std::int64_t frames,
                const OnProgress& on_progress, OutputFile& output);

}  // namespace corda::media
