#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>
#include <tuple>

#include "corda/media/chunks/join.hpp"
#include "corda/media/verify/verify.hpp"
#include "corda/pipeline/film.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/host_context.hpp"

namespace corda {
namespace {

using test::code_of;
using test::failure_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kVideoRope = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[solver]
method = "exact"
[video]
size = [96, 64]
fps = 20
preset = "ultrafast"
)";

Film rope_film(const std::string& toml = kVideoRope) {
    return Film(parse_scene(toml, "film.toml"));
}

RenderDef range(std::int64_t first, std::optional<std::int64_t> end) {
    RenderDef def;
    def.first = first;
    def.end = end;
    return def;
}

class RenderVideo : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    /// The bytes of the video of `film`.
    [[nodiscard]] std::string render(Film& film, const RenderDef& def = {}) const {
        const Rendered rendered = render_video(film, file("out.mp4"), def);
        EXPECT_TRUE(rendered.complete);
        const std::string bytes = test::read_file(file("out.mp4"));
        std::filesystem::remove(file("out.mp4"));
        return bytes;
    }

    test::ScratchFolder folder_;

  private:
    /// Beside it no encoder is tried in a child, which would ask for progress an unknown number of times.
    std::jthread other_{[](const std::stop_token& stop) {
        while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }};
};

TEST_F(RenderVideo, WritesEveryFrameOnce) {
    Film film = rope_film();
    std::vector<std::int64_t> heard;
    RenderDef def;
    def.on_progress = [&](std::int64_t done, std::int64_t total) {
        EXPECT_EQ(total, 20);
        heard.push_back(done);
        return true;
    };
    const Rendered rendered = render_video(film, file("a.mp4"), def);
    EXPECT_EQ(rendered.frames, 20);
    EXPECT_TRUE(rendered.complete);
    EXPECT_EQ(rendered.kept, "");
    EXPECT_EQ(rendered.chunks, 1);
    EXPECT_EQ(rendered.encoder, "libx264");
    EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
    for (std::int64_t done = 0; done < 20; ++done) EXPECT_GE(std::count(heard.begin(), heard.end(), done), 1);
    EXPECT_GT(std::count(heard.begin(), heard.end(), 20), 1);  // also while the video is copied and verified
    EXPECT_EQ(media::verify(file("a.mp4")).frames, 20);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(RenderVideo, CountsFramesOfAnimationsTwiceAndCanBeStoppedAnyTime) {
    for (const std::string name : {"a.gif"}) {
        Scene scene = parse_scene(kVideoRope, "rope.toml");
        scene.video.encoder.preset.clear();
        Film film(scene);
        const std::int64_t frames = film.frame_count();
        std::vector<std::int64_t> heard;
        RenderDef def;
        def.on_progress = [&](std::int64_t done, std::int64_t total) {
            EXPECT_EQ(total, 2 * frames);
            heard.push_back(done);
            return true;
        };
        EXPECT_EQ(render_video(film, file(name), def).encoder, name.substr(2));
        EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end())) << name;
        EXPECT_EQ(heard.front(), 0) << name;
        EXPECT_EQ(heard.back(), 2 * frames) << name;
        const std::string bytes = test::read_file(file(name));
        for (std::size_t calls = 1; calls < heard.size(); calls += 5) {
            std::size_t asked = 0;
            def.force = true;
            def.on_progress = [&](std::int64_t, std::int64_t) { return asked++ < calls; };
            const Rendered stopped = render_video(film, file(name), def);
            if (stopped.complete) break;  // what it is asked depends on how fast its threads are
            EXPECT_TRUE(test::read_file(file(name)) == bytes) << name;  // the old one
            if (stopped.frames < frames) continue;
            media::recover(stopped.kept, file(name), {.force = true});
            EXPECT_TRUE(test::read_file(file(name)) == bytes) << name;
        }
    }
}

TEST_F(RenderVideo, WritesARange) {
    Film film = rope_film();
    EXPECT_EQ(render_video(film, file("a.mp4"), range(15, std::nullopt)).frames, 5);
    EXPECT_EQ(render_video(film, file("b.mp4"), range(19, 20)).frames, 1);
    EXPECT_EQ(render_video(film, file("c.mp4"), range(0, 2)).frames, 2);
}

