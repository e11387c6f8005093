// The stages of a video of examples/swing.toml at its own size, apart and together: drawing alone, of several
// looks, encoding the same frames from memory, and both. The figure to watch is the ratio of the last two,
// taken in one run.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <vector>

#include "corda/media/video_writer.hpp"
#include "corda/pipeline/painter.hpp"

namespace corda {
namespace {

constexpr int kFrames = 150;  // 2.5 s at 60 frames per second: 1.2 GB of pictures

Scene load_example() {
    return load_scene(CORDA_EXAMPLES "/swing.toml");
}

std::string output_path() {
    return (std::filesystem::temp_directory_path() / "corda-benchmark.mp4").string();
}

void count_frames(benchmark::State& bench) {
    bench.counters["frames/s"] =
        benchmark::Counter(static_cast<double>(bench.iterations() * kFrames), benchmark::Counter::kIsRate);
}

/// Draws the first frames one after the other.
template <class Use>
void draw_frames(Film& film, const Use& use) {
    FilmPainter painter(film);
    for (int k = 0; k < kFrames; ++k) {
        const Damage damage = painter.draw(film.time_s(k));
        use(painter.image(), damage);
    }
}

/// A look, as settings of the scene.
using Look = std::vector<Setting>;
const Look kDefault{"style.trail_s=0"};
const Look kPlain{"style.trail_s=0",        "style.background=#0e1320", "style.payload=false",
                  "style.supports=false",   "style.halo=false",         "overlay.time=false",
                  "overlay.scale_bar=false"};
const Look kOverlays{"style.trail_s=0", "overlay.title=A swing", "overlay.energy=true",
                     "overlay.method=true"};
const Look kPlot{"style.trail_s=0", "overlay.plot=energy"};
const Look kTrail;
const Look kBlur8{"style.trail_s=0", "video.shutter=0.5", "video.subframes=8"};
const Look kBlur16{"style.trail_s=0", "video.shutter=0.5", "video.subframes=16"};

/// Drawing alone: the motion is there.
void draw(benchmark::State& bench, const Look& look) {
    Film film(load_scene(CORDA_EXAMPLES "/swing.toml", look));
    static_cast<void>(film.camera());
    for (auto _ : bench) draw_frames(film, [](const Image&, const Damage&) {});
    count_frames(bench);
}

void encode(benchmark::State& bench) {
    Film film(load_example());
    std::vector<Image> frames;
    std::vector<Damage> damages;
    draw_frames(film, [&](const Image& image, const Damage& damage) {
        frames.push_back(image);
        damages.push_back(damage);
    });
    for (auto _ : bench) {
        media::VideoWriter writer(output_path(), film.scene().video, {}, {.force = true});
        for (int k = 0; k < kFrames; ++k) writer.write(frames[k], damages[k]);
        writer.finish();
    }
    count_frames(bench);
}

void draw_and_encode(benchmark::State& bench) {
    for (auto _ : bench) {
        Film film(load_example());
        media::VideoWriter writer(output_path(), film.scene().video, {}, {.force = true});
        draw_frames(film, [&](const Image& image, const Damage& damage) { writer.write(image, damage); });
        writer.finish();
    }
    count_frames(bench);
}

BENCHMARK_CAPTURE(draw, plain, kPlain)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, default_look, kDefault)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, overlays, kOverlays)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, trail, kTrail)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, plot, kPlot)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, blur_8, kBlur8)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, blur_16, kBlur16)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(encode)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(draw_and_encode)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace corda

BENCHMARK_MAIN();
