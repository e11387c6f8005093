#include "corda/film/scene_renderer.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/film/film_renderer.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"
#include "support/host_context.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using film::SceneRenderer;
using test::equal_images;

/// A rope of two points in a picture of this size.
Scene scene_of(int width_px, int height_px) {
    Scene scene;
    scene.ropes.resize(1);
    scene.ropes[0].points_m = {{0.0, 0.0}, {0.7, -0.5}};
    scene.camera = {Vec2{0.0, 0.0}, 2.0, 0.0};
    scene.solver = ExactDef{};
    scene.video.width_px = width_px;
    scene.video.height_px = height_px;
    return scene;
}

/// A renderer with its scene and system.
struct Show {
    explicit Show(Scene given) : scene(std::move(given)) {}

    Image draw() {
        const SceneRenderer::Use use(renderer);
        renderer.draw({0.0, system.x_m, system.y_m}, renderer.map_of(scene.camera));
        return renderer.image();
    }

    Scene scene;
    System system = system_of(scene);
    SceneRenderer renderer{scene, system, "auto", false};
};

TEST(SceneRenderers, RefuseInvalidScenes) {
    const auto code_of = [](void (*spoil)(Scene&)) {
        Scene scene = scene_of(16, 16);
        spoil(scene);
        return test::failure_of([&] { const Renderer renderer(scene); }).code;
    };
    EXPECT_EQ(code_of([](Scene&) {}), ExitCode::kOk);
    EXPECT_EQ(code_of([](Scene& s) { s.video.height_px = 0; }), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of([](Scene& s) { s.camera.height_m = 0.0; }), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of([](Scene& s) { s.style.rope_width_px = 0.0; }), ExitCode::kInvalidScene);
    EXPECT_EQ(test::failure_of([] {
                  const Scene scene = scene_of(16, 16);
                  const System system = system_of(scene);
                  const SceneRenderer renderer(scene, system, "metal", false);
              }).code,
              ExitCode::kUsage);
}

TEST(SceneRenderers, DrawTheSameIfTheirUsesNest) {
    Show a(scene_of(64, 48));
    Show b(scene_of(40, 40));
    const Image a_alone = a.draw();
    const Image b_alone = b.draw();
    const SceneRenderer::Use use_a(a.renderer);
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(equal_images(b.draw(), b_alone));
        EXPECT_TRUE(equal_images(a.draw(), a_alone));
        Show(scene_of(20, 20)).draw();  // is destroyed here
        const State state{0.0, a.system.x_m, a.system.y_m};
        a.renderer.draw(state, a.renderer.map_of(a.scene.camera));
        EXPECT_TRUE(equal_images(a.renderer.image(), a_alone));
    }
}

TEST(SceneRenderers, DrawTheSameAfterTheHostChangedTheContext) {
    Show a(scene_of(64, 48));
    const Image alone = a.draw();
    const SceneRenderer::Use use(a.renderer);
    const test::HostContext host;
    const State state{0.0, a.system.x_m, a.system.y_m};
    a.renderer.draw(state, a.renderer.map_of(a.scene.camera));
    EXPECT_TRUE(equal_images(a.renderer.image(), alone));
}

TEST(SceneRenderers, RestoreTheContextOfTheHost) {
    const test::HostContext host;
    {
        Show show(scene_of(32, 32));
        show.draw();
        EXPECT_TRUE(host.is_current());
        Film film(show.scene);
        static_cast<void>(film.frame(1));
        static_cast<void>(film.gl());
        EXPECT_TRUE(host.is_current());
    }
    EXPECT_TRUE(host.is_current());
    EXPECT_TRUE(host.is_alive());
}

TEST(SceneRenderers, CanBeUsedByAnotherThreadLater) {
    Show show(scene_of(32, 32));
    const Image here = show.draw();
    std::thread([&] { EXPECT_TRUE(equal_images(show.draw(), here)); }).join();
    EXPECT_TRUE(equal_images(show.draw(), here));
}

/// A rope that fills a picture large enough to be drawn in bands.
Scene large_scene() {
    Scene scene = scene_of(4096, 2048);
    scene.camera = {Vec2{0.35, -0.25}, 0.4, 0.0};
    scene.style.rope_width_px = 1000.0;
    return scene;
}

TEST(LargePictures, AreTheSameIfTheirCallbackDrawsAnotherFilm) {
    const Image alone = Film(large_scene()).frame(1);
    Film film(large_scene());
    Film other(scene_of(40, 40));
    const test::HostContext host;
    const std::vector<std::function<void()>> callbacks{
        [&] { static_cast<void>(other.frame(2)); },
        [&] { host.make_current(); },
    };
    for (const auto& callback : callbacks) {
        int asked = 0;
        {
            const CancelScope calling([&] {
                callback();
                return ++asked > 0;
            });
            EXPECT_TRUE(equal_images(film.frame(1), alone));
        }
        EXPECT_GE(asked, 1);
        EXPECT_TRUE(host.is_current());
        static_cast<void>(film.frame(0));
    }
}

TEST(LargePictures, CanBeCancelled) {
    Film film(large_scene());
    static_cast<void>(film.camera());
    {
        const CancelScope stop = test::cancel_after(0);
        EXPECT_EQ(test::code_of([&] { static_cast<void>(film.frame(0)); }), ExitCode::kInterrupted);
    }
    EXPECT_TRUE(equal_images(film.frame(0), Film(large_scene()).frame(0)));
}

TEST(FilmRenderers, InterleaveWithEachOtherAndTheirFilms) {
    Film a(scene_of(300, 48));  // wider than the tiles of the rope
    Film b(scene_of(40, 40));
    const Image a_first = a.frame(0);
    const Image b_first = b.frame(0);
    FilmRenderer of_a(a);
    FilmRenderer of_b(b);
    EXPECT_EQ(of_a.draw(0.0), Damage{a_first.rect()});
    EXPECT_EQ(of_b.draw(0.0), Damage{b_first.rect()});
    EXPECT_TRUE(equal_images(of_a.image(), a_first));
    EXPECT_TRUE(equal_images(of_b.image(), b_first));
    const Image a_later = a.still(0.1);
    EXPECT_NE(of_a.draw(0.1), Damage{a_first.rect()});
    EXPECT_TRUE(equal_images(of_a.image(), a_later));
}

}  // namespace
}  // namespace corda
