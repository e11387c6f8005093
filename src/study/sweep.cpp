#include "corda/study/sweep.hpp"

#include <cmath>

#include <fmt/format.h>

#include "corda/sim/solver.hpp"
#include "corda/study/truth.hpp"

namespace corda::study {
namespace {

constexpr int kMaxHalvings = 8;

/// A run that would take longer, in seconds, is left out.
double longest_run_s(bool is_quick) {
    return is_quick ? 0.01 : 0.3;
}

/// About how long a run takes, in seconds.
double forecast_s(const System& system, double duration_s, const MethodDef& method, double step_s) {
    double step_ns = 0.0;
    for (const Body& body : system.bodies) step_ns += sim::step_cost_ns(body, method);
    return 1e-9 * step_ns * duration_s / step_s;
}

void add_relaxation(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    constexpr double kMaxStepSeconds = 1.0 / 60.0;
    const double frame_s = problem.fps.interval_s();
    const double longest_step_s = frame_s / std::ceil(frame_s / kMaxStepSeconds - 1e-9);
    const std::size_t bars = problem.system().bars.size();
    for (const int reach : {1, 7}) {
        const Problem reaching = with_reach(problem, reach);
        const System system = reaching.system();
        const bool has_imaginary_bars = system.bars.size() > bars;
        if (reach > 1 && !has_imaginary_bars) continue;
        const bool is_refused = !refusal(reaching, RelaxationDef{longest_step_s}).empty();
        for (const int sweeps : {1, 4, 16, 64}) {
            const std::string label = fmt::format("relaxation, reach {}, sweeps {}", reach, sweeps);
            for (int halving = 0; halving <= kMaxHalvings; halving += is_quick ? 2 : 1) {
                const double step_s = std::ldexp(longest_step_s, -halving);
                const MethodDef method = RelaxationDef{step_s, sweeps};
                const double run_s = forecast_s(system, problem.world.duration_s, method, step_s);
                if (halving > 0 && (is_refused || run_s > longest_run_s(is_quick))) break;
                runs.push_back({method, label, step_s, reach});
            }
        }
    }
}

void add_rattle(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, RattleDef{2}).empty();
    const System system = problem.system();
    const double frame_s = problem.fps.interval_s();
    for (const int order : {2, 4, 6, 8}) {
        const std::string label = fmt::format("rattle, order {}", order);
        if (is_refused) {
            runs.push_back({RattleDef{order}, label, frame_s});
            continue;
        }
        const double steps_per_frame = std::round(frame_s / rattle_step_s(problem, order));
        // High orders reach rounding after a few halvings: they take two points per halving.
        const bool is_high = order >= 6;
        const int points_per_halving = is_high && !is_quick ? 2 : 1;
        const int last_point = points_per_halving * (is_high ? 2 : kMaxHalvings);
        for (int point = 0; point <= last_point; ++point) {
            const double finer = std::exp2(static_cast<double>(point) / points_per_halving);
            const double step_s = frame_s / std::round(steps_per_frame * finer);
            const MethodDef method = RattleDef{order, step_s};
            const double run_s = forecast_s(system, problem.world.duration_s, method, step_s);
            if (point > 0 && run_s > longest_run_s(is_quick)) break;
            runs.push_back({method, label, step_s});
        }
    }
}

void add_exact(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, ExactDef{}).empty();
    for (int digits = 2; digits <= 13; digits += is_quick ? 2 : 1) {
        const double tolerance = std::stod(fmt::format("1e-{}", digits));
        runs.push_back({ExactDef{tolerance}, "exact", tolerance});
        if (is_refused) break;
    }
}

}  // namespace

std::vector<SweepRun> sweep_runs(const Problem& problem, bool is_quick) {
    std::vector<SweepRun> runs;
    add_relaxation(problem, is_quick, runs);
    add_rattle(problem, is_quick, runs);
    add_exact(problem, is_quick, runs);
    return runs;
}

}  // namespace corda::study
