#include "benchmark/peers/peer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>

#include "benchmark/study/reference/ropes.hpp"

namespace corda::peers {
namespace {

/// CPU time of a run after which the sweep of a series ends: if an error of kGood was reached, and if not.
constexpr double kLongestGoodRun_s = 0.1;
constexpr double kLongestRun_s = 1.0;
constexpr double kGood = 1e-9;
constexpr double kTimed_s = 0.02;  ///< of CPU time that the repeats of a short run take in all

/// Errors above it still fall when steps get shorter.
constexpr double kFloor = 1e-3;

double cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Problem problem_of(const std::string& id, const RopeDef& rope, double duration_s) {
    Problem problem;
    problem.id = id;
    problem.system = build_system({&rope, 1});
    problem.world.duration_s = duration_s;
    problem.frames = static_cast<int>(std::lround(duration_s * Problem::kFps));
    problem.length_m = reference::length_m(rope);
    return problem;
}

/// 20 x 20 particles, pinned along the upper row and sheared to an angle of 30 degrees.
Problem net() {
    constexpr std::uint32_t kSide = 20;
    constexpr double kSpacing_m = 0.05;
    constexpr double kStiffness_n_m = 1000.0;
    NetDef net;
    for (std::uint32_t row = 0; row < kSide; ++row) {
        for (std::uint32_t column = 0; column < kSide; ++column) {
            net.points_m.push_back({kSpacing_m * (column + 0.5 * row), -kSpacing_m * row * std::sqrt(0.75)});
            const std::uint32_t i = row * kSide + column;
            if (row == 0) net.pinned.push_back(i);
            if (column + 1 < kSide) net.bars.push_back({i, i + 1});
            if (row + 1 < kSide) net.bars.push_back({i, i + kSide});
        }
    }
    net.mass_kg.assign(net.points_m.size(), 0.01);
    net.material.compliance_1_n = 1.0 / (kStiffness_n_m * kSpacing_m);
    Problem problem;
    problem.id = "net";
    problem.system = build_system({}, {&net, 1});
    problem.frames = 120;
    problem.length_m = kSpacing_m * (kSide - 1);
    problem.stiffness_n_m = kStiffness_n_m;
    return problem;
}

Problem bending() {
    RopeDef rope = reference::straight_rope(20, 1.0, 90.0);
    rope.mass_kg.assign(rope.points_m.size(), 0.05);
    rope.bending_n_m2 = 0.2;
    Problem problem = problem_of("bending", rope, 2.0);
    problem.bend_n_m = problem.system.bends[0].stiffness_n_m;
    return problem;
}

Problem string() {
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {0.6, 0.0}});
    rope.rest_m = {1.0};
    rope.material.is_string = true;
    Problem problem = problem_of("string", rope, 3.0);
    problem.length_m = 1.0;
    problem.is_string = true;
    return problem;
}

double energy_j(const Problem& problem, const State& state) {
    const System& system = problem.system;
    double sum_j = 0.0;
    for (std::size_t i = 0; i < problem.count(); ++i) {
        if (system.is_pinned(i)) continue;
        const double vx = state.vx_m_s[i];
        const double vy = state.vy_m_s[i];
        sum_j += system.mass_kg[i] * (0.5 * (vx * vx + vy * vy) + problem.gravity() * state.y_m[i]);
    }
    const auto between = [&](std::size_t a, std::size_t b) {
        return Vec2{state.x_m[b] - state.x_m[a], state.y_m[b] - state.y_m[a]};
    };
    for (const Bar& bar : system.bars) {
        const Vec2 along = between(bar.a, bar.b);
        const double stretch_m = std::sqrt(dot(along, along)) - bar.rest_m;
        sum_j += 0.5 * problem.stiffness_n_m * stretch_m * stretch_m;
    }
    for (const Bend& bend : system.bends) {
        const Vec2 first = between(bend.a, bend.b);
        const Vec2 second = between(bend.b, bend.c);
        sum_j += bend.stiffness_n_m *
                 (1.0 - dot(first, second) / std::sqrt(dot(first, first) * dot(second, second)));
    }
    return sum_j;
}

