#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "corda/media/chunks/chunk.hpp"
#include "corda/media/chunks/chunk_folder.hpp"
#include "corda/media/chunks/join.hpp"
#include "corda/media/verify/verify.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using testing::ElementsAre;

/// 130 frames: chunks of 30, the last of 10. With a trail and a plot, which need other frames.
Scene chunked_scene(int jobs, const std::vector<Setting>& settings = {}) {
    Scene scene = parse_scene(R"(schema = 1
[world]
duration = 8.66
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[solver]
method = "exact"
[style]
trail_s = 0.5
[overlay]
plots = ["tip"]
[video]
size = [256, 144]
fps = 15
preset = "veryfast"
)",
                              "film.toml", settings);
    scene.video.encoder.jobs = jobs;
    return scene;
}

class RenderChunks : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    /// True once the first chunk of a video under way is in its folder.
    [[nodiscard]] bool has_chunk(const std::string& name) const {
        return !media::chunk_files(media::parts_path(file(name))).empty();
    }

    [[nodiscard]] std::string bytes_of(const Scene& scene, const RenderDef& def = {},
                                       std::size_t budget_bytes = std::size_t{1} << 20) const {
        FilmDef film_def;
        film_def.motion_budget_bytes = budget_bytes;
        Film film(scene, film_def);
        EXPECT_TRUE(render_video(film, file("out.mp4"), def).complete);
        const std::string bytes = test::read_file(file("out.mp4"));
        std::filesystem::remove(file("out.mp4"));
        return bytes;
    }

    test::ScratchFolder folder_;
};

TEST_F(RenderChunks, HaveTheSameBytesForAnyNumberOfJobs) {
    const std::string expected = bytes_of(chunked_scene(1));
    for (const int jobs : {2, 3, 8, 0}) EXPECT_TRUE(bytes_of(chunked_scene(jobs)) == expected) << jobs;
    // A motion that is not recorded is drawn in order.
    EXPECT_TRUE(bytes_of(chunked_scene(4), {}, 0) == expected);
    RenderDef middle;
    middle.first = 20;
    middle.end = 100;
    EXPECT_TRUE(bytes_of(chunked_scene(1), middle) == bytes_of(chunked_scene(3), middle));
}

TEST_F(RenderChunks, HaveTheSameBytesIfTheyAreBlurred) {
    const std::vector<Setting> blur{"video.shutter=0.5", "video.subframes=4"};
    Film film(chunked_scene(1, blur));
    EXPECT_TRUE(FilmRenderer::can_draw_in_any_order(film, 130));
    const std::string expected = bytes_of(chunked_scene(1, blur));
    EXPECT_TRUE(bytes_of(chunked_scene(3, blur)) == expected);
    EXPECT_TRUE(bytes_of(chunked_scene(3, blur), {}, 0) == expected);
}

TEST_F(RenderChunks, BeginAtMultiplesOfTheirLengthInTheFilm) {
    const FrameRate fps = chunked_scene(1).video.fps;
    EXPECT_EQ(media::frames_per_chunk(fps), 30);
    Film film(chunked_scene(2));
    RenderDef def;
    def.first = 20;
    def.end = 100;
    EXPECT_EQ(render_video(film, file("a.mp4"), def).frames, 80);
    const media::VerifyReport report = media::verify(file("a.mp4"));
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.frames, 80);
}

TEST_F(RenderChunks, ReportProgressInOrderAndEmptyFrames) {
    const Scene scene = chunked_scene(3, {"camera.center=[100,100]", "camera.height=1"});
    Film film(scene);
    std::vector<std::int64_t> heard;
    RenderDef def;
    def.on_progress = [&](std::int64_t done, std::int64_t total) {
        EXPECT_EQ(total, 130);
        heard.push_back(done);
        return true;
    };
    const Rendered rendered = render_video(film, file("a.mp4"), def);
    EXPECT_EQ(rendered.frames, 130);
    EXPECT_EQ(rendered.empty_frames, 130);
    EXPECT_EQ(rendered.first_empty_s, 0.0);
    EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
    EXPECT_EQ(heard.back(), 130);
}

TEST_F(RenderChunks, CountEmptyFramesOfAResumedPart) {
    for (const char* const shutter : {"video.shutter=0", "video.shutter=0.5"}) {
        Scene scene = chunked_scene(2, {"camera.center=[100,100]", "camera.height=1", shutter});
        Film film(scene);
        RenderDef def;
        def.on_progress = [this](std::int64_t, std::int64_t) { return !has_chunk("a.mp4"); };
        const Rendered stopped = render_video(film, file("a.mp4"), def);
        EXPECT_FALSE(stopped.complete);
        EXPECT_GE(stopped.empty_frames, stopped.frames);
        def.on_progress = {};
        def.resume = true;
        const Rendered rendered = render_video(film, file("a.mp4"), def);
        EXPECT_GE(rendered.resumed_frames, 30);
        EXPECT_EQ(rendered.empty_frames, 130);
        EXPECT_EQ(rendered.first_empty_s, 0.0);
        std::filesystem::remove(file("a.mp4"));
    }
}

