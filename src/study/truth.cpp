#include "corda/study/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "corda/core/error.hpp"
#include "corda/sim/rattle.hpp"
#include "corda/sim/trial.hpp"

namespace corda::study {
namespace {

constexpr double kTightTolerance = 1e-14;
constexpr double kTightShare = 0.25;  ///< of a stable step of order 8
/// What a reference may hold, in coordinates: 256 MiB. Longer ones keep every n-th frame.
constexpr std::size_t kMostNumbers = std::size_t{1} << 25U;

/// The frames of a run.
struct Trajectory {
    std::int64_t stride = 1;
    std::vector<sim::State> frames;  ///< of frames stride, 2 stride, ...; ends where the run diverged

    [[nodiscard]] const sim::State* at(std::int64_t k) const {
        if (k % stride != 0 || k == 0) return nullptr;
        const auto index = static_cast<std::size_t>(k / stride - 1);
        return index < frames.size() ? &frames[index] : nullptr;
    }
};

Trajectory run(const Problem& problem, const sim::SolverDef& solver) {
    sim::Simulation simulation(sim::build_system(problem.ropes, problem.nets, solver.reach), problem.world,
                               solver, problem.frame_interval_s, sim::Figured::kNo);
    const std::size_t numbers =
        2 * simulation.system().particle_count() * static_cast<std::size_t>(problem.last_frame);
    Trajectory result;
    result.stride = static_cast<std::int64_t>(numbers / kMostNumbers + 1);
    for (std::int64_t k = result.stride; k <= problem.last_frame; k += result.stride) {
        const double time_s = static_cast<double>(k) * problem.frame_interval_s;
        if (simulation.advance_to(time_s) == sim::Status::kDiverged) break;
        result.frames.push_back(simulation.state());
    }
    return result;
}

Reference as_reference(std::shared_ptr<const Trajectory> trajectory) {
    return [kept = std::move(trajectory)](std::int64_t k, sim::State& state) {
        const sim::State* const found = kept->at(k);
        if (found == nullptr) return false;
        state = *found;
        return true;
    };
}

double rms_m(const sim::State& a, const sim::State& b) {
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < a.x_m.size(); ++i) {
        const double dx = a.x_m[i] - b.x_m[i];
        const double dy = a.y_m[i] - b.y_m[i];
        sum_m2 += dx * dx + dy * dy;
    }
    return std::sqrt(sum_m2 / static_cast<double>(a.x_m.size()));
}

/// Cuts both where they part, and writes down how far apart they are until there.
void cut_at_horizon(Trajectory& first, Trajectory& second, Subject& subject) {
    const Problem& problem = subject.problem;
    std::size_t common = std::min(first.frames.size(), second.frames.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < common; ++k) {
        const double apart = rms_m(first.frames[k], second.frames[k]) / problem.length_m;
        if (!(apart <= kHorizonDifference)) common = k;
        if (k < common) largest = std::max(largest, apart);
    }
    subject.disagreement = largest;
    const auto frames = static_cast<std::size_t>(problem.last_frame / first.stride);
    if (common < frames)
        subject.horizon_s =
            static_cast<double>(common) * static_cast<double>(first.stride) * problem.frame_interval_s;
    first.frames.resize(common);
    second.frames.resize(common);
}

struct TightRun {
    sim::SolverDef solver;
    std::string words;
};

TightRun tight_exact(double tolerance) {
    return {sim::exact_solver(tolerance), fmt::format("method exact at a tolerance of {:.0e}", tolerance)};
}

TightRun tight_rope(const Problem& problem, double share) {
    const double step_s = share * rope_step_s(problem, 8);
    return {sim::rope_solver(8, step_s), fmt::format("method rope of order 8 at a step of {:.3g} s", step_s)};
}

}  // namespace

Problem facing(const Subject& subject, sim::Method method) {
    Problem problem = subject.problem;
    if (method != sim::Method::kExact || !subject.exact_reference) return problem;
    problem.reference = subject.exact_reference;
    problem.truth = subject.exact_truth;
    return problem;
}

void find_truth(Subject& subject) {
    Problem& problem = subject.problem;
    const std::string exact_refusal = refusal(problem, sim::exact_solver(kTightTolerance));
    const std::string rope_refusal = refusal(problem, sim::rope_solver(8));
    const bool has_exact = exact_refusal.empty();
    const bool has_rope = rope_refusal.empty();
    if (!has_exact && !has_rope) {
        sim::SolverDef relaxation = sim::relaxation_solver(problem.frame_interval_s, 1, 1);
        if (!refusal(problem, relaxation).empty()) throw Error(ExitCode::kInvalidScene, exact_refusal);
        problem.truth =
            "none: no method can tell how this scene truly moves, so that no error of a position is given";
        return;
    }
    const TightRun first = has_exact ? tight_exact(kTightTolerance) : tight_rope(problem, kTightShare / 2.0);
    const TightRun second = has_rope ? tight_rope(problem, kTightShare) : tight_exact(10.0 * kTightTolerance);
    auto first_run = std::make_shared<Trajectory>(run(problem, first.solver));
    auto second_run = std::make_shared<Trajectory>(run(problem, second.solver));
    cut_at_horizon(*first_run, *second_run, subject);
    const bool is_one_method = !(has_exact && has_rope);
    const std::string caveat =
        is_one_method ? " (the only method that can run this scene beside relaxation: its own errors are "
                        "measured against a far tighter run of itself)"
                      : "";
    problem.truth = first.words + caveat;
    problem.reference = as_reference(first_run);
    if (is_one_method) return;
    subject.exact_truth = second.words;
    subject.exact_reference = as_reference(second_run);
}

double rope_step_s(const Problem& problem, int order) {
    const sim::System system = sim::build_system(problem.ropes, problem.nets, 1);
    return sim::Rattle(system, problem.world, sim::rope_solver(order), problem.frame_interval_s).step_s();
}

std::string refusal(const Problem& problem, const sim::SolverDef& solver) {
    const sim::System system = sim::build_system(problem.ropes, problem.nets, solver.reach);
    return sim::refusal(system, problem.world, solver, problem.frame_interval_s);
}

}  // namespace corda::study
