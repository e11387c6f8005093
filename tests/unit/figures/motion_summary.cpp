#include "corda/figures/motion_summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support.hpp"
#include "support/failure.hpp"

namespace corda::figures {
namespace {

constexpr double kWeightN = 2.0 * 9.81;

TEST(MotionSummary, HasTheEnergyAndTheTensionOfAPendulum) {
    ReadScene scene(pendulum_toml());
    ASSERT_EQ(scene.motion.rows, 201);
    const auto y = scene.column("tip.csv", "rope_0_y_m");
    const auto kinetic = scene.column("energy.csv", "kinetic_j");
    const auto weight = scene.column("energy.csv", "weight_since_start_j");
    const auto total = scene.column("energy.csv", "total_since_start_j");
    const auto tension = scene.column("tension.csv", "rope_0_largest_n");
    for (std::size_t k = 0; k < y.size(); ++k) {
        const double fall_m = 4.0 - 0.5 - y[k];           // from half a metre below the pin
        const double cosine = 4.0 - y[k];                 // of the angle, on a link of 1 m
        const double square_speed = 2.0 * 9.81 * fall_m;  // v^2 = 2 g h
        EXPECT_NEAR(kinetic[k], kWeightN * fall_m, 1e-6);
        EXPECT_NEAR(weight[k], -kWeightN * fall_m, 1e-6);
        EXPECT_NEAR(total[k], 0.0, 1e-6);
        EXPECT_NEAR(tension[k], kWeightN * cosine + 2.0 * square_speed, 1e-5);  // m g cos + m v^2 / L
    }
    // At the lowest point T = m g + m v^2 / L = 2 m g. The nearest row is at most half a step of 5 ms away,
    // at 3.13 m/s.
    EXPECT_NEAR(scene.motion.tension.size, 2.0 * kWeightN, 3e-3);
    EXPECT_EQ(scene.motion.tension.index, 0U);
    EXPECT_NEAR(scene.motion.speed.size, std::sqrt(9.81), 1e-4);
    // A quarter of the period at 60 degrees, 1.07318 times that of small swings (R2).
    EXPECT_NEAR(scene.motion.speed.time_s, 1.07318 * 0.5 * std::numbers::pi / std::sqrt(9.81), 3e-3);
    EXPECT_LT(scene.motion.strain.size, 1e-12);
    EXPECT_FALSE(scene.motion.is_elastic);
    EXPECT_FALSE(scene.motion.failure);
}

TEST(MotionSummary, NamesColumnsByDistinctLabels) {
    const std::string rope = "[[rope]]\nhang = { links = 1, length = 2.0 }\n";
    // Copies share the label of their rope.
    const std::string toml = "[world]\nduration = 0.1\n" + rope +
                             "label = \"8 kg\"\ncopies = { count = 2, angle_deg = 1 }\n" + rope +
                             "label = \"8 kg 2\"\n" + rope;
    ReadScene scene(toml);
    for (const char* const key : {"8_kg", "8_kg_2", "8_kg_2_2", "rope_3"})
        EXPECT_EQ(scene.column("tip.csv", std::string(key) + "_x_m").size(), 7U) << key;
}

TEST(MotionSummary, CountsTheAngleFromStraightDown) {
    ReadScene scene(pendulum_toml());
    const auto angle = scene.column("tip.csv", "rope_0_angle_rad");
    const auto rate = scene.column("tip.csv", "rope_0_angular_velocity_rad_s");
    const auto x = scene.column("tip.csv", "rope_0_x_m");
    const auto vx = scene.column("tip.csv", "rope_0_vx_m_s");
    EXPECT_NEAR(angle[0], std::numbers::pi / 3.0, 1e-12);
    for (std::size_t k = 0; k < x.size(); ++k) {
        EXPECT_NEAR(std::sin(angle[k]), x[k] - 3.0, 1e-8);
        EXPECT_NEAR(rate[k] * std::cos(angle[k]), vx[k], 1e-8);
    }
}

/// Fast enough to loop: v^2 = 100 > 5 g L.
std::string looping_toml(const std::string& fps) {
    return "[world]\nduration = 3.0\n[[rope]]\npoints = [[0.0, 0.0], [0.0, -1.0]]\nvelocity = [10.0, "
           "0.0]\n[solver]\nmethod = \"exact\"\n[video]\nfps = " +
           fps + "\n";
}

TEST(MotionSummary, CountsTurnsFromAnyNumberOfRows) {
    const auto many = ReadScene(looping_toml("300")).column("tip.csv", "rope_0_angle_rad");
    const auto few = ReadScene(looping_toml("5")).column("tip.csv", "rope_0_angle_rad");
    EXPECT_TRUE(std::is_sorted(many.begin(), many.end()));
    EXPECT_GT(many.back(), 6.0 * std::numbers::pi);  // measured 8.1 half turns
    ASSERT_EQ(few.size(), 16U);  // one row per 0.2 s, during which it turns by up to 2 rad
    EXPECT_NEAR(few.back(), many.back(), 1e-6);
}

TEST(MotionSummary, IncludesTheEnergyOfASpring) {
    // 1 kg on a spring of 100 N/m, released at rest length: it falls by 2 m g / k and stretches by the same
    // length.
    ReadScene scene(
        "[world]\nduration = 1.0\n[[rope]]\npoints = [[0.0, 0.0], [0.0, -1.0]]\ncompliance = "
        "0.01\n[video]\nfps = 500\n");
    EXPECT_TRUE(scene.motion.is_elastic);
    const auto elastic = scene.column("energy.csv", "elastic_j");
    const auto total = scene.column("energy.csv", "total_since_start_j");
    const double lowest_m = 2.0 * 9.81 / 100.0;
    EXPECT_NEAR(*std::max_element(elastic.begin(), elastic.end()), 0.5 * 100.0 * lowest_m * lowest_m, 1e-3);
    for (const double energy_j : total) EXPECT_NEAR(energy_j, 0.0, 1e-4);
    EXPECT_NEAR(scene.motion.strain.size, lowest_m, 1e-4);
    EXPECT_NEAR(scene.motion.tension.size, 2.0 * 9.81, 1e-2);
}

TEST(MotionSummary, OmitsUnknownTensions) {
    ReadScene scene(
        "[world]\nduration = 0.1\n[[rope]]\nhang = { links = 3, length = 1.0, angle_deg = 9.0 "
        "}\n[[rope]]\nhang = { links = 3, length = 1.0, angle_deg = 9.0 }\n[[solver.bodies]]\nropes = "
        "[0]\nmethod = \"relaxation\"\n[[solver.bodies]]\nropes = [1]\nmethod = \"exact\"\n");
    EXPECT_EQ(scene.motion.unknown_tensions, std::vector<std::size_t>{0});
    EXPECT_EQ(scene.motion.tension.body, 1U);
    for (const auto& row : scene.rows.at("tension.csv")) {
        EXPECT_TRUE(std::isnan(row[1]));
        EXPECT_GT(row[3], 0.0);
    }
    EXPECT_EQ(scene.motion.tensions_n.size(), 3U);
}

TEST(MotionSummary, EndsWhereTheMotionDiverges) {
    ReadScene scene(
        "[world]\nduration = 1.0\ngravity = [1e14, 0.0]\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\npinned "
        "= []\n[solver]\nmethod = \"relaxation\"\n[video]\nfps = 50\n");
    ASSERT_TRUE(scene.motion.failure);
    EXPECT_EQ(scene.motion.failure->code(), ExitCode::kDiverged);
    // The motion exceeds the limit of 1e12 m after sqrt(2e-2) s = 0.141 s.
    EXPECT_EQ(scene.motion.end_s, 0.14);
    EXPECT_EQ(scene.motion.rows, 8);
    EXPECT_EQ(scene.rows.at("tip.csv").size(), 8U);
}

TEST(MotionSummary, HasSmoothPathsBetweenFewFrames) {
    ReadScene scene(pendulum_toml("duration = 1.0", "10"));
    EXPECT_EQ(scene.rows.at("tip.csv").size(), 11U);
    const CurvePoints& path = scene.motion.bodies.at(0).path;
    ASSERT_EQ(path.size(), 81U);  // eight per frame
    for (const view::CurvePoint& point : path) EXPECT_NEAR(std::hypot(point.x, point.y), 1.0, 1e-8);
    EXPECT_EQ(scene.motion.kinetic.size(), 11U);
}

TEST(MotionSummary, HasNoStepsInThePhasePortraitOfRelaxation) {
    const ReadScene scene(
        "[world]\nduration = 1.0\n[[rope]]\nhang = { links = 10, length = 1.0, angle_deg = 60.0 "
        "}\n[solver]\nmethod "
        "= \"relaxation\"\n[video]\nfps = 30\n");
    const BodyCurves& body = scene.motion.bodies.at(0);
    EXPECT_EQ(body.path.size(), 241U);  // eight per frame
    EXPECT_EQ(body.phase.size(), 31U);  // its velocity is constant during a frame
    EXPECT_EQ(body.turning.size(), 31U);
}

TEST(MotionSummary, StopsAtItsCallback) {
    Film film(scene_of(pendulum_toml()), def_of(scene_of(pendulum_toml())));
    const auto open = [](const std::string&, const std::vector<std::string>&) -> OnRow {
        return [](std::span<const double>) {};
    };
    const auto stop = [](std::int64_t done, std::int64_t) { return done < 3; };
    EXPECT_EQ(test::code_of([&] { std::ignore = read_motion(film, open, stop); }), ExitCode::kInterrupted);
}

}  // namespace
}  // namespace corda::figures
