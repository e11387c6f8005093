#include "corda/study/problems.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "corda/core/text.hpp"
#include "corda/reference/pendulum.hpp"
#include "corda/reference/ropes.hpp"

namespace corda::study {
namespace {

Problem problem_with(RopeDef rope, double duration_s) {
    Problem problem;
    problem.length_m = reference::length_m(rope);
    problem.ropes = {std::move(rope)};
    problem.world.duration_s = duration_s;
    return problem;
}

/// A scene's name as an id, of which names of files are made.
std::string id_of(std::string_view name) {
    constexpr std::size_t kLongest = 100;
    std::string id;
    for (const char c : name.substr(0, kLongest)) {
        const bool is_upper = c >= 'A' && c <= 'Z';
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        id += is_upper ? static_cast<char>(c - 'A' + 'a') : (is_plain ? c : '_');
    }
    return id;
}

}  // namespace

Problem report_swing() {
    Problem problem = problem_with(reference::report_rope(40), 10.0);
    problem.id = "report_swing";
    problem.title = "The source report's swing as a true chain: 40 particles, 10 s";
    problem.world.gravity_m_s2 = {0.0, -9.8};
    return problem;
}

Problem a01_pendulum() {
    Problem problem = problem_with(reference::straight_rope(1, 1.0, 90.0), 2000.0);
    problem.id = "a01_pendulum";
    problem.title = "IFToMM A01: a pendulum from the horizontal, 2000 s";
    problem.truth = "the closed form by Jacobi's elliptic functions";
    problem.fps = FrameRate(Rational{2, 1});
    const reference::Pendulum pendulum(std::sqrt(9.81L), std::numbers::pi_v<long double> / 2.0L);
    problem.reference = [pendulum](std::int64_t k, State& state) {
        const Vec2 bob = pendulum.direction(static_cast<long double>(k) / 2.0L);
        state.x_m = {0.0, bob.x};
        state.y_m = {0.0, bob.y};
        return true;
    };
    return problem;
}

Problem released_chain() {
    Problem problem = problem_with(reference::straight_rope(20, 1.0, 45.0), 2.0);
    problem.id = "released_chain";
    problem.title = "20 links released from 45 degrees, 2 s";
    return problem;
}

Problem spinning_chain() {
    constexpr double kOmega = 3.0;  // 1/s
    Problem problem = problem_with(reference::spinning_rope(10, 1.0, kOmega), 10.0);
    problem.id = "spinning_chain";
    problem.title = "10 links that turn like a rigid rod without gravity, 10 s";
    problem.truth = "the closed form, a rigid rotation";
    problem.world.gravity_m_s2 = {};
    problem.reference = [fps = problem.fps](std::int64_t k, State& state) {
        const double angle = kOmega * fps.time_s(k);
        for (std::size_t i = 0; i < state.x_m.size(); ++i) {
            const double radius_m = 0.1 * static_cast<double>(i);
            state.x_m[i] = radius_m * std::cos(angle);
            state.y_m[i] = radius_m * std::sin(angle);
        }
        return true;
    };
    return problem;
}

Problem released_problem(const reference::ReleasedChain& row) {
    Problem problem = problem_with(reference::released_rope(row), row.time_s);
    problem.truth = "R5";
    problem.reference = [row, last = problem.last_frame()](std::int64_t k, State& state) {
        if (k != last) return false;
        std::fill(state.x_m.begin(), state.x_m.end(), std::numeric_limits<double>::quiet_NaN());
        state.x_m.back() = row.tip_m.x;
        state.y_m.back() = row.tip_m.y;
        return true;
    };
    return problem;
}

Problem problem_of(const Scene& scene) {
    Problem problem;
    problem.id = id_of(scene.name);
    problem.title = printable(scene.name);
    problem.ropes = scene.ropes;
    problem.nets = scene.nets;
    problem.world = scene.world;
    problem.fps = scene.video.fps;
    problem.length_m = largest_length_m(problem.system());
    return with_reach(problem, 1);
}

}  // namespace corda::study
