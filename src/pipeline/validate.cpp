#include "corda/pipeline/validate.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/timeline.hpp"
#include "corda/scene/schema.hpp"

namespace corda::pipeline {
namespace {

void validate_frame_rate(const Scene& scene) {
    const Rational fps = scene.video.fps.rational();
    if (fps.is_rate()) return;
    throw Error(ExitCode::kInvalidScene,
                fmt::format("video.fps: {}/{} is not a fraction of integers within 1 .. {}", fps.num, fps.den,
                            Rational::kMaxPart));
}

void validate_frames(const Scene& scene) {
    const Rational fps = scene.video.fps.rational();
    const double frames = scene.world.duration_s * scene.video.fps.per_second();
    constexpr auto kMost = static_cast<double>(scene::Limits::kFrames);
    if (frames <= kMost && scene.video.fps.frame_count(scene.world.duration_s) >= 1) return;
    throw Error(ExitCode::kInvalidScene,
                fmt::format("world.duration: {:g} s at {} frames per second are {:g} frames; give 1 .. {}",
                            scene.world.duration_s, fps.text(), frames, scene::Limits::kFrames));
}

}  // namespace

std::int64_t last_frame_of(const Scene& scene) {
    return scene.video.fps.last_frame_within(scene.world.duration_s);
}

std::optional<double> motion_time_s(const Scene& scene, double time_s) {
    const double last_s = scene.video.fps.time_s(last_frame_of(scene));
    return time_within(time_s, std::max(scene.world.duration_s, last_s));
}

void validate(const Scene& scene, std::span<const double> stills_s) {
    validate_frame_rate(scene);
    check_definitions(scene);
    validate_frames(scene);
    static_cast<void>(solvers_of(scene));
    for (const double time_s : stills_s) {
        if (motion_time_s(scene, time_s)) continue;
        throw Error(ExitCode::kUsage,
                    fmt::format("stills_s: {} s is not within 0 .. {} s", time_s, scene.world.duration_s));
    }
}

}  // namespace corda::pipeline
