// The stages of a video of examples/swing.toml at its own size, apart and together: drawing alone, encoding
// the same frames from memory, and both. The figure to watch is the ratio of the last two, taken in one run.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <vector>

#include "corda/gl/context.hpp"
#include "corda/media/video_writer.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/scene/player.hpp"

namespace corda {
namespace {

constexpr int kFrames = 150;  // 2.5 s of 60 a second: 1.2 GB of pictures

scene::Scene load_example() {
    return scene::load_scene(CORDA_EXAMPLES "/swing.toml");
}

std::string output_path() {
    return (std::filesystem::temp_directory_path() / "corda-benchmark.mp4").string();
}

void count_frames(benchmark::State& bench) {
    bench.counters["frames/s"] =
        benchmark::Counter(static_cast<double>(bench.iterations() * kFrames), benchmark::Counter::kIsRate);
}

void draw(benchmark::State& bench) {
    const scene::Scene scene = load_example();
    const gl::Context context;
    render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
    for (auto _ : bench) {
        scene::Player player(scene);
        for (int k = 0; k < kFrames; ++k) renderer.render(player.at(scene.video.fps.time_s(k)));
    }
    count_frames(bench);
}

void encode(benchmark::State& bench) {
    const scene::Scene scene = load_example();
    const gl::Context context;
    render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
    scene::Player player(scene);
    std::vector<Image> frames;
    std::vector<PixelRect> damages;
    for (int k = 0; k < kFrames; ++k) {
        damages.push_back(renderer.render(player.at(scene.video.fps.time_s(k))));
        frames.push_back(renderer.image());
    }
    for (auto _ : bench) {
        media::VideoWriter writer(output_path(), scene.video, {});
        for (int k = 0; k < kFrames; ++k) writer.write(frames[k], damages[k]);
        writer.finish();
    }
    count_frames(bench);
}

void draw_and_encode(benchmark::State& bench) {
    const scene::Scene scene = load_example();
    const gl::Context context;
    for (auto _ : bench) {
        render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
        scene::Player player(scene);
        media::VideoWriter writer(output_path(), scene.video, {});
        for (int k = 0; k < kFrames; ++k) {
            const PixelRect damage = renderer.render(player.at(scene.video.fps.time_s(k)));
            writer.write(renderer.image(), damage);
        }
        writer.finish();
    }
    count_frames(bench);
}

BENCHMARK(draw)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(encode)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(draw_and_encode)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace corda

BENCHMARK_MAIN();