TEST_F(RenderVideo, RefusesInvalidRanges) {
    Film film = rope_film();
    using Range = std::pair<std::int64_t, std::optional<std::int64_t>>;
    for (const auto& [first, end] :
         std::vector<Range>{{-1, 5}, {5, 5}, {6, 5}, {0, 0}, {0, 21}, {20, std::nullopt}, {0, -1}}) {
        const RenderDef def = range(first, end);
        const test::Failure failure = failure_of([&] { render_video(film, file("a.mp4"), def); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << first;
        EXPECT_THAT(failure.message, HasSubstr("0 <= FIRST < END <= 20"));
        EXPECT_EQ(failure_of([&] { std::ignore = check_render(film.scene(), file("a.mp4"), def); }).code,
                  ExitCode::kUsage);
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(RenderVideo, ChecksTheOutputBeforeItSimulates) {
    Film film = rope_film();
    test::write_file(file("a.mp4"), "precious");
    test::write_file(file("b.mp4.parts"), "no folder");
    for (const char* name : {"a.mp4", "b.mp4", "no/such/folder/a.mp4"})
        EXPECT_EQ(failure_of([&] { render_video(film, file(name)); }).code, ExitCode::kIo) << name;
    EXPECT_EQ(failure_of([&] { render_video(film, file("c.avi")); }).code, ExitCode::kUsage);
    EXPECT_EQ(film.simulation_passes(), 0);
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
    RenderDef def;
    def.force = true;
    EXPECT_EQ(
        failure_of([&] { std::ignore = check_render(film.scene(), file("a.mp4"), def, file("a.mp4")); }).code,
        ExitCode::kUsage);
    EXPECT_EQ(check_render(film.scene(), file("a.mp4"), def).path(), file("a.mp4"));
}

TEST_F(RenderVideo, WritesACheckedOutput) {
    Film film = rope_film();
    const CheckedOutput output = check_render(film.scene(), file("a.mp4"), range(5, 12));
    EXPECT_EQ(output.first(), 5);
    EXPECT_EQ(output.end(), 12);
    EXPECT_EQ(film.simulation_passes(), 0);
    EXPECT_EQ(render_video(film, output).frames, 7);
    EXPECT_EQ(media::verify(file("a.mp4")).frames, 7);
}

TEST_F(RenderVideo, RefusesAFilmOfAnotherSizeThanTheCheckedOutput) {
    Film film = rope_film();
    Scene larger = film.scene();
    larger.video.width_px *= 2;
    const CheckedOutput output = check_render(larger, file("a.mp4"));
    const test::Failure failure = failure_of([&] { render_video(film, output); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, HasSubstr("checked for 192x64 at 20 frames per second"));
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(RenderVideo, ChecksTheVideoBeforeItSimulates) {
    for (const auto& spoil : std::vector<void (*)(VideoDef&)>{[](VideoDef& v) { v.encoder.codec = "ffv1"; },
                                                              [](VideoDef& v) { v.encoder.crf = 52; },
                                                              [](VideoDef& v) { v.width_px = 97; }}) {
        Scene scene = parse_scene(kVideoRope, "film.toml");
        spoil(scene.video);
        Film film(scene);
        EXPECT_EQ(failure_of([&] { render_video(film, file("a.mp4")); }).code, ExitCode::kUsage);
        EXPECT_EQ(film.simulation_passes(), 0);
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(RenderVideo, KeepsTheFramesWhenItIsStopped) {
    Film film = rope_film();
    RenderDef def;
    def.on_progress = [](std::int64_t done, std::int64_t) { return done < 7; };
    const Rendered rendered = render_video(film, file("a.mp4"), def);
    EXPECT_FALSE(rendered.complete);
    EXPECT_EQ(rendered.frames, 7);
    EXPECT_EQ(rendered.kept, file("a.mp4.parts"));
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.parts"));
    def.on_progress = [](std::int64_t, std::int64_t) { return false; };
    def.force = true;
    EXPECT_EQ(render_video(film, file("a.mp4"), def).kept, "");
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(RenderVideo, KeepsAllFramesIfStoppedWhileCopyingOrVerifying) {
    Film film = rope_film();
    // Measured, with all frames done: 23 calls until they are copied, 20 while the copy is verified.
    for (const int most_calls : {3, 4, 22, 23, 40}) {
        RenderDef def;
        def.force = true;
        int calls = 0;
        def.on_progress = [&calls, most_calls](std::int64_t done, std::int64_t) {
            return done < 20 || calls++ < most_calls;
        };
        const Rendered rendered = render_video(film, file("a.mp4"), def);
        EXPECT_FALSE(rendered.complete) << most_calls;
        EXPECT_EQ(rendered.frames, 20) << most_calls;
        EXPECT_EQ(rendered.kept, file("a.mp4.parts")) << most_calls;
        EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.parts")) << most_calls;
        media::recover(rendered.kept, file("b.mp4"), {.force = true});
        EXPECT_EQ(media::verify(file("b.mp4")).frames, 20) << most_calls;
        std::filesystem::remove(file("b.mp4"));
    }
}

TEST_F(RenderVideo, EscapesANameThatIsNotUtf8) {
    Film film(parse_scene(kVideoRope, "caf\xe9\x1b.toml"));
    render_video(film, file("a.mp4"));
    EXPECT_TRUE(media::verify(file("a.mp4")).ok());
    EXPECT_THAT(test::read_file(file("a.mp4")),
                AllOf(HasSubstr("caf\\xe9\\x1b"), HasSubstr(R"("scene":"caf\\xe9\\x1b")")));
}

TEST_F(RenderVideo, KeepsTheFramesBeforeADivergence) {
    Scene scene = parse_scene(kVideoRope, "film.toml");
    scene.camera = {Vec2{0.0, 0.0}, 3.0};
    scene.solver = RelaxationDef{.force_n = Vec2{1e300, 0.0}};
    Film diverging(scene);
    const test::Failure failure = failure_of([&] { render_video(diverging, file("a.mp4")); });
    EXPECT_EQ(failure.code, ExitCode::kDiverged);
    EXPECT_THAT(failure.message, HasSubstr(file("a.mp4.parts")));
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.parts"));
}

TEST_F(RenderVideo, KeepsTheSameFramesBeforeADivergenceWithAnyJobs) {
    std::vector<std::string> parts;
    for (const int jobs : {1, 2}) {
        for (const double shutter : {0.0, 0.5}) {
            Scene scene = parse_scene(kVideoRope, "film.toml");
            scene.world.duration_s = 4.0;  // two chunks
            scene.video.encoder.jobs = jobs;
            scene.video.shutter = shutter;
            scene.camera = {Vec2{0.0, 0.0}, 3.0};
            scene.style.supports = false;  // so that the camera needs no motion
            scene.solver = RelaxationDef{.force_n = Vec2{1e300, 0.0}};
            Film diverging(scene);
            RenderDef def;
            def.force = true;
            EXPECT_EQ(code_of([&] { render_video(diverging, file("a.mp4"), def); }), ExitCode::kDiverged);
            for (const media::ChunkFile& chunk : media::chunk_files(file("a.mp4.parts")))
                parts.push_back(test::read_file(chunk.path));
        }
    }
    ASSERT_EQ(parts.size(), 4U);
    EXPECT_TRUE(parts[0] == parts[2]);
    EXPECT_TRUE(parts[1] == parts[3]);
}

TEST_F(RenderVideo, HasTheSameBytesIfItsCallbackDrawsAnotherFilm) {
    Film film = rope_film();
    const std::string alone = render(film);
    Film other = rope_film(
        "schema = 1\n[[rope]]\nline = { particles = 5, step = [0.1, -1.0] }\n"
        "[video]\nsize = [50, 30]\n");
    const test::HostContext host;
    std::optional<Film> dying;
    RenderDef def;
    const std::vector<std::function<void(std::int64_t)>> callbacks{
        [&](std::int64_t done) { static_cast<void>(other.frame(done)); },
        [&](std::int64_t) {
            dying.emplace(rope_film());
            static_cast<void>(dying->frame(3));
            dying.reset();
        },
        [&](std::int64_t) { host.make_current(); }};
    for (const auto& callback : callbacks) {
        def.on_progress = [&](std::int64_t done, std::int64_t) {
            callback(done);
            return true;
        };
        EXPECT_EQ(render(film, def), alone);
        EXPECT_TRUE(host.is_current());
    }
}

TEST_F(RenderVideo, RefusesItsCallbackToUseTheFilm) {
    for (const char* const jobs : {"1", "3"}) {
        Film film(
            parse_scene(kVideoRope, "film.toml", {"world.duration=5.0", std::string("video.jobs=") + jobs}));
        const std::string alone = render(film);
        RenderDef def;
        def.on_progress = [&](std::int64_t, std::int64_t) {
            EXPECT_EQ(code_of([&] { static_cast<void>(film.frame(3)); }), ExitCode::kUsage);
            EXPECT_EQ(code_of([&] { static_cast<void>(film.state(3)); }), ExitCode::kUsage);
            return true;
        };
        EXPECT_EQ(render(film, def), alone);
        def.on_progress = [&](std::int64_t, std::int64_t) { return film.frame(3).width() > 0; };
        EXPECT_EQ(code_of([&] { static_cast<void>(render(film, def)); }), ExitCode::kUsage);
        std::filesystem::remove_all(file("out.mp4.parts"));
    }
}

}  // namespace
}  // namespace corda
