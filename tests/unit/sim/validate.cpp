#include "corda/sim/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "corda/reference/ropes.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The message of a check; empty if it passes.
std::string problem_of(const std::function<void()>& check) {
    try {
        check();
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Refusal::Reason::kDefinition);
        return refusal.what();
    }
    return "";
}

std::string problem_of(const MethodDef& method) {
    return problem_of([&] { validate(method); });
}

/// The message for a valid rope after a change.
std::string problem_of_rope(const std::function<void(RopeDef&)>& spoil) {
    RopeDef ropes[] = {reference::straight_rope(3, 1.0, 20.0), reference::straight_rope(3, 1.0, 30.0)};
    spoil(ropes[1]);
    return problem_of([&] { validate(ropes, {}); });
}

/// The message for a valid net of three particles after a change.
std::string problem_of_net(const std::function<void(NetDef&)>& spoil) {
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
    net.bars = {{0, 1}, {1, 2}, {0, 2, false}};
    spoil(net);
    return problem_of([&] { validate({}, {&net, 1}); });
}

TEST(ValidateBodies, TakesSoundOnesAndRefusesNone) {
    EXPECT_EQ(problem_of_rope([](RopeDef&) {}), "");
    EXPECT_EQ(problem_of_net([](NetDef&) {}), "");
    EXPECT_EQ(problem_of([] { validate({}, {}); }), "scene: there is neither a rope nor a net");
}

TEST(ValidateBodies, NamesTheRopeAndTheField) {
    const std::pair<std::function<void(RopeDef&)>, const char*> faults[] = {
        {[](RopeDef& rope) { rope.points_m.resize(1); }, "points_m has fewer"},
        {[](RopeDef& rope) { rope.origin_m.x = kInfinity; }, "origin_m"},
        {[](RopeDef& rope) { rope.points_m[2].y = kNaN; }, "points_m"},
        {[](RopeDef& rope) { rope.mass_kg.resize(3, 1.0); }, "mass_kg needs one"},
        {[](RopeDef& rope) { rope.mass_kg.assign(4, 0.0); }, "mass_kg has"},
        {[](RopeDef& rope) { rope.velocity_m_s.resize(3); }, "velocity_m_s needs"},
        {[](RopeDef& rope) {
             rope.velocity_m_s.assign(4, {kNaN, 0.0});
         },
         "velocity_m_s has"},
        {[](RopeDef& rope) {
             rope.pinned = {0, 4};
         },
         "pinned names particle 4 of 4"},
        {[](RopeDef& rope) { rope.material.compliance_1_n = -1.0; }, "compliance_1_n"},
        {[](RopeDef& rope) { rope.reach = 0; }, "reach"},
        {[](RopeDef& rope) { rope.payload_kg = -1.0; }, "payload_kg"},
        {[](RopeDef& rope) { rope.bending_n_m2 = kInfinity; }, "bending_n_m2"},
        {[](RopeDef& rope) { rope.rest_m.assign(4, 1.0); }, "rest_m needs"},
        {[](RopeDef& rope) { rope.rest_m.assign(3, 0.0); }, "rest_m has"},
        {[](RopeDef& rope) {
             rope.points_m.resize(2);
             rope.mass_kg = {};
             rope.velocity_m_s = {};
             rope.closed = true;
         },
         "closed needs at least 3"},
    };
    for (const auto& [spoil, words] : faults) {
        const std::string problem = problem_of_rope(spoil);
        EXPECT_THAT(problem, testing::StartsWith("rope 1: "));
        EXPECT_THAT(problem, testing::HasSubstr(words));
    }
    EXPECT_EQ(problem_of_rope([](RopeDef& rope) {
                  rope.closed = true;
                  rope.rest_m.assign(4, 1.0);
              }),
              "");
}

TEST(ValidateBodies, NamesTheNetAndTheBar) {
    EXPECT_THAT(problem_of_net([](NetDef& net) {
                    net.bars.push_back({0, 3, false});
                }),
                testing::AllOf(testing::StartsWith("net 0: "), testing::HasSubstr("(0, 3)")));
    EXPECT_THAT(problem_of_net([](NetDef& net) {
                    net.bars.push_back({1, 1, false});
                }),
                testing::HasSubstr("(1, 1)"));
    EXPECT_THAT(problem_of_net([](NetDef& net) {
                    net.bars.push_back({2, 1});
                }),
                testing::HasSubstr("a real bar behind an imaginary one"));
    EXPECT_THAT(problem_of_net([](NetDef& net) { net.mass_kg = {1.0}; }), testing::HasSubstr("mass_kg"));
}

TEST(ValidateWorld, RefusesWhatIsOutsideOfTheDeclarations) {
    const auto check = [](const WorldDef& world) { return problem_of([&] { validate(world); }); };
    EXPECT_EQ(check({}), "");
    EXPECT_THAT(check({{0.0, kNaN}}), testing::HasSubstr("gravity_m_s2"));
    for (const double duration_s : {0.0, -1.0, kInfinity, kNaN})
        EXPECT_THAT(check({{}, duration_s}), testing::HasSubstr("duration_s")) << duration_s;
    for (const double drag_1_s : {-1e-3, kInfinity, kNaN})
        EXPECT_THAT(check({{}, 1.0, drag_1_s}), testing::HasSubstr("drag_1_s")) << drag_1_s;
}

TEST(ValidateMethod, TakesTheEndsOfTheRangesAndNothingBeyond) {
    EXPECT_EQ(problem_of(ExactDef{ExactDef::kMinTolerance}), "");
    EXPECT_EQ(problem_of(ExactDef{ExactDef::kMaxTolerance}), "");
    for (const double tolerance : {0.9e-15, 1.1e-2, kNaN})
        EXPECT_EQ(problem_of(ExactDef{tolerance}), "exact: tolerance is not within its range") << tolerance;
    for (const int order : RattleDef::kOrders) EXPECT_EQ(problem_of(RattleDef{order}), "") << order;
    for (const int order : {0, 3, 10}) EXPECT_THAT(problem_of(RattleDef{order}), testing::HasSubstr("order"));
    EXPECT_THAT(problem_of(RattleDef{4, 0.0}), testing::HasSubstr("step_s"));
    EXPECT_EQ(problem_of(RelaxationDef{}), "");
    EXPECT_THAT(problem_of(RelaxationDef{-1.0}), testing::HasSubstr("step_s"));
    EXPECT_THAT(problem_of(RelaxationDef{.sweeps = 0}), testing::HasSubstr("sweeps"));
    EXPECT_THAT(problem_of(RelaxationDef{.delta = 1.0}), testing::HasSubstr("delta"));
    EXPECT_THAT(problem_of(RelaxationDef{.force_n = Vec2{kNaN, 0.0}}), testing::HasSubstr("force_n"));
}

}  // namespace
}  // namespace corda::sim
