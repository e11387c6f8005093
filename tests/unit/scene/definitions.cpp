// Definitions that code fills in are checked by the schema of scene files.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "corda/core/image.hpp"
#include "support/failure.hpp"
#include "unit/scene/support.hpp"

namespace corda {
namespace {

const double kNone = std::nan("");
const double kInfinity = std::numeric_limits<double>::infinity();

Scene sound() {
    Scene scene = parse_scene(scene::rope_with("[golden]\nat = [0, 1]\n"), "scene.toml");
    scene.source.clear();
    return scene;
}

/// The message about a scene that `change` has changed; empty if it is accepted.
std::string message_of(const std::function<void(Scene&)>& change) {
    Scene scene = sound();
    change(scene);
    const test::Failure failure = test::failure_of([&] { check_definitions(scene); });
    if (failure.code == ExitCode::kOk) return "";
    EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
    return failure.message;
}

TEST(Definitions, OfAFileAreSound) {
    EXPECT_EQ(message_of([](Scene&) {}), "");
}

TEST(Definitions, AreRefusedByKeyValueAndRange) {
    EXPECT_EQ(message_of([](Scene& scene) { scene.style.trail_s = -0.5; }),
              "style.trail_s: -0.5 is not >= 0; give the time for which the path of a particle "
              "stays in s, 0 .. 3600");
    EXPECT_EQ(message_of([](Scene& scene) {
                  scene.camera.center_m = Vec2{0.0, kNone};
              }),
              "camera.center[1]: nan is not a finite number; give the position in the middle of the picture "
              "in m, -1e9 .. 1e9, as [x, y]");
    EXPECT_EQ(message_of([](Scene& scene) { scene.video.height_px = 0; }),
              "video.size[1]: 0 is not >= 1; give the size of the picture in px, 1 .. 16384, as [width, "
              "height] or \"4k\" or \"1080p\" or \"square\" or \"portrait\"");
}

TEST(Definitions, HaveValuesWithinTheirRange) {
    using Set = std::function<void(Scene&, double)>;
    struct Case {
        const char* key;
        Set set;
        std::vector<double> bad;
    };
    for (const Case& one : std::vector<Case>{
             {"style.rope_width_px", [](Scene&s, double v) { s.style.rope_width_px = v; }, {0.09, 1001.0}},
             {"style.net_width_px", [](Scene&s, double v) { s.style.net_width_px = v; }, {0.0, -1.0}},
             {"style.marker_radius_px", [](Scene&s, double v) { s.style.marker_radius_px = v; }, {0.0}},
             {"style.payload_radius", [](Scene&s, double v) { s.style.payload_radius_m = v; }, {0.0, 1e10}},
             {"style.arrow_scale", [](Scene&s, double v) { s.style.arrow_scale_px = v; }, {0.0, 1e13}},
             {"style.bar_width_px", [](Scene&s, double v) { s.style.bar_width_px = v; }, {1001.0}},
             {"style.trail_s", [](Scene&s, double v) { s.style.trail_s = v; }, {-0.1, 3601.0}},
             {"rope[0].width_px", [](Scene&s, double v) { s.body_styles[0].width_px = v; }, {0.0, 1001.0}},
             {"overlay.text_px", [](Scene&s, double v) { s.overlay.text_px = v; }, {3.9, 401.0}},
             {"camera.height", [](Scene&s, double v) { s.camera.height_m = v; }, {0.0, -1.0}},
             {"camera.margin", [](Scene&s, double v) { s.camera.margin = v; }, {-0.01, 0.46}},
             {"world.duration", [](Scene&s, double v) { s.world.duration_s = v; }, {0.0}},
             {"world.drag", [](Scene&s, double v) { s.world.drag_1_s = v; }, {-1.0}},
             {"video.shutter", [](Scene&s, double v) { s.video.shutter = v; }, {-0.1, 1.1}},
             {"solver.tolerance_px", [](Scene&s, double v) { s.solver = AutoDef{v}; }, {0.0}},
             {"solver.tolerance", [](Scene&s, double v) { s.solver = ExactDef{v}; }, {1e-16, 0.1}},
             {"solver.step", [](Scene&s, double v) { s.solver = RattleDef{.step_s = v}; }, {0.0, 1e-10}},
             {"solver.delta", [](Scene&s, double v) { s.solver = RelaxationDef{.delta = v}; }, {1.0}},
             {"golden.max", [](Scene&s, double v) { s.golden->max = v; }, {256.0}},
             {"golden.mean", [](Scene&s, double v) { s.golden->mean = v; }, {-1.0}},
         }) {
        for (const double value : one.bad)
            EXPECT_THAT(message_of([&](Scene& scene) { one.set(scene, value); }),
                        testing::StartsWith(std::string(one.key) + ": "))
                << value;
        for (const double value : {kNone, kInfinity})
            EXPECT_THAT(message_of([&](Scene& scene) { one.set(scene, value); }),
                        testing::HasSubstr("is not a finite number"))
                << one.key;
    }
}

TEST(Definitions, HaveKnownWords) {
    EXPECT_THAT(message_of([](Scene& scene) { scene.style.bars = static_cast<Bars>(7); }),
                testing::HasSubstr("style.bars: \"?\" is unknown"));
    EXPECT_THAT(message_of([](Scene& scene) { scene.video.encoder.codec = "h2645"; }),
                testing::HasSubstr("video.codec: \"h2645\" is unknown; did you mean \"h264\"?"));
    EXPECT_THAT(message_of([](Scene& scene) { scene.solver = RattleDef{.order = 3}; }),
                testing::HasSubstr("solver.order: 3 is not allowed; give one of: 2, 4, 6, 8"));
}

TEST(Definitions, AreSoundTogether) {
    EXPECT_THAT(message_of([](Scene& scene) { scene.video.width_px = scene.video.height_px = kMaxSidePx; }),
                testing::StartsWith("video.size: 16384 x 16384 are 268435456 pixels, over the limit"));
    EXPECT_THAT(message_of([](Scene& scene) {
                    scene.video.speed = {1, 100'000'000};
                }),
                testing::StartsWith("video.speed: 1/100000000 is out of range"));
    EXPECT_THAT(message_of([](Scene& scene) {
                    scene.video.fps = FrameRate({999'999'937, 10'000'000});
                    scene.video.speed = {1, 3};
                }),
                testing::StartsWith("video.speed: 999999937/10000000 frames per second at this speed are "
                                    "2999999811/10000000 per second of the scene"));
    EXPECT_THAT(message_of([](Scene& scene) { scene.overlay.title = "\xF0\x9F\xA7\xB6"; }),
                testing::StartsWith("overlay.font: DejaVu Sans has no U+1F9F6"));
    EXPECT_THAT(message_of([](Scene& scene) {
                    scene.golden->at_s = {1.0, 0.5};
                }),
                testing::StartsWith("golden.at: 0.5 s after 1 s; give times that increase"));
}

TEST(Definitions, AllProblemsAreNamed) {
    const std::string message = message_of([](Scene& scene) {
        scene.world.drag_1_s = -1.0;
        scene.camera.margin = 2.0;
    });
    EXPECT_THAT(message, testing::HasSubstr("world.drag: "));
    EXPECT_THAT(message, testing::HasSubstr("\ncamera.margin: "));
}

}  // namespace
}  // namespace corda
