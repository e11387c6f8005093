// Drawing frames of examples/swing.toml in several styles. Whole renders beside x264 alone: run.sh video.

#include <benchmark/benchmark.h>

#include <vector>

#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"

namespace corda {
namespace {

constexpr int kFrames = 150;  // 2.5 s at 60 frames per second

void count_frames(benchmark::State& bench) {
    bench.counters["frames/s"] =
        benchmark::Counter(static_cast<double>(bench.iterations() * kFrames), benchmark::Counter::kIsRate);
}

/// Draws the first frames one after the other.
template <class Use>
void draw_frames(const Film& film, const Use& use) {
    const render::CanvasUse canvas(film.context_def());
    for (int k = 0; k < kFrames; ++k) {
        const Damage damage =
            film::paint(film.look(), film.motion(), film.time_s(k), film.scene().video.shutter, *canvas)
                .damage;
        use(canvas->image(), damage);
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
const Look kPlot{"style.trail_s=0", "overlay.plots=[\"energy\"]"};
const Look kTrail;
const Look kBlur8{"style.trail_s=0", "video.shutter=0.5", "video.subframes=8"};
const Look kBlur16{"style.trail_s=0", "video.shutter=0.5", "video.subframes=16"};

/// Drawing alone: the motion is there.
void draw(benchmark::State& bench, const Look& look) {
    const Film film(load_scene(CORDA_EXAMPLES "/swing.toml", look));
    for (auto _ : bench) draw_frames(film, [](const Image&, const Damage&) {});
    count_frames(bench);
}

BENCHMARK_CAPTURE(draw, plain, kPlain)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, default_look, kDefault)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, overlays, kOverlays)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, trail, kTrail)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, plot, kPlot)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, blur_8, kBlur8)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, blur_16, kBlur16)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace corda

BENCHMARK_MAIN();
