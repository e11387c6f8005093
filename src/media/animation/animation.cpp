#include "corda/media/animation/animation.hpp"

#include <fmt/format.h>

#include <string_view>

namespace corda::media {

void check_animation_frames(const Ending& ending, std::int64_t frames) {
    if (frames != 1 || std::string_view(ending.muxer) != "webp") return;
    throw Error(ExitCode::kUsage,
                fmt::format("{} holds one frame as a picture, which has no duration; use .apng, or .png "
                            "(corda still)",
                            ending.words));
}

void write_animation(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                     OutputFile& output) {
    check_animation_frames(ending, def.frames);
    const std::string_view muxer = ending.muxer;
    if (muxer == "webp") return write_webp(def, on_progress, output);
    if (muxer == "apng") return write_apng(def, on_progress, output);
    write_gif(ending, def, on_progress, output);
}

}  // namespace corda::media