double energy_scale_j(const Problem& problem) {
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < problem.count(); ++i) {
        if (!problem.system.is_pinned(i)) mass_kg += problem.system.mass_kg[i];
    }
    return mass_kg * problem.gravity() * problem.length_m;
}

void read_truth(const std::string& folder, Problem& problem) {
    std::ifstream file(truth_path(folder, problem), std::ios::binary);
    problem.truth.assign(static_cast<std::size_t>(problem.frames), start_of(problem));
    for (State& state : problem.truth) {
        for (std::vector<double>* values : {&state.x_m, &state.y_m, &state.vx_m_s, &state.vy_m_s}) {
            file.read(reinterpret_cast<char*>(values->data()),
                      static_cast<std::streamsize>(values->size() * sizeof(double)));
        }
    }
    if (!file) throw std::runtime_error("no truth for problem " + problem.id + " in " + folder);
}

struct Result {
    double error = 0.0;
    double energy_error = 0.0;
    double run_s = 0.0;
    std::string failure;
};

/// Goes through all frames. CPU time in seconds.
double time_of(const Problem& problem, Run& run) {
    const double from_s = cpu_s();
    for (int k = 1; k <= problem.frames; ++k) run.advance(k / Problem::kFps);
    return cpu_s() - from_s;
}

void compare(const Problem& problem, Run& run, Result& result) {
    State state = start_of(problem);
    const double scale_j = energy_scale_j(problem);
    for (int k = 1; k <= problem.frames; ++k) {
        const double from_s = cpu_s();
        run.advance(k / Problem::kFps);
        result.run_s += cpu_s() - from_s;
        run.read(state);
        const State& truth = problem.truth[static_cast<std::size_t>(k - 1)];
        for (std::size_t i = 0; i < problem.count(); ++i) {
            const double dx = state.x_m[i] - truth.x_m[i];
            const double dy = state.y_m[i] - truth.y_m[i];
            const double apart = std::sqrt(dx * dx + dy * dy) / problem.length_m;
            // More than the size of the problem: the run left it.
            if (!(apart < 3.0)) throw Failure("diverged");
            result.error = std::max(result.error, apart);
        }
        const double apart_j = std::abs(energy_j(problem, state) - energy_j(problem, truth));
        result.energy_error = std::max(result.energy_error, apart_j / scale_j);
    }
}

Result measure(const Problem& problem, const Series& series, double value) {
    Result result;
    try {
        compare(problem, *series.make(problem, value), result);
        double sum_s = result.run_s;
        for (int repeat = 0; repeat < 200 && (sum_s < kTimed_s || repeat < 2) && result.run_s < 0.5;
             ++repeat) {
            const double run_s = time_of(problem, *series.make(problem, value));
            result.run_s = std::min(result.run_s, run_s);
            sum_s += run_s;
        }
    } catch (const std::exception& error) {
        result.failure = error.what();
        std::replace_if(
            result.failure.begin(), result.failure.end(),
            [](char c) { return c == ',' || c == '\n' || c == '"'; }, ' ');
    }
    return result;
}

void run_series(const std::string& head, const Problem& problem, const Series& series) {
    double best = std::numeric_limits<double>::infinity();
    int without_gain = 0;
    for (const double value : series.values) {
        const Result result = measure(problem, series, value);
        std::printf("%s,%s,%s,%g,%.4g,%.4g,%.5g,%s\n", head.c_str(), series.method.c_str(),
                    series.parameter.c_str(), value, result.error, result.energy_error,
                    1e3 * result.run_s / problem.world.duration_s, result.failure.c_str());
        std::fflush(stdout);
        if (result.run_s > (best < kGood ? kLongestGoodRun_s : kLongestRun_s)) return;
        if (!result.failure.empty()) continue;
        // Beyond the floor of rounding, smaller steps only cost time.
        without_gain = result.error < 0.7 * best ? 0 : without_gain + 1;
        best = std::min(best, result.error);
        if (without_gain == 3 && best < kFloor) return;
    }
}

}  // namespace

