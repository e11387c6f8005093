// The stages of a video of examples/swing.toml, apart and together: drawing alone, of several looks; x264
// alone, on the frames as it takes them, from memory, with as many threads of its own as there are cores; and
// the whole render of a film that is simulated. The figure to watch is the ratio of the last two for a size
// and a preset, taken in one run.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "corda/media/chunk.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/yuv420.hpp"
#include "corda/pipeline/painter.hpp"

namespace corda {
namespace {

constexpr int kFrames = 150;  // 2.5 s at 60 frames per second: 1.2 GB of pictures

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

/// A size and a preset, as settings of the scene; 240 frames.
Film film_to_encode(const char* size, const char* preset) {
    return Film(load_scene(CORDA_EXAMPLES "/swing.toml",
                           {std::string("video.size=") + size, std::string("video.preset=") + preset,
                            "world.duration=4", "style.trail_s=0"}));
}

void fail(const char* what) {
    std::fprintf(stderr, "%s\n", what);
    std::abort();
}

media::CodecContext open_x264(const VideoDef& video) {
    const AVCodec* const codec = avcodec_find_encoder_by_name("libx264");
    media::CodecContext context(avcodec_alloc_context3(codec));
    context->width = video.width_px;
    context->height = video.height_px;
    context->pix_fmt = AV_PIX_FMT_YUV420P;
    context->time_base = media::frame_time_base(video.fps.rational());
    context->gop_size = static_cast<int>(media::frames_per_chunk(video.fps));
    context->thread_count = static_cast<int>(std::thread::hardware_concurrency());
    media::Options options;
    options.set("preset", video.encoder.preset).set("crf", std::to_string(video.encoder.crf));
    if (avcodec_open2(context.get(), codec, options.get()) < 0) fail("x264 does not open");
    return context;
}

/// Sends a frame, or the end if it is null, and drops what comes.
void send(AVCodecContext& context, const AVFrame* frame, AVPacket& packet) {
    if (avcodec_send_frame(&context, frame) < 0) fail("x264 takes no frame");
    while (avcodec_receive_packet(&context, &packet) == 0) av_packet_unref(&packet);
}

void encoder_alone(benchmark::State& bench, const char* size, const char* preset) {
    const media::QuietLog quiet;
    Film film = film_to_encode(size, preset);
    const VideoDef& video = film.scene().video;
    std::vector<media::Yuv420Image> frames;
    FilmPainter painter(film);
    for (std::int64_t k = 0; k < film.frame_count(); ++k) {
        painter.draw(film.time_s(k));
        media::convert_to_yuv420(painter.image(), painter.image().rect(),
                                 frames.emplace_back(video.width_px, video.height_px));
    }
    const media::Packet packet(av_packet_alloc());
    for (auto _ : bench) {
        const media::CodecContext context = open_x264(video);
        const media::Frame frame(av_frame_alloc());
        frame->format = AV_PIX_FMT_YUV420P;
        frame->width = video.width_px;
        frame->height = video.height_px;
        for (std::size_t k = 0; k < frames.size(); ++k) {
            for (int plane = 0; plane < 3; ++plane) {
                frame->data[plane] = frames[k].plane(plane);
                frame->linesize[plane] = frames[k].plane_width(plane);
            }
            frame->pts = static_cast<std::int64_t>(k);
            send(*context, frame.get(), *packet);
        }
        send(*context, nullptr, *packet);
    }
}

void render(benchmark::State& bench, const char* size, const char* preset) {
    Film film = film_to_encode(size, preset);
    static_cast<void>(film.camera());
    RenderDef def;
    def.force = true;
    for (auto _ : bench) render_video(film, output_path(), def);
}

BENCHMARK_CAPTURE(draw, plain, kPlain)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, default_look, kDefault)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, overlays, kOverlays)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, trail, kTrail)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, plot, kPlot)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, blur_8, kBlur8)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(draw, blur_16, kBlur16)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 720p_medium, "[1280,720]", "medium")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 720p_medium, "[1280,720]", "medium")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 720p_veryfast, "[1280,720]", "veryfast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 720p_veryfast, "[1280,720]", "veryfast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 720p_ultrafast, "[1280,720]", "ultrafast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 720p_ultrafast, "[1280,720]", "ultrafast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 1080p_medium, "[1920,1080]", "medium")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 1080p_medium, "[1920,1080]", "medium")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 1080p_veryfast, "[1920,1080]", "veryfast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 1080p_veryfast, "[1920,1080]", "veryfast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 1080p_ultrafast, "[1920,1080]", "ultrafast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 1080p_ultrafast, "[1920,1080]", "ultrafast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 2160p_medium, "[3840,2160]", "medium")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 2160p_medium, "[3840,2160]", "medium")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 2160p_veryfast, "[3840,2160]", "veryfast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 2160p_veryfast, "[3840,2160]", "veryfast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(encoder_alone, 2160p_ultrafast, "[3840,2160]", "ultrafast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(render, 2160p_ultrafast, "[3840,2160]", "ultrafast")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace corda

BENCHMARK_MAIN();
