#include "corda/render/canvas.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "corda/film/film.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"
#include "support/host_context.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using render::CanvasUse;
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

/// A list of one capsule.
view::DrawList list_of(int width_px, int height_px, double x_px) {
    view::DrawList list;
    list.width = width_px;
    list.height = height_px;
    list.add_layer({255, 255, 255, 255});
    list.add_capsule({x_px, 10.0}, {x_px + 5.0, 20.0}, 4.0);
    return list;
}

TEST(Renderers, RefuseInvalidScenes) {
    const auto code_of = [](void (*spoil)(Scene&), const char* backend = "auto") {
        Scene scene = scene_of(16, 16);
        spoil(scene);
        return test::failure_of([&] { const Renderer renderer(scene, backend); }).code;
    };
    EXPECT_EQ(code_of([](Scene&) {}), ExitCode::kOk);
    EXPECT_EQ(code_of([](Scene& s) { s.video.height_px = 0; }), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of([](Scene& s) { s.camera.height_m = 0.0; }), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of([](Scene& s) { s.style.rope_width_px = 0.0; }), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of([](Scene&) {}, "metal"), ExitCode::kUsage);
}

TEST(Canvases, DrawListsOfAnySizeInAnyOrder) {
    const CanvasUse canvas({});
    for (const auto& [width_px, x_px] : {std::pair(64, 5.0), std::pair(64, 40.0), std::pair(300, 40.0),
                                         std::pair(64, 5.0), std::pair(300, 200.0)}) {
        const view::DrawList list = list_of(width_px, 48, x_px);
        canvas->paint(list);
        EXPECT_TRUE(equal_images(canvas->image(), render::render_reference(list))) << width_px << " " << x_px;
    }
}

TEST(Canvases, TellWhatMayDifferFromTheirLastPicture) {
    const CanvasUse canvas({});
    const PixelRect all{0, 0, 310, 48};  // wider than the tiles of the capsule
    EXPECT_EQ(canvas->paint(list_of(310, 48, 5.0)), Damage{all});
    EXPECT_NE(canvas->paint(list_of(310, 48, 7.0)), Damage{all});
}

TEST(Canvases, NestAndAreKeptByTheirThread) {
    const view::DrawList list = list_of(64, 48, 5.0);
    const Image expected = render::render_reference(list);
    const gl::Context* first = nullptr;
    {
        const CanvasUse outer({});
        first = &outer->context();
        for (int i = 0; i < 2; ++i) {
            const CanvasUse inner({});
            EXPECT_NE(&inner->context(), first);
            inner->paint(list_of(40, 40, 3.0));
            outer->paint(list);
            EXPECT_TRUE(equal_images(outer->image(), expected));
        }
    }
    EXPECT_EQ(&CanvasUse({})->context(), first);
    std::thread([&] {
        const CanvasUse other({});
        EXPECT_NE(&other->context(), first);
        other->paint(list);
        EXPECT_TRUE(equal_images(other->image(), expected));
    }).join();
}

TEST(Canvases, DrawTheSameAfterTheHostChangedTheContext) {
    const view::DrawList list = list_of(64, 48, 5.0);
    const CanvasUse canvas({});
    const test::HostContext host;
    canvas->paint(list);
    EXPECT_TRUE(equal_images(canvas->image(), render::render_reference(list)));
}

TEST(Canvases, RestoreTheContextOfTheHost) {
    const test::HostContext host;
    {
        const Film film(scene_of(32, 32));
        static_cast<void>(film.frame(1));
        EXPECT_TRUE(host.is_current());
        static_cast<void>(film.gl());
        static_cast<void>(Renderer(film.scene()).draw(std::vector<Vec2>{{0.0, 0.0}, {0.1, 0.1}}));
        EXPECT_TRUE(host.is_current());
    }
    EXPECT_TRUE(host.is_current());
    EXPECT_TRUE(host.is_alive());
}

/// A rope that fills a picture large enough to be drawn in bands.
Scene large_scene() {
    Scene scene = scene_of(4096, 2048);
    scene.camera = {Vec2{0.35, -0.25}, 0.4, 0.0};
    scene.style.rope_width_px = 1000.0;
    return scene;
}

TEST(LargePictures, AreTheSameIfTheirCallbackDraws) {
    const Film film(large_scene());
    const Film other(scene_of(40, 40));
    const Image alone = film.frame(1);
    const test::HostContext host;
    const std::vector<std::function<void()>> callbacks{
        [&] { static_cast<void>(other.frame(2)); },
        [&] { static_cast<void>(film.mask(2)); },
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
    const Film film(large_scene());
    const Image expected = film.frame(0);
    static_cast<void>(film.frame(1));
    {
        const CancelScope stop = test::cancel_after(0);
        EXPECT_EQ(test::code_of([&] { static_cast<void>(film.frame(0)); }), ExitCode::kInterrupted);
    }
    EXPECT_TRUE(equal_images(film.frame(0), expected));
}

}  // namespace
}  // namespace corda
