#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "benchmark/study/times.hpp"
#include "corda/film/film.hpp"
#include "corda/scene/scene.hpp"

namespace corda::benchmark {

/// Renders to measure.
struct BenchDef {
    Scene scene;                ///< with the size and the preset of a case
    FilmDef film;               ///< which OpenGL draws
    std::int64_t frames = 600;  ///< of each video, if the scene has as many; >= 1
    int repeats = 3;            ///< of each measurement, in turn; >= 1
};

/// A part of the work on a video, measured by itself in one thread: simulate, open OpenGL, draw, convert (to
/// 4:2:0), encode, end and check.
struct Stage {
    std::string name;
    double wall_s = 0.0;
    double cpu_s = 0.0;  ///< of all threads
};

/// Figures of videos of one size and preset.
struct Measured {
    std::int64_t frames = 0;
    study::Times render_s;         ///< from the scene to the checked file
    study::Times encoder_s;        ///< x264 alone, from memory, with a thread per core
    study::Times ratio;            ///< of each render to the encoder that ran after it
    std::int64_t pictures = 0;     ///< different ones that x264 alone encodes, there and back
    double peak_rss_mib = 0.0;     ///< of a render
    double encoder_rss_mib = 0.0;  ///< that one encoder of one thread takes
    std::vector<Stage> stages;
};

/// Renders and encodes in child processes, one after the other, so that each has its own peak of memory. This
/// process must have no other thread, and no OpenGL. Throws corda::Error: what a render throws; kTemporary if
/// a child cannot be started or is ended from outside.
[[nodiscard]] Measured measure(const BenchDef& def);

/// The result of `work` from a child process, which has a peak of memory of its own. Throws corda::Error:
/// what `work` throws; kTemporary if the child cannot be started or is ended from outside.
[[nodiscard]] nlohmann::json in_child(const std::function<nlohmann::json()>& work);

}  // namespace corda::benchmark
