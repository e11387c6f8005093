// Method auto: its estimates against numbers worked out by others (R5 and R11). A false
// estimate is a failed test.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/cancel.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"
#include "support/nets.hpp"
#include "support/plan_of.hpp"
#include "support/reference_files.hpp"

namespace corda::sim {
namespace {

const FrameRate kFrames(Rational{60, 1});

/// The plan for one rope, which has to be within `tolerance_m` up to a frame.
BodyPlan plan_of(const RopeDef& rope, double tolerance_m, std::int64_t last_frame) {
    return test::plan_of(build_system({&rope, 1}), WorldDef{}, tolerance_m, kFrames, last_frame);
}

class AutoEstimate : public testing::TestWithParam<std::tuple<std::size_t, double>> {};

TEST_P(AutoEstimate, IsTrueUnderTheHorizon) {
    const auto [row, tolerance] = GetParam();
    const reference::ReleasedChain& chain = reference::kReleasedChains[row];
    const RopeDef rope = reference::released_rope(chain);
    const System system = build_system({&rope, 1});
    const double tolerance_m = tolerance * chain.length_m;
    const BodyPlan plan = plan_of(rope, tolerance_m, kFrames.last_frame_within(chain.time_s));
    EXPECT_LE(plan.error_estimate_m.value(), tolerance_m);
    if (plan.horizon_s) return;  // nothing is estimated at the row's time
    Simulation run(system, WorldDef{}, plan.method, kFrames.interval_s());
    ASSERT_EQ(run.advance_to(chain.time_s), Status::kOk);
    const double error_m =
        std::hypot(run.state().x_m.back() - chain.tip_m.x, run.state().y_m.back() - chain.tip_m.y);
    // Measured: the error is 0.01 .. 0.4 of the estimate.
    EXPECT_LE(error_m, plan.error_estimate_m.value() + 1e-13 * chain.length_m);
}

INSTANTIATE_TEST_SUITE_P(R5, AutoEstimate,
                         testing::Combine(testing::Range<std::size_t>(0, 15),
                                          testing::Values(1e-3, 1e-4, 1e-6, 1e-9)));

/// Runs of so few steps that these follow from nothing but the first one and its growth: a check that took
/// the same steps would see rounding alone.
TEST(AutoPlan, EstimateIsTrueOfAFewSteps) {
    RopeDef spring = reference::straight_rope(1, 84.0, 45.0);
    spring.material.compliance_1_n = 0.005;
    RopeDef beam = reference::straight_rope(3, 1.873, 0.0);
    beam.pinned = {};
    beam.bending_n_m2 = 0.88;
    beam.velocity_m_s.assign(4, {-2.9, 2.2});
    RopeDef string = reference::straight_rope(4, 1.0, 60.0);
    string.rest_m.assign(4, 0.3);
    string.material.is_string = true;
    for (const RopeDef& rope : {spring, beam, string, reference::straight_rope(2, 1.0, 10.0)}) {
        const System system = build_system({&rope, 1});
        for (const double tolerance_m : {1.0, 1e-2, 1e-4, 1e-6}) {
            for (const std::int64_t last_frame : {1, 6, 30}) {
                const BodyPlan plan = plan_of(rope, tolerance_m, last_frame);
                if (plan.horizon_s) continue;
                Simulation run(system, WorldDef{}, plan.method, kFrames.interval_s());
                Simulation truth(system, WorldDef{}, ExactDef{1e-14}, kFrames.interval_s());
                double largest_m = 0.0;
                for (std::int64_t k = 1; k <= last_frame; ++k) {
                    ASSERT_EQ(run.advance_to(kFrames.time_s(k)), Status::kOk);
                    ASSERT_EQ(truth.advance_to(kFrames.time_s(k)), Status::kOk);
                    for (std::size_t i = 0; i < system.particle_count(); ++i) {
                        largest_m =
                            std::max(largest_m, std::hypot(run.state().x_m[i] - truth.state().x_m[i],
                                                           run.state().y_m[i] - truth.state().y_m[i]));
                    }
                }
                // Measured: a third of the estimate, or less than its rounding.
                EXPECT_LE(largest_m, plan.error_estimate_m.value() + 1e-14 * reference::length_m(rope))
                    << std::get<ExactDef>(plan.method).tolerance << " " << last_frame;
                std::printf("few steps: %.1e of %.1e m\n", largest_m, *plan.error_estimate_m);
            }
        }
    }
}

/// A beam of 1 cm whose vibrations are too quick for the tolerance, so that they limit the steps and are
/// damped by a run and its check alike, and a stretching string whose force has a kink.
TEST(AutoPlan, EstimateIsTrueOfStiffBodies) {
    const FrameRate five(Rational{5, 1});
    RopeDef beam = reference::straight_rope(3, 0.01, 10.0);
    beam.bending_n_m2 = 0.88;
    RopeDef string = reference::straight_rope(5, 2.7, 0.0);
    string.material = {1e-4, true};
    string.velocity_m_s.assign(6, {-0.422733, 1.35414});
    string.velocity_m_s.front() = {};
    for (const auto& [rope, tolerance_m, drag_1_s] :
         {std::tuple{beam, 1e-2, 0.0}, {string, 1e-3, 0.5}, {string, 1.8e-5, 0.5}}) {
        const System system = build_system({&rope, 1});
        const WorldDef world{{0.0, -9.81}, 1.5, drag_1_s};
        const BodyPlan plan = test::plan_of(system, world, tolerance_m, five, 7);
        ASSERT_FALSE(plan.horizon_s.has_value());
        Simulation run(system, world, plan.method, five.interval_s());
        Simulation truth(system, world, ExactDef{1e-13}, five.interval_s());
        double largest_m = 0.0;
        for (std::int64_t k = 1; k <= 7; ++k) {
            ASSERT_EQ(run.advance_to(five.time_s(k)), Status::kOk);
            ASSERT_EQ(truth.advance_to(five.time_s(k)), Status::kOk);
            for (std::size_t i = 0; i < system.particle_count(); ++i) {
                largest_m = std::max(largest_m, std::hypot(run.state().x_m[i] - truth.state().x_m[i],
                                                           run.state().y_m[i] - truth.state().y_m[i]));
            }
        }
        std::printf("stiff: %.1e of %.1e m\n", largest_m, *plan.error_estimate_m);
        EXPECT_LE(largest_m, *plan.error_estimate_m);
    }
}

TEST(AutoPlan, FindsNoHorizonWithinTheRegularRowsOfR5) {
    // At a thousandth of the length every row of R5 can be predicted except one: N = 10 at 90 degrees is
    // chaotic past 2 s.
    for (const reference::ReleasedChain& chain : reference::kReleasedChains) {
        const RopeDef rope = reference::released_rope(chain);
        const std::int64_t last_frame = kFrames.last_frame_within(chain.time_s);
        EXPECT_FALSE(plan_of(rope, 1e-3 * chain.length_m, last_frame).horizon_s.has_value())
            << chain.links << " links, " << chain.angle_deg << " degrees, " << chain.time_s << " s";
    }
}

TEST(AutoPlan, SaysWhereAChaoticMotionCanNoLongerBePredicted) {
    const RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    const BodyPlan plan = plan_of(rope, 1e-4, 600);
    ASSERT_TRUE(plan.horizon_s.has_value());
    EXPECT_GT(*plan.horizon_s, 3.0);  // measured 3.9
    EXPECT_LT(*plan.horizon_s, 5.0);  // R5: a perturbation grows by 1e15 in 5 s
}

TEST(AutoEstimate, IsTrueForTheSourceReportsStart) {
    // R11: all 40 particles at 1, 2, 5 and 10 s.
    const RopeDef rope = reference::report_rope(40);
    const System system = build_system({&rope, 1});
    const WorldDef world{{0.0, -9.8}, 10.0, 0.0};
    const BodyPlan plan = test::plan_of(system, world, 1e-3, kFrames, 600);
    ASSERT_FALSE(plan.horizon_s.has_value());
    Simulation run(system, world, plan.method, kFrames.interval_s());
    for (const test::ReportFrame& frame : test::read_report_swing()) {
        ASSERT_EQ(run.advance_to(frame.time_s), Status::kOk);
        for (std::size_t i = 0; i < frame.points_m.size(); ++i) {
            const double error_m = std::hypot(run.state().x_m[i] - frame.points_m[i].x,
                                              run.state().y_m[i] - frame.points_m[i].y);
            EXPECT_LE(error_m, plan.error_estimate_m.value())
                << "particle " << i << " at " << frame.time_s << " s";
        }
    }
}

/// Work of a plan: steps of all trials' runs and first checks, in steps of the run that is drawn.
double steps_per_run(const BodyPlan& plan) {
    double steps = 0.0;
    for (const Trial& trial : plan.trials)
        steps += static_cast<double>(trial.steps) + static_cast<double>(trial.check_steps);
    return steps / static_cast<double>(plan.trials.back().steps);
}

/// A cloth of side x side particles of 10 g on two corners that stretches.
System elastic_cloth(std::uint32_t side, bool is_string) {
    NetDef net = test::cloth(side, side, 2.0 / (side - 1));
    std::erase_if(net.bars, [](const NetBar& bar) { return !bar.is_real; });
    net.mass_kg.assign(net.points_m.size(), 0.01);
    net.material = {1e-3, is_string};
    return build_system({}, {&net, 1});
}

/// A cloth of side x side particles that hangs from two corners and is thrown sideways. Each particle is
/// moved by up to `uneven` of the spacing along each axis, and particle `hole`, below the first row, is
/// missing.
System thrown_cloth(std::uint32_t side, double uneven, std::optional<std::uint32_t> hole) {
    NetDef net = test::cloth(side, side, 1.0 / (side - 1));
    std::erase_if(net.bars,
                  [&](const NetBar& bar) { return !bar.is_real || bar.a == hole || bar.b == hole; });
    for (std::size_t i = 0; i < net.points_m.size(); ++i) {
        const auto number = static_cast<double>(i);
        net.points_m[i] =
            net.points_m[i] + uneven / (side - 1) * Vec2{std::sin(1.7 * number), std::cos(2.9 * number)};
    }
    net.velocity_m_s.assign(net.points_m.size(), {0.5, 0.0});
    if (hole) {
        net.points_m.erase(net.points_m.begin() + *hole);
        net.velocity_m_s.pop_back();
        net.mass_kg.pop_back();
        for (NetBar& bar : net.bars) {
            bar.a -= bar.a > *hole ? 1 : 0;
            bar.b -= bar.b > *hole ? 1 : 0;
        }
    }
    return build_system({}, {&net, 1});
}

System sagging_cloth(std::uint32_t side) {
    NetDef net = test::cloth(side, side, 1.0 / (side - 1));
    std::erase_if(net.bars, [](const NetBar& bar) { return !bar.is_real; });
    for (Vec2& point : net.points_m) point.y -= 0.3 * std::sin(std::numbers::pi * point.x);
    return build_system({}, {&net, 1});
}

/// Scenes that took a hundred times as long as they should, or did not end.
TEST(AutoPlan, EndsWithinALimitOfWork) {
    struct Row {
        std::string name;
        System system;
        std::int64_t last_frame;
        double steps;  ///< of the run that is drawn, at most
        int passes;
        double updates;  ///< work of all trials; the bounds are 1.5 times the measured work
    };
    std::vector<Row> rows;
    const auto add = [&rows](const char* name, const RopeDef& rope, std::int64_t last_frame, double steps,
                             int passes, double updates) {
        rows.push_back({name, build_system({&rope, 1}), last_frame, steps, passes, updates});
    };
    add("1000 links", reference::straight_rope(1000, 1.0, 30.0), 420, 1e4, 2, 4e7);
    add("ring", test::ring(30), 300, 2e3, 12, 3e6);
    RopeDef bridge = reference::straight_rope(300, 1.0, 90.0);
    for (Vec2& point : bridge.points_m) point.y = 1.2 * point.x * (point.x - 1.0);
    bridge.pinned = {0, 300};
    add("bridge", bridge, 120, 3e3, 4, 1.5e4);
    for (std::size_t i = 1; i < 300; ++i)
        bridge.velocity_m_s[i] = {0.0, std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 300.0)};
    add("bridge that swings", bridge, 120, 1e4, 4, 6e6);
    RopeDef hammock = reference::straight_rope(100, 1.0, 90.0);
    for (Vec2& point : hammock.points_m) point.y = 0.4 * std::abs(point.x - 0.5) - 0.2;
    hammock.pinned = {0, 100};
    hammock.material.compliance_1_n = 1e-5;
    add("bridge that stretches", hammock, 60, 3e4, 12, 7e6);
    RopeDef light = reference::straight_rope(1000, 1.0, 30.0);
    light.mass_kg.assign(1001, 1e-3);
    light.material.compliance_1_n = 1e-3;
    add("light rope", light, 60, 5e3, 4, 3e7);
    light.material.compliance_1_n = 1e-6;
    add("stiff light rope", light, 60, 3e3, 4, 1.4e7);
    RopeDef string = reference::straight_rope(40, 1.0, 120.0);
    string.rest_m.assign(40, 1.0 / 40.0);
    string.material.is_string = true;
    add("string", string, 300, 1e5, 18, 5e7);
    rows.push_back({"irregular cloth", thrown_cloth(9, 0.3, {}), 120, 4e3, 9, 5e7});
    rows.push_back({"thrown cloth with a hole", thrown_cloth(8, 0.0, 19), 120, 3e3, 6, 2e7});
    rows.push_back({"sagging cloth", sagging_cloth(20), 60, 100, 4, 6e6});
    rows.push_back({"elastic cloth", elastic_cloth(30, false), 30, 2e3, 4, 2.4e7});
    rows.push_back({"cloth of strings", elastic_cloth(15, true), 30, 2e4, 4, 3e6});
    for (const Row& row : rows) {
        const BodyPlan plan = test::plan_of(row.system, WorldDef{}, 1e-4, kFrames, row.last_frame);
        const Trial& chosen = plan.trials.back();
        double updates = 0.0;
        for (const Trial& trial : plan.trials) updates += trial.updates;
        std::printf("%s: %llu steps, %d passes, %.2g runs, %.3g, %s, reached %g s\n", row.name.c_str(),
                    static_cast<unsigned long long>(chosen.steps), plan.passes, steps_per_run(plan), updates,
                    method_text(plan.method).c_str(), chosen.reached_s);
        EXPECT_LE(static_cast<double>(chosen.steps), row.steps) << row.name;
        EXPECT_LE(plan.passes, row.passes) << row.name;
        EXPECT_LE(updates, row.updates) << row.name;
        EXPECT_LE(steps_per_run(plan), 20.0) << row.name;
        for (const Trial& trial : plan.trials) EXPECT_LE(trial.reached_s, 1.1 * chosen.reached_s) << row.name;
        const auto* rattle = std::get_if<RattleDef>(&plan.method);  // a scene file gives no guard
        EXPECT_TRUE(rattle == nullptr || rattle->guard == RattleDef{}.guard) << row.name;
    }
}

/// 1000 light links that stretch and lean up, stiff ones and ones that resist bending as no rope does:
/// planning takes its budget and no more, and so does a run that it draws.
TEST(AutoPlan, KeepsToItsBudget) {
    RopeDef light = reference::straight_rope(1000, 1.0, 150.0);
    light.mass_kg.assign(1001, 1e-3);
    light.material.compliance_1_n = 1e-3;
    RopeDef stiff = light;
    stiff.material.compliance_1_n = 1e-6;
    RopeDef beam = reference::straight_rope(10, 1.0, 30.0);
    beam.bending_n_m2 = 1e12;
    RopeDef heavy = reference::straight_rope(10, 1.0, 30.0);
    heavy.mass_kg.back() = 2.9e11;
    for (const RopeDef& rope : {light, stiff, beam, heavy}) {
        const System system = build_system({&rope, 1});
        const Timeline timeline(kFrames, 12);
        PlanDef def{[](const MotionBounds&) { return 1e-4; }, timeline, {}, {}};
        def.share = 0.05;
        Recording recording(system.particle_count(), timeline.size());
        const std::uint64_t before = work_done();
        try {
            const BodyPlan plan = plan_body(system, WorldDef{}, def, recording);
            std::printf("%s, reached %g s\n", method_text(plan.method).c_str(), plan.horizon_s.value_or(-1));
            EXPECT_EQ(recording.size(), timeline.size());
            EXPECT_TRUE(plan.unchecked || !plan.error_estimate_m);
        } catch (const Refusal& refusal) {
            EXPECT_EQ(refusal.reason(), Refusal::Reason::kManySteps);
            std::printf("%s\n", refusal.what());
        }
        const auto updates = static_cast<double>(work_done() - before);
        EXPECT_LE(updates, 0.05 * def.most_updates() + def.most_updates_of_run());
    }
}

}  // namespace
}  // namespace corda::sim
