// Clips of a sweep of 60 frames with all labels: one after the other, by stages, and a whole sweep.

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "corda/pipeline/film_renderer.hpp"
#include "corda/sweep/archive.hpp"
#include "corda/sweep/sweep.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

constexpr std::int64_t kSamples = 256;

/// A sweep file of ropes with 3 to 30 links, with pictures of `side_px` x `side_px`.
sweep::SweepDef sweep_of(std::int64_t side_px, const test::ScratchFolder& folder) {
    static_cast<void>(folder.write("first.toml", R"(schema = 1
[world]
duration = 2.0
[[rope]]
hang = { links = 8, length = 1.0, angle_deg = 40.0 }
[video]
fps = 30
size = [)" + std::to_string(side_px) + ", " + std::to_string(side_px) +
                                                     "]\n"));
    return sweep::load_sweep(folder.write(
        "sweep.toml", "schema = 1\nscene = \"first.toml\"\nsamples = " + std::to_string(kSamples) + R"(
[vary]
"rope[0].hang.angle_deg" = { uniform = [5.0, 90.0] }
"rope[0].hang.links" = { integer = [3, 30] }
"rope[0].mass" = { log_uniform = [0.01, 10.0] }
"world.gravity" = [1.62, 9.81]
)"));
}

void count_clips(benchmark::State& bench, std::int64_t per_iteration = 1) {
    bench.counters["clips/s"] = benchmark::Counter(static_cast<double>(bench.iterations() * per_iteration),
                                                   benchmark::Counter::kIsRate);
}

FilmDef film_def() {
    FilmDef def;
    def.readings = {.velocities = true, .tensions = true, .unknown_tensions = true};
    return def;
}

/// Calls `work` with one sample after the other.
template <class Work>
void for_samples(benchmark::State& bench, const Work& work) {
    std::int64_t number = 0;
    for (auto _ : bench) work(number++ % kSamples);
    count_clips(bench);
}

/// Calls `work` with a film of each sample whose motion is there; its making is not measured.
template <class Work>
void for_films(benchmark::State& bench, const Work& work) {
    const test::ScratchFolder folder;
    const sweep::SweepDef sweep = sweep_of(bench.range(0), folder);
    for_samples(bench, [&](std::int64_t number) {
        bench.PauseTiming();
        Film film(scene_of(sweep, parameters_of(sweep, number)), film_def());
        static_cast<void>(film.camera());
        bench.ResumeTiming();
        work(film);
    });
}

void clip(benchmark::State& bench) {
    const test::ScratchFolder folder;
    const sweep::SweepDef sweep = sweep_of(bench.range(0), folder);
    sweep::SampleMaker maker(sweep);
    for_samples(bench, [&](std::int64_t number) {
        benchmark::DoNotOptimize(sweep::npz_bytes(maker.make(number).arrays));
    });
}

void stage_scene(benchmark::State& bench) {
    const test::ScratchFolder folder;
    const sweep::SweepDef sweep = sweep_of(bench.range(0), folder);
    for_samples(bench, [&](std::int64_t number) {
        benchmark::DoNotOptimize(scene_of(sweep, parameters_of(sweep, number)));
    });
}

void stage_motion(benchmark::State& bench) {
    const test::ScratchFolder folder;
    const sweep::SweepDef sweep = sweep_of(bench.range(0), folder);
    for_samples(bench, [&](std::int64_t number) {
        bench.PauseTiming();
        const Scene scene = scene_of(sweep, parameters_of(sweep, number));
        bench.ResumeTiming();
        Film film(scene, film_def());
        benchmark::DoNotOptimize(film.camera());
    });
}

void stage_masks(benchmark::State& bench) {
    for_films(bench, [](Film& film) {
        for (std::int64_t k = 0; k < film.frame_count(); ++k) benchmark::DoNotOptimize(film.mask(k));
    });
}

void stage_drawing(benchmark::State& bench) {
    pipeline::OwnedCanvas canvas;
    for_films(bench, [&](Film& film) {
        FilmRenderer renderer(film, &canvas);
        for (std::int64_t k = 0; k < film.frame_count(); ++k)
            benchmark::DoNotOptimize(renderer.draw(film.time_s(k)));
    });
}

/// Drawing, encoding and muxing.
void stage_video(benchmark::State& bench) {
    pipeline::OwnedCanvas canvas;
    for_films(bench, [&](Film& film) {
        FilmRenderer renderer(film, &canvas);
        benchmark::DoNotOptimize(video_files(film, renderer, "clip.mp4"));
    });
}

void stage_npz(benchmark::State& bench) {
    const test::ScratchFolder folder;
    const sweep::SweepDef sweep = sweep_of(bench.range(0), folder);
    const sweep::Sample sample = sweep::SampleMaker(sweep).make(0);
    for_samples(bench, [&](std::int64_t) { benchmark::DoNotOptimize(npz_bytes(sample.arrays)); });
}

/// Shards, with their checksums, by a number of jobs.
void whole(benchmark::State& bench) {
    const test::ScratchFolder folder;
    const sweep::SweepDef sweep = sweep_of(bench.range(0), folder);
    sweep::RunDef def;
    def.folder = folder.file("out");
    def.jobs = static_cast<int>(bench.range(1));
    def.force = true;
    for (auto _ : bench) run_sweep(sweep, def);
    count_clips(bench, kSamples);
}

void sizes(benchmark::internal::Benchmark* bench) {
    bench->Unit(benchmark::kMillisecond)->Arg(64)->Arg(128)->MeasureProcessCPUTime()->UseRealTime();
}
BENCHMARK(clip)->Apply(sizes);
BENCHMARK(stage_scene)->Apply(sizes);
BENCHMARK(stage_motion)->Apply(sizes);
BENCHMARK(stage_masks)->Apply(sizes);
BENCHMARK(stage_drawing)->Apply(sizes);
BENCHMARK(stage_video)->Apply(sizes);
BENCHMARK(stage_npz)->Apply(sizes);
BENCHMARK(whole)
    ->Unit(benchmark::kMillisecond)
    ->ArgsProduct({{64, 128}, {1, 2}})
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace corda

BENCHMARK_MAIN();