SteppedRun::SteppedRun(const Problem& problem, double steps_per_frame)
    : step_s_(1.0 / (Problem::kFps * steps_per_frame)), steps_(static_cast<int>(steps_per_frame)) {
    if (steps_ == 0) from_ = to_ = start_of(problem);
}

void SteppedRun::advance(double time_s) {
    for (int i = 0; i < steps_; ++i) step();
    constexpr double kRounding = 1e-9;  // of a step
    for (time_s_ = time_s; steps_ == 0 && to_.time_s < time_s - kRounding * step_s_;) {
        std::swap(from_, to_);
        step();
        read_step(to_);
        to_.time_s = from_.time_s + step_s_;
    }
}

void SteppedRun::read(State& state) {
    if (steps_ > 0) return read_step(state);
    const double x = (time_s_ - from_.time_s) / step_s_;
    const auto interpolate = [&](const std::vector<double> State::*position,
                                 const std::vector<double> State::*velocity, std::vector<double>& at,
                                 std::vector<double>& speed) {
        for (std::size_t i = 0; i < at.size(); ++i) {
            const double moved = (to_.*position)[i] - (from_.*position)[i];
            const double first = step_s_ * (from_.*velocity)[i];
            const double last = step_s_ * (to_.*velocity)[i];
            const double square = 3.0 * moved - 2.0 * first - last;
            const double cube = first + last - 2.0 * moved;
            at[i] = (from_.*position)[i] + x * (first + x * (square + x * cube));
            speed[i] = (first + x * (2.0 * square + 3.0 * x * cube)) / step_s_;
        }
    };
    interpolate(&State::x_m, &State::vx_m_s, state.x_m, state.vx_m_s);
    interpolate(&State::y_m, &State::vy_m_s, state.y_m, state.vy_m_s);
}

State start_of(const Problem& problem) {
    const System& system = problem.system;
    return {0.0, system.x_m, system.y_m, system.vx_m_s, system.vy_m_s};
}

double Problem::start_angle() const {
    return std::atan2(system.y_m[1] - system.y_m[0], system.x_m[1] - system.x_m[0]);
}

std::vector<Problem> problems() {
    Problem swing = problem_of("swing", reference::report_rope(40), 10.0);
    swing.world.gravity_m_s2 = {0.0, -9.8};
    std::vector<Problem> all{swing, problem_of("chain", reference::straight_rope(10, 1.0, 90.0), 2.0)};
    RopeDef heavy = reference::straight_rope(10, 1.0, 90.0);
    heavy.mass_kg.back() = 1000.0;
    all.push_back(problem_of("payload", heavy, 2.0));
    for (Problem (*make)() : {net, bending, string}) all.push_back(make());
    for (Problem& problem : all) problem.world.duration_s = problem.frames / Problem::kFps;
    return all;
}

std::string truth_path(const std::string& folder, const Problem& problem) {
    return folder + "/" + problem.id + ".truth";
}

std::vector<double> step_counts() {
    constexpr double kFine = 16.0;
    std::vector<double> values{0.25, 0.5};
    for (double value = 1.0; value < 1e6; value *= value < kFine ? 2.0 : 4.0) values.push_back(value);
    return values;
}

std::vector<double> powers_of_ten(int first, int last) {
    std::vector<double> values;
    for (int k = first; k <= last; ++k) values.push_back(std::pow(10.0, -k));
    return values;
}

int run_peer(int argc, char** argv, const std::string& name, const std::string& version,
             const std::vector<Series>& all_series) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s TRUTH_FOLDER [PROBLEM ...]\n", argv[0]);
        return 2;
    }
    const std::vector<std::string> names(argv + 2, argv + argc);
    for (Problem& problem : problems()) {
        if (!names.empty() && std::find(names.begin(), names.end(), problem.id) == names.end()) continue;
        read_truth(argv[1], problem);
        for (const Series& series : all_series) {
            if (series.can_run(problem)) run_series(problem.id + "," + name + "," + version, problem, series);
        }
    }
    return 0;
}

}  // namespace corda::peers
