#include "corda/pipeline/panels.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

#include "corda/media/verify/verify.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using pipeline::PanelRenderer;
using pipeline::Panels;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

/// A rope with a trail; of 12 frames a second.
Scene rope_scene(const std::string& name, double duration_s, const std::vector<Setting>& settings = {}) {
    Scene scene = parse_scene(R"(schema = 1
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 50.0 }
[solver]
method = "exact"
[style]
trail_s = 0.3
[overlay]
title = "a rope"
[video]
size = [64, 48]
fps = 12
)",
                              name + ".toml", settings);
    scene.name = name;
    scene.world.duration_s = duration_s;
    return scene;
}

/// Three rows of one panel each: 12 frames, 6 frames that are blurred, 9 frames at half speed.
std::vector<Scene> three_scenes() {
    std::vector<Scene> scenes{
        rope_scene("long", 1.0),
        rope_scene("blurred", 0.5, {"video.shutter=0.5", "video.subframes=3", "style.theme=\"paper\""}),
        rope_scene("slow", 0.375, {"video.speed=0.5"})};
    lay_out_panels(scenes, 1, 96, 164);
    return scenes;
}

std::vector<Film> films_of(const std::vector<Scene>& scenes, std::size_t budget_bytes = 1U << 20U) {
    std::vector<Film> films;
    FilmDef def;
    def.motion_budget_bytes = budget_bytes;
    for (const Scene& scene : scenes) films.emplace_back(scene, def);
    return films;
}

Image part_of(const Image& whole, int y, int height) {
    Image part(whole.width(), height);
    std::copy_n(whole.pixel(0, y), part.size_bytes(), part.data());
    return part;
}

std::vector<int> widths_of(int panels, int width_px) {
    std::vector<Scene> scenes(static_cast<std::size_t>(panels), rope_scene("a", 1.0));
    lay_out_panels(scenes, panels, width_px, 48);
    std::vector<int> widths;
    for (const Scene& scene : scenes) widths.push_back(scene.video.width_px);
    EXPECT_EQ(panels_video(scenes, panels).width_px, width_px);
    return widths;
}

TEST(Panels, ShareThePictureWithEvenEdges) {
    EXPECT_THAT(widths_of(2, 128), ElementsAre(64, 64));
    EXPECT_THAT(widths_of(3, 1280), ElementsAre(426, 426, 428));
    EXPECT_THAT(widths_of(2, 131), ElementsAre(64, 67));
    EXPECT_THAT(widths_of(1, 131), ElementsAre(131));
}

TEST(Panels, WithoutRoomAreRefused) {
    EXPECT_THAT(widths_of(24, 48), Each(2));
    EXPECT_THAT(widths_of(1, 1), ElementsAre(1));
    const test::Failure failure = test::failure_of([] { widths_of(24, 47); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, HasSubstr("24x1 panels (--panels) have no room in 47x48 pixels (--size)"));
}

TEST(Panels, OfNoGridOrRateAreRefused) {
    std::vector<Scene> scenes(3, rope_scene("a", 1.0));
    EXPECT_THAT(test::failure_of([&] { lay_out_panels(scenes, 2, 128, 48); }).message,
                HasSubstr("3 scenes do not fill 2 columns"));
    EXPECT_EQ(test::code_of([&] { lay_out_panels(scenes, 0, 128, 48); }), ExitCode::kUsage);
    scenes[1].video.width_px = 50;
    EXPECT_EQ(panels_video(scenes, 3).width_px, 64 + 50 + 64);
    EXPECT_THAT(test::failure_of([&] { std::ignore = panels_video(scenes, 1); }).message,
                HasSubstr("fits no grid"));
    scenes[2] = rope_scene("b", 1.0, {"video.fps=24"});
    EXPECT_THAT(test::failure_of([&] { std::ignore = panels_video(scenes, 3); }).message,
                HasSubstr("'b' has 24 frames per second and 'a' has 12; panels have one clock"));
}

TEST(Panels, ShowTheFramesOfEachFilmAndAfterItsEndTheLastOne) {
    const std::vector<Scene> scenes = three_scenes();
    std::vector<Film> films = films_of(scenes);
    std::vector<Film> apart = films_of(scenes);
    const Panels panels(films, 1);
    PanelRenderer renderer(panels);
    for (const std::int64_t k : {0, 1, 2, 8, 9, 5, 6, 7, 10, 11, 11, 3}) {
        renderer.draw(k);
        int y = 0;
        for (Film& film : apart) {
            const int height = film.scene().video.height_px;
            const Image still = film.frame(std::min(k, film.frame_count() - 1));
            EXPECT_TRUE(test::equal_images(part_of(renderer.image(), y, height), still))
                << film.scene().name << k;
            y += height;
        }
        EXPECT_EQ(y, 164);
    }
}

TEST(Panels, TellAllPartsThatChange) {
    std::vector<Film> films = films_of(three_scenes());
    const Panels panels(films, 1);
    PanelRenderer renderer(panels);
    renderer.draw(0);
    for (std::int64_t k = 1; k < 12; ++k) {
        const Image before = renderer.image();
        const Damage damage = renderer.draw(k);
        Image patched = before;
        for (const PixelRect& part : damage)
            for (int y = part.y0; y < part.y1; ++y)
                std::copy_n(renderer.image().pixel(part.x0, y), 4 * part.width(), patched.pixel(part.x0, y));
        EXPECT_TRUE(test::equal_images(patched, renderer.image())) << k;
    }
}

TEST(Panels, HaveTheSameBytesForAnyJobsAndMemory) {
    const test::ScratchFolder folder;
    const std::vector<Scene> scenes = three_scenes();
    RenderDef def;
    def.force = true;
    std::string expected;
    for (const int jobs : {1, 3}) {
        for (const std::size_t budget_bytes : {std::size_t{0}, std::size_t{1} << 20U}) {
            std::vector<Scene> some = scenes;
            for (Scene& scene : some) scene.video.encoder.jobs = jobs;
            std::vector<Film> films = films_of(some, budget_bytes);
            const std::string path = folder.file("a.mp4");
            const Rendered rendered = render_video(films, check_render(some, 1, path, def));
            EXPECT_EQ(rendered.frames, 12);
            EXPECT_EQ(rendered.empty_frames, 0);
            if (expected.empty()) expected = test::read_file(path);
            EXPECT_TRUE(test::read_file(path) == expected) << jobs << ' ' << budget_bytes;
        }
    }
    EXPECT_TRUE(media::verify(folder.file("a.mp4")).ok());
}

TEST(Panels, CountAFrameAsEmptyIfAPanelIs) {
    const test::ScratchFolder folder;
    std::vector<Scene> scenes = three_scenes();
    scenes[1].camera.center_m = Vec2{100.0, 100.0};
    scenes[1].camera.height_m = 1.0;
    scenes[1].overlay.title.clear();
    std::vector<Film> films = films_of(scenes);
    const Rendered rendered = render_video(films, check_render(scenes, 1, folder.file("a.mp4")));
    EXPECT_EQ(rendered.empty_frames, 12);
}

}  // namespace
}  // namespace corda