TEST_F(RenderChunks, KeepTheFramesBeforeAStop) {
    Film film(chunked_scene(3));
    RenderDef def;
    def.on_progress = [this](std::int64_t, std::int64_t) { return !has_chunk("a.mp4"); };
    const Rendered rendered = render_video(film, file("a.mp4"), def);
    EXPECT_FALSE(rendered.complete);
    EXPECT_GT(rendered.frames, 0);
    EXPECT_LE(rendered.frames, 130);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.parts"));
    EXPECT_EQ(media::recover(file("a.mp4.parts"), file("b.mp4")).frames, rendered.frames);
}

TEST_F(RenderChunks, OfShardsAreJoinedToTheSameBytes) {
    for (const std::size_t budget_bytes : {std::size_t{1} << 20, std::size_t{0}}) {  // any order, or one
        FilmDef film_def;
        film_def.motion_budget_bytes = budget_bytes;
        const Scene scene = chunked_scene(2);
        RenderDef def;
        def.first = 20;  // chunks of 10, 30, 30, 30 and 10 frames
        const std::string expected = bytes_of(scene, def, budget_bytes);
        for (const auto& [index, frames] : {std::pair{2, 30}, {0, 40}, {1, 40}}) {
            Film film(scene, film_def);
            std::int64_t heard = 0;
            def.shard = Shard{index, 3};
            def.on_progress = [&, its_frames = frames](std::int64_t done, std::int64_t total) {
                heard = done;
                return total == 110 || total == its_frames;
            };
            const Rendered rendered = render_video(film, file("out.mp4"), def);
            EXPECT_TRUE(rendered.complete);
            EXPECT_EQ(rendered.frames, frames);
            EXPECT_EQ(rendered.chunks, index == 2 ? 1 : 2);
            EXPECT_EQ(heard, frames);
            EXPECT_THAT(folder_.files(), ElementsAre("out.mp4.parts"));
            EXPECT_EQ(render_video(film, file("out.mp4"), def).chunks, 0);  // all are there
        }
        def.shard = {};
        def.resume = true;
        def.on_progress = {};
        Film film(scene, film_def);
        const Rendered rendered = render_video(film, file("out.mp4"), def);
        EXPECT_EQ(rendered.resumed_frames, 110);
        EXPECT_EQ(rendered.chunks, 0);
        EXPECT_TRUE(test::read_file(file("out.mp4")) == expected);
        EXPECT_THAT(folder_.files(), ElementsAre("out.mp4"));
        std::filesystem::remove(file("out.mp4"));
    }
}

TEST_F(RenderChunks, PassOnExceptionsOfTheCallback) {
    Film film(chunked_scene(3));
    RenderDef def;
    int asked = 0;
    def.on_progress = [&](std::int64_t, std::int64_t) -> bool {
        if (++asked > 3) throw Error(ExitCode::kIo, "the host has enough");
        return true;
    };
    EXPECT_EQ(test::code_of([&] { render_video(film, file("a.mp4"), def); }), ExitCode::kIo);
}

TEST(ChunkLength, IsOneToTwoSeconds) {
    for (const auto& [rate, frames] : {std::pair{Rational{60, 1}, 60},
                                       {{24, 1}, 48},
                                       {{25, 1}, 50},
                                       {{30, 1}, 60},
                                       {{30000, 1001}, 60},
                                       {{120, 1}, 120},
                                       {{5, 1}, 10},
                                       {{1, 10}, 1}}) {
        EXPECT_EQ(media::frames_per_chunk(FrameRate(rate)), frames) << rate.text();
        for (const std::string ending : {".mov", ".mkv"}) {  // at most
            VideoDef def;
            def.fps = FrameRate(rate);
            const media::Format format = media::find_format("a" + ending, def, false);
            EXPECT_LE(media::frames_per_chunk(format, def.fps), frames) << ending << " " << rate.text();
        }
    }
}

TEST(FilmRenderers, OfSeveralThreadsDrawTheSame) {
    Film film(chunked_scene(1));
    ASSERT_TRUE(FilmRenderer::can_draw_in_any_order(film, film.frame_count()));
    const std::vector<std::int64_t> frames{70, 3, 71};
    std::vector<std::vector<Image>> drawn(3);
    std::vector<std::thread> threads;
    for (std::vector<Image>& images : drawn) {
        threads.emplace_back([&] {
            FilmRenderer renderer(film);
            for (const std::int64_t k : frames) {
                renderer.draw(film.time_s(k));
                images.push_back(renderer.image());
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const Image expected = film.frame(frames[i]);
        for (const std::vector<Image>& images : drawn)
            EXPECT_TRUE(test::equal_images(images[i], expected)) << i;
    }
}

}  // namespace
}  // namespace corda
