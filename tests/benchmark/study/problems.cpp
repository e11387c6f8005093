#include "benchmark/study/problems.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "benchmark/study/reference/pendulum.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/recording.hpp"

namespace corda::study {
namespace {

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

constexpr double kTightTolerance = 1e-14;
constexpr double kTightShare = 0.25;  ///< of the step that rattle of order 8 chooses

using SharedRecording = std::shared_ptr<const sim::Recording>;

/// The states at all frames, up to where the run diverges.
SharedRecording record(const Problem& problem, const MethodDef& method) {
    Simulation run(problem.system(), problem.world, method, problem.fps.interval_s());
    const Timeline timeline(problem.fps, problem.last_frame());
    auto frames = std::make_shared<sim::Recording>(run.system().particle_count(), timeline.size());
    while (frames->size() < timeline.size()) {
        if (frames->advance(run, timeline, {}) == Status::kDiverged) break;
    }
    return frames;
}

/// The first `count` frames of a recording.
Reference as_reference(SharedRecording frames, std::size_t count) {
    return [kept = std::move(frames), count](std::int64_t k, State& state) {
        const auto index = static_cast<std::size_t>(k);
        if (index >= count) return false;
        kept->read(index, state);
        return true;
    };
}

/// The number of frames before the horizon. Notes the horizon and the difference up to it.
std::size_t find_horizon(const sim::Recording& first, const sim::Recording& second, Subject& subject) {
    State a;
    State b;
    std::size_t k = 0;
    subject.disagreement = 0.0;
    for (; k < std::min(first.size(), second.size()); ++k) {
        first.read(k, a);
        second.read(k, b);
        const double apart = rms_m(a, b) / subject.problem.length_m;
        if (!(apart <= kHorizonDifference)) break;
        subject.disagreement = std::max(*subject.disagreement, apart);
    }
    const auto last = static_cast<std::int64_t>(k) - 1;
    if (last < subject.problem.last_frame()) subject.horizon_s = subject.problem.fps.time_s(last);
    return k;
}

struct TightRun {
    MethodDef method;
    std::string words;
};

TightRun tight_exact(double tolerance) {
    return {ExactDef{tolerance}, fmt::format("method exact at a tolerance of {:.0e}", tolerance)};
}

TightRun tight_rattle(const Problem& problem, double share) {
    const double step_s = share * rattle_step_s(problem, 8);
    return {RattleDef{8, step_s}, fmt::format("method rattle of order 8 at a step of {:.3g} s", step_s)};
}

}  // namespace

Problem problem_of(const RopeDef& rope, double duration_s) {
    Problem problem;
    problem.length_m = reference::length_m(rope);
    problem.ropes = {rope};
    problem.world.duration_s = duration_s;
    return problem;
}

Problem report_swing() {
    Problem problem = problem_of(reference::report_rope(40), 10.0);
    problem.id = "report_swing";
    problem.title = "The source report's swing as a true chain: 40 particles, 10 s";
    problem.world.gravity_m_s2 = {0.0, -9.8};
    return problem;
}

Problem a01_pendulum() {
    Problem problem = problem_of(reference::straight_rope(1, 1.0, 90.0), 2000.0);
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
    Problem problem = problem_of(reference::straight_rope(20, 1.0, 45.0), 2.0);
    problem.id = "released_chain";
    problem.title = "20 links released from 45 degrees, 2 s";
    return problem;
}

Problem spinning_chain(double omega_1_s) {
    Problem problem = problem_of(reference::spinning_rope(10, 1.0, omega_1_s), 10.0);
    problem.id = "spinning_chain";
    problem.title = "10 links that turn like a rigid rod without gravity, 10 s";
    problem.truth = "the closed form, a rigid rotation";
    problem.world.gravity_m_s2 = {};
    problem.reference = [fps = problem.fps, omega_1_s](std::int64_t k, State& state) {
        const double angle = omega_1_s * fps.time_s(k);
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
    Problem problem = problem_of(reference::released_rope(row), row.time_s);
    problem.truth = "R5";
    problem.reference = [row, last = problem.last_frame()](std::int64_t k, State& state) {
        return k == last && set_tip(row.tip_m, state);
    };
    return problem;
}

bool set_tip(Vec2 tip_m, State& state) {
    std::fill(state.x_m.begin(), state.x_m.end(), std::numeric_limits<double>::quiet_NaN());
    state.x_m.back() = tip_m.x;
    state.y_m.back() = tip_m.y;
    return true;
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

Problem facing(const Subject& subject, const MethodDef& method) {
    Problem problem = subject.problem;
    if (!std::holds_alternative<ExactDef>(method) || !subject.exact_reference) return problem;
    problem.reference = subject.exact_reference;
    problem.truth = subject.exact_truth;
    return problem;
}

void find_truth(Subject& subject) {
    Problem& problem = subject.problem;
    const std::string exact_refusal = refusal(problem, ExactDef{kTightTolerance});
    const bool has_exact = exact_refusal.empty();
    const bool has_rattle = refusal(problem, RattleDef{8}).empty();
    if (!has_exact && !has_rattle) {
        if (!refusal(problem, RelaxationDef{}).empty()) {
            throw_error(ExitCode::kInvalidScene,
                        "{}: no method moves all of its bodies, and a study compares methods; study bodies "
                        "that differ in kind in scenes of their own ({})",
                        problem.title, exact_refusal);
        }
        problem.truth =
            "none, because no method can tell how this scene truly moves; errors of positions are not given";
        return;
    }
    const TightRun first =
        has_exact ? tight_exact(kTightTolerance) : tight_rattle(problem, kTightShare / 2.0);
    const TightRun second =
        has_rattle ? tight_rattle(problem, kTightShare) : tight_exact(10.0 * kTightTolerance);
    const SharedRecording first_run = record(problem, first.method);
    const SharedRecording second_run = record(problem, second.method);
    const std::size_t count = find_horizon(*first_run, *second_run, subject);
    problem.truth = first.words;
    problem.reference = as_reference(first_run, count);
    if (has_exact && has_rattle) {
        subject.exact_truth = second.words;
        subject.exact_reference = as_reference(second_run, count);
    } else {
        problem.truth +=
            " (no other accurate method can run this scene, so that this method's own errors are "
            "measured against a far tighter run of itself)";
    }
}

double rattle_step_s(const Problem& problem, int order) {
    const Simulation run(problem.system(), problem.world, RattleDef{order}, problem.fps.interval_s());
    double shortest_s = HUGE_VAL;
    for (const MethodDef& method : run.methods())
        shortest_s = std::min(shortest_s, std::get<RattleDef>(method).step_s.value());
    return shortest_s;
}

std::string refusal(const Problem& problem, const MethodDef& method) {
    const auto refused = sim::refusal(problem.system(), problem.world, method, problem.fps.interval_s());
    return refused ? refused->what() : "";
}

}  // namespace corda::study
