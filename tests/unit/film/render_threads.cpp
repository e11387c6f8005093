#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "corda/film/film.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using testing::IsEmpty;

/// 130 frames, with a trail and a plot, which need other frames.
Scene long_scene(int jobs, const std::vector<Setting>& settings = {}) {
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

class RenderThreads : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    [[nodiscard]] std::string bytes_of(const Scene& scene, const RenderDef& def = {}) const {
        const Film film(scene);
        EXPECT_TRUE(render_video(film, file("out.mp4"), def).complete);
        const std::string bytes = test::read_file(file("out.mp4"));
        std::filesystem::remove(file("out.mp4"));
        return bytes;
    }

    test::ScratchFolder folder_;
};

TEST_F(RenderThreads, HaveTheSameBytesForAnyNumberOfJobs) {
    const std::string expected = bytes_of(long_scene(1));
    for (const int jobs : {2, 3, 8, 0}) EXPECT_TRUE(bytes_of(long_scene(jobs)) == expected) << jobs;
    RenderDef middle;
    middle.first = 20;
    middle.end = 100;
    EXPECT_TRUE(bytes_of(long_scene(1), middle) == bytes_of(long_scene(3), middle));
}

TEST_F(RenderThreads, HaveTheSameBytesIfTheyAreBlurred) {
    const std::vector<Setting> blur{"video.shutter=0.5", "video.subframes=4"};
    const std::string expected = bytes_of(long_scene(1, blur));
    EXPECT_TRUE(bytes_of(long_scene(3, blur)) == expected);
}

TEST_F(RenderThreads, HaveTheSameBytesInEveryFormat) {
    for (const char* const name : {"a.mp4", "a.webm", "a.mov", "a.mkv", "a.gif", "%03d.png"}) {
        std::vector<std::string> made;
        for (const int jobs : {1, 2, 3}) {
            Scene scene = long_scene(jobs);
            scene.video.encoder.preset.clear();
            Film film(scene);
            RenderDef def;
            def.end = 40;
            EXPECT_TRUE(render_video(film, file(name), def).complete) << name;
            std::string& bytes = made.emplace_back();
            for (const std::string& one : folder_.files()) {
                bytes += one + test::read_file(file(one));
                std::filesystem::remove(file(one));
            }
            EXPECT_TRUE(bytes == made.front()) << name << jobs;
        }
    }
}

