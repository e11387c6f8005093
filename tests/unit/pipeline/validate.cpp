#include "corda/pipeline/validate.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/failure.hpp"

namespace corda::pipeline {
namespace {

using test::failure_of;

TEST(ValidScenes, HaveFromOneFrameToTheLimit) {
    const auto code_of = [](double duration_s, Rational fps) {
        Scene scene;
        scene.world.duration_s = duration_s;
        scene.video.fps = FrameRate(fps);
        return failure_of([&] { validate(scene, {}); }).code;
    };
    EXPECT_EQ(code_of(10.0, {60, 1}), ExitCode::kOk);
    EXPECT_EQ(code_of(1e-9, {1, 1000}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1e10, {1, 1000}), ExitCode::kOk);
    EXPECT_EQ(code_of(1.001e10, {1, 1000}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(100.0, {100'000, 1}), ExitCode::kOk);
    EXPECT_EQ(code_of(101.0, {100'000, 1}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1.0, {100'001, 1}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1.0, {1'000'000'001, 1000}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1.0, {1, -1}), ExitCode::kInvalidScene);
}

TEST(ValidScenes, NameTheirBodiesOnce) {
    Scene scene;
    scene.ropes.resize(2);
    const auto code_of = [&](const std::vector<BodySolverDef>& groups) {
        scene.body_solvers = groups;
        return failure_of([&] { validate(scene, {}); }).code;
    };
    EXPECT_EQ(code_of({{{1}, {}, ExactDef{}}}), ExitCode::kOk);
    EXPECT_EQ(code_of({{{2}, {}, ExactDef{}}}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of({{{1}, {}, ExactDef{}}, {{0, 1}, {}, RattleDef{}}}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of({{{1}, {}, ExactDef{1.0}}}), ExitCode::kInvalidScene);
}

TEST(Times, OfASceneGoToItsEndAndItsLastFrame) {
    Scene scene;
    scene.world.duration_s = 0.1;  // rounded down, by 30 per second a bit less than 3 frames
    scene.video.fps = FrameRate(Rational{30, 1});
    EXPECT_EQ(last_frame_of(scene), 3);
    EXPECT_TRUE(motion_time_s(scene, 0.0).has_value());
    EXPECT_TRUE(motion_time_s(scene, 0.1).has_value());
    EXPECT_TRUE(motion_time_s(scene, std::nextafter(0.1, 1.0)).has_value());
    EXPECT_TRUE(motion_time_s(scene, scene.video.fps.time_s(3)).has_value());
    EXPECT_FALSE(motion_time_s(scene, -0.001).has_value());
    EXPECT_FALSE(motion_time_s(scene, 0.101).has_value());
    EXPECT_FALSE(motion_time_s(scene, std::nan("")).has_value());
    const std::array<double, 2> stills_s{0.05, std::nan("")};
    EXPECT_EQ(failure_of([&] { validate(scene, stills_s); }).code, ExitCode::kUsage);
    EXPECT_EQ(failure_of([&] { validate(scene, std::span(stills_s).first(1)); }).code, ExitCode::kOk);
}

}  // namespace
}  // namespace corda::pipeline
