#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>
#include <tuple>

#include "corda/film/film.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/host_context.hpp"
#include "support/image_matchers.hpp"

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
jobs = 1
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
    [[nodiscard]] std::string render(const Film& film, const RenderDef& def = {}) const {
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
    EXPECT_EQ(rendered.kept_frames, 0);
    EXPECT_EQ(rendered.encoder, "libx264");
    EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
    for (std::int64_t done = 0; done < 20; ++done) EXPECT_GE(std::count(heard.begin(), heard.end(), done), 1);
    EXPECT_GT(std::count(heard.begin(), heard.end(), 20), 1);  // also while the video is ended and checked
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(RenderVideo, HoldsTheLastPictureAtTheEnd) {
    Scene scene = parse_scene(kVideoRope, "rope.toml");
    scene.video.encoder.preset.clear();
    scene.video.hold_s = 0.5;
    scene.video.encoder.jobs = 2;
    const Film film(scene);
    EXPECT_EQ(film.frame_count(), 20);
    for (const char* const name : {"a.mp4", "a.gif", "a.mkv"})
        EXPECT_EQ(render_video(film, file(name)).frames, 30) << name;
    EXPECT_EQ(render_video(film, file("b.mp4"), range(3, 20)).frames, 27);
    EXPECT_EQ(render_video(film, file("c.mp4"), range(3, 19)).frames, 16);  // not the end
    EXPECT_EQ(render_video(film, file("%d.png")).frames, 20);
    EXPECT_EQ(video_files(film, "a.mp4").front(), test::read_file(file("a.mp4")));
    const auto extracted = test::run_shell(
        "cd " + test::quoted(folder_.path()) +
        " && ffmpeg -v error -i a.mkv -f framemd5 - | tail -11 | cut -d, -f6 | sort -u | wc -l");
    EXPECT_EQ(std::stoi(extracted.out), 1) << extracted.err;  // the last frame and its repetitions
}

TEST_F(RenderVideo, CountsFramesOfAGifTwiceAndCanBeStoppedAnyTime) {
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
    EXPECT_EQ(render_video(film, file("a.gif"), def).encoder, "gif");
    EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
    EXPECT_EQ(heard.front(), 0);
    EXPECT_EQ(heard.back(), 2 * frames);
    const std::string bytes = test::read_file(file("a.gif"));
    for (std::size_t calls = 1; calls < heard.size(); calls += 5) {
        std::size_t asked = 0;
        def.force = true;
        def.on_progress = [&](std::int64_t, std::int64_t) { return asked++ < calls; };
        const Rendered stopped = render_video(film, file("a.gif"), def);
        EXPECT_TRUE(test::read_file(file("a.gif")) == bytes);  // the old one
        EXPECT_THAT(folder_.files(), ElementsAre("a.gif"));
        if (stopped.complete) break;  // what it is asked depends on how fast its threads are
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

TEST_F(RenderVideo, ChecksTheOutputFirst) {
    Film film = rope_film();
    test::write_file(file("a.mp4"), "precious");
    for (const char* name : {"a.mp4", "no/such/folder/a.mp4"})
        EXPECT_EQ(failure_of([&] { render_video(film, file(name)); }).code, ExitCode::kIo) << name;
    EXPECT_EQ(failure_of([&] { render_video(film, file("c.avi")); }).code, ExitCode::kUsage);
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
    EXPECT_EQ(render_video(film, output).frames, 7);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
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

TEST_F(RenderVideo, ChecksTheVideoBeforeThereIsAFilm) {
    for (const auto& spoil : std::vector<void (*)(VideoDef&)>{[](VideoDef& v) { v.encoder.codec = "ffv1"; },
                                                              [](VideoDef& v) { v.encoder.crf = 52; },
                                                              [](VideoDef& v) { v.width_px = 97; }}) {
        Scene scene = parse_scene(kVideoRope, "film.toml");
        spoil(scene.video);
        EXPECT_EQ(failure_of([&] { std::ignore = check_render(scene, file("a.mp4")); }).code,
                  ExitCode::kUsage);
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(RenderVideo, LeavesNothingIfItIsStopped) {
    Film film = rope_film();
    // Before the first frame, between frames, and while the video is ended and checked.
    for (const int most_calls : {0, 1, 8, 21, 22, 23, 30, 41}) {
        int calls = 0;
        RenderDef def;
        def.on_progress = [&](std::int64_t, std::int64_t) { return calls++ < most_calls; };
        const Rendered rendered = render_video(film, file("a.mp4"), def);
        EXPECT_FALSE(rendered.complete) << most_calls;
        EXPECT_EQ(rendered.frames, 0) << most_calls;
        EXPECT_THAT(folder_.files(), IsEmpty()) << most_calls;
    }
}

TEST_F(RenderVideo, EscapesANameThatIsNotUtf8) {
    Film film(parse_scene(kVideoRope, "caf\xe9\x1b.toml"));
    render_video(film, file("a.mp4"));
    EXPECT_THAT(test::read_file(file("a.mp4")),
                AllOf(HasSubstr("caf\\xe9\\x1b"), HasSubstr(R"("scene":"caf\\xe9\\x1b")")));
}

TEST_F(RenderVideo, LeavesNothingButPicturesOfAMotionThatDiverges) {
    for (const char* const name : {"a.mp4", "a.gif", "%d.png"}) {
        for (const int jobs : {1, 2}) {
            Scene scene = parse_scene(kVideoRope, "film.toml");
            scene.video.encoder.preset.clear();
            scene.video.encoder.jobs = jobs;
            scene.camera = {Vec2{0.0, 0.0}, 3.0};
            scene.style.supports = false;  // so that the camera needs no motion
            scene.solver = RelaxationDef{.force_n = Vec2{1e300, 0.0}};
            Film diverging(scene);
            RenderDef def;
            def.force = true;
            EXPECT_EQ(code_of([&] { render_video(diverging, file(name), def); }), ExitCode::kDiverged);
            for (const std::string& left : folder_.files())
                EXPECT_THAT(left, testing::AnyOf("0.png", "1.png")) << name;
        }
    }
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

TEST_F(RenderVideo, LetsItsCallbackUseTheFilm) {
    for (const char* const jobs : {"1", "3"}) {
        const Film film(
            parse_scene(kVideoRope, "film.toml", {"world.duration=5.0", std::string("video.jobs=") + jobs}));
        const std::string alone = render(film);
        const Image third = film.frame(3);
        RenderDef def;
        def.on_progress = [&](std::int64_t, std::int64_t) {
            EXPECT_TRUE(test::equal_images(film.frame(3), third));
            return film.state(3).x_m.size() > 1;
        };
        EXPECT_EQ(render(film, def), alone);
    }
}

}  // namespace
}  // namespace corda