TEST_F(RenderThreads, ReportProgressInOrderAndEmptyFrames) {
    const Scene scene = long_scene(3, {"camera.center=[100,100]", "camera.height=1"});
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

TEST_F(RenderThreads, LeaveNothingIfTheyAreStopped) {
    for (const int most_calls : {5, 50, 130}) {
        Film film(long_scene(3));
        RenderDef def;
        int calls = 0;
        def.on_progress = [&](std::int64_t, std::int64_t) { return calls++ < most_calls; };
        const Rendered rendered = render_video(film, file("a.mp4"), def);
        EXPECT_FALSE(rendered.complete);
        EXPECT_EQ(rendered.frames, 0);
        EXPECT_THAT(folder_.files(), IsEmpty());
    }
}

TEST_F(RenderThreads, DrawTheMissingPicturesOfASequence) {
    for (const char* const shutter : {"video.shutter=0", "video.shutter=0.5"}) {
        const std::vector<Setting> empty{"camera.center=[100,100]", "camera.height=1", shutter};
        Scene scene = long_scene(2, empty);
        scene.video.encoder.preset.clear();
        Film film(scene);
        RenderDef def;
        def.end = 30;
        render_video(film, file("%02d.png"), def);
        const auto all = [&] {
            std::string bytes;
            for (const std::string& one : folder_.files()) bytes += one + test::read_file(file(one));
            return bytes;
        };
        const std::string whole = all();
        std::filesystem::remove(file("03.png"));
        std::filesystem::remove(file("29.png"));
        const std::string picture = test::read_file(file("07.png"));
        test::write_file(file("07.png"), picture.substr(0, picture.size() / 2));
        test::write_file(file("11.png"), "");
        EXPECT_EQ(test::code_of([&] { render_video(film, file("%02d.png"), def); }), ExitCode::kIo);
        def.resume = true;
        const Rendered rendered = render_video(film, file("%02d.png"), def);
        EXPECT_EQ(rendered.frames, 30);
        EXPECT_EQ(rendered.kept_frames, 26);
        EXPECT_EQ(rendered.empty_frames, 30);
        EXPECT_EQ(rendered.first_empty_s, 0.0);
        EXPECT_TRUE(all() == whole);
        EXPECT_EQ(render_video(film, file("%02d.png"), def).kept_frames, 30);
        for (const std::string& one : folder_.files()) std::filesystem::remove(file(one));
    }
}

TEST_F(RenderThreads, RefusePicturesOfAnotherSceneUnlessForced) {
    const auto scene_of = [](const std::vector<Setting>& settings) {
        Scene scene = long_scene(2, settings);
        scene.video.encoder.preset.clear();
        return scene;
    };
    RenderDef def;
    def.end = 3;
    Film film(scene_of({}));
    render_video(film, file("%d.png"), def);
    const std::string picture = test::read_file(file("1.png"));
    def.resume = true;
    Film other(scene_of({"rope[0].hang.angle_deg=51"}));
    const test::Failure failure = test::failure_of([&] { render_video(other, file("%d.png"), def); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, testing::HasSubstr("0.png' is another picture: "));
    EXPECT_TRUE(test::read_file(file("1.png")) == picture);
    // The right picture under another number.
    std::filesystem::copy_file(file("1.png"), file("2.png"),
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(test::failure_of([&] { render_video(film, file("%d.png"), def); }).message,
                testing::HasSubstr("2.png' is another picture: "));
    def.force = true;
    EXPECT_EQ(render_video(film, file("%d.png"), def).kept_frames, 2);
    EXPECT_EQ(render_video(other, file("%d.png"), def).kept_frames, 0);
    EXPECT_FALSE(test::read_file(file("1.png")) == picture);
}

TEST_F(RenderThreads, ContinuePicturesAlone) {
    Film film(long_scene(1));
    RenderDef def;
    def.resume = true;
    for (const char* const name : {"a.mp4", "a.webm"}) {
        Scene scene = film.scene();
        scene.video.encoder.preset.clear();
        const test::Failure failure =
            test::failure_of([&] { std::ignore = check_render(scene, file(name), def); });
        EXPECT_EQ(failure.code, ExitCode::kUsage);
        EXPECT_THAT(failure.message, testing::HasSubstr("-o frames/%06d.png"));
    }
}

TEST_F(RenderThreads, PassOnExceptionsOfTheCallback) {
    Film film(long_scene(3));
    RenderDef def;
    int asked = 0;
    def.on_progress = [&](std::int64_t, std::int64_t) -> bool {
        if (++asked > 3) throw Error(ExitCode::kIo, "the host has enough");
        return true;
    };
    EXPECT_EQ(test::code_of([&] { render_video(film, file("a.mp4"), def); }), ExitCode::kIo);
}

TEST(FilmFrames, AreTheSameInSeveralThreadsAtOnce) {
    const std::vector<std::int64_t> frames{70, 3, 71};
    for (const std::vector<Setting>& settings :
         {std::vector<Setting>{}, std::vector<Setting>{"video.shutter=0.5", "video.subframes=4"}}) {
        const Film film(long_scene(1, settings));
        std::vector<std::vector<Image>> drawn(3);
        std::vector<std::thread> threads;
        for (std::vector<Image>& images : drawn) {
            threads.emplace_back([&] {
                for (const std::int64_t k : frames) images.push_back(film.frame(k));
                images.push_back(film.still(1.01));  // is not recorded
            });
        }
        for (std::thread& thread : threads) thread.join();
        for (const std::vector<Image>& images : drawn) {
            for (std::size_t i = 0; i < frames.size(); ++i)
                EXPECT_TRUE(test::equal_images(images[i], film.frame(frames[i]))) << i;
            EXPECT_TRUE(test::equal_images(images.back(), film.still(1.01)));
        }
    }
}

}  // namespace
}  // namespace corda
