#include "corda/study/problems.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "corda/sim/distance.hpp"
#include "corda/study/pendulum.hpp"
#include "corda/study/ropes.hpp"

namespace corda::study {
namespace {

constexpr double kFramesPerSecond = 60.0;

Problem problem_of(sim::RopeDef rope, double duration_s) {
    Problem problem;
    problem.length_m = length_m(rope);
    problem.ropes = {std::move(rope)};
    problem.world.duration_s = duration_s;
    problem.frame_interval_s = 1.0 / kFramesPerSecond;
    problem.last_frame = std::lround(duration_s * kFramesPerSecond);
    return problem;
}

}  // namespace

BuiltInProblem report_swing() {
    BuiltInProblem result;
    Problem& problem = result.subject.problem;
    problem = problem_of(report_rope(40), 10.0);
    problem.id = "report_swing";
    problem.title = "The source report's swing as a true chain: 40 particles, 10 s";
    problem.world.gravity_m_s2 = {0.0, -9.8};
    result.published.assign(kReportTips.begin(), kReportTips.end());
    return result;
}

BuiltInProblem a01_pendulum() {
    constexpr double kDurationSeconds = 2000.0;
    constexpr double kIntervalSeconds = 0.5;
    BuiltInProblem result;
    Problem& problem = result.subject.problem;
    problem = problem_of(straight_rope(1, 1.0, 90.0), kDurationSeconds);
    problem.id = "a01_pendulum";
    problem.title = "IFToMM A01: a pendulum from the horizontal, 2000 s";
    problem.truth = "closed form: Jacobi's elliptic functions";
    problem.frame_interval_s = kIntervalSeconds;
    problem.last_frame = std::lround(kDurationSeconds / kIntervalSeconds);
    const Pendulum pendulum(std::sqrt(9.81L), std::numbers::pi_v<long double> / 2.0L);
    problem.reference = [pendulum](std::int64_t k, sim::State& state) {
        const sim::Vec2 bob = pendulum.direction(static_cast<long double>(k) * kIntervalSeconds);
        state.x_m = {0.0, bob.x};
        state.y_m = {0.0, bob.y};
        return true;
    };
    return result;
}

BuiltInProblem released_chain() {
    BuiltInProblem result;
    Problem& problem = result.subject.problem;
    problem = problem_of(straight_rope(20, 1.0, 45.0), 2.0);
    problem.id = "released_chain";
    problem.title = "20 links released from 45 degrees, 2 s";
    for (const ReleasedChain& row : kReleasedChains) {
        if (row.links == 20 && row.angle_deg == 45.0) result.published.push_back({row.time_s, row.tip_m});
    }
    return result;
}

BuiltInProblem spinning_chain() {
    constexpr double kRate = 3.0;  // 1/s
    BuiltInProblem result;
    Problem& problem = result.subject.problem;
    problem = problem_of(spinning_rope(10, 1.0, kRate), 10.0);
    problem.id = "spinning_chain";
    problem.title = "10 links turning as a rigid rod without gravity, 10 s";
    problem.truth = "closed form: a rigid rotation";
    problem.world.gravity_m_s2 = {};
    problem.reference = [](std::int64_t k, sim::State& state) {
        const double angle = kRate * static_cast<double>(k) / kFramesPerSecond;
        for (std::size_t i = 0; i < state.x_m.size(); ++i) {
            const double radius_m = 0.1 * static_cast<double>(i);
            state.x_m[i] = radius_m * std::cos(angle);
            state.y_m[i] = radius_m * std::sin(angle);
        }
        return true;
    };
    return result;
}

Problem released_problem(const ReleasedChain& row) {
    Problem problem = problem_of(released_rope(row), row.time_s);
    problem.truth = "PHYSICS section 4, R5";
    problem.reference = [row, last = problem.last_frame](std::int64_t k, sim::State& state) {
        if (k != last) return false;
        std::fill(state.x_m.begin(), state.x_m.end(), std::numeric_limits<double>::quiet_NaN());
        state.x_m.back() = row.tip_m.x;
        state.y_m.back() = row.tip_m.y;
        return true;
    };
    return problem;
}

double distance_from_published(const Problem& problem, const std::vector<PublishedTip>& tips) {
    const std::size_t count = problem.ropes.front().points_m.size();
    sim::State state{0.0, std::vector<double>(count), std::vector<double>(count)};
    double largest_m = 0.0;
    for (const PublishedTip& tip : tips) {
        if (!problem.reference(std::lround(tip.time_s / problem.frame_interval_s), state)) continue;
        largest_m =
            std::max(largest_m, sim::length(state.x_m.back() - tip.tip_m.x, state.y_m.back() - tip.tip_m.y));
    }
    return largest_m / problem.length_m;
}

}  // namespace corda::study
