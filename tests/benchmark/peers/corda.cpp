// Corda itself. `exact` is driven by its tolerance, the others by their step. The peer "Corda auto" chooses
// the method: its times include the plan, with all checks.

#include <cmath>

#include "benchmark/peers/peer.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/solver.hpp"

namespace corda::peers {
namespace {

class CordaRun : public Run {
  public:
    CordaRun(const Problem& problem, const MethodDef& method)
        : solver_(sim::make_solver(problem.system, problem.world, {&method, 1}, 1.0 / Problem::kFps)),
          state_{0.0, problem.system.x_m, problem.system.y_m} {}
    void advance(double time_s) override {
        if (solver_->advance_to(time_s, state_) == Status::kDiverged) throw Failure("diverged");
    }
    void read(State& state) override {
        state.x_m = state_.x_m;
        state.y_m = state_.y_m;
        solver_->velocities(state);
    }

  private:
    std::unique_ptr<sim::Solver> solver_;
    State state_;
};

class AutoRun : public Run {
  public:
    AutoRun(const Problem& problem, double tolerance)
        : problem_(problem),
          timeline_(FrameRate({std::lround(Problem::kFps), 1}), problem.frames),
          tolerance_m_(tolerance * problem.length_m),
          recording_(problem.count(), timeline_.size(), problem.system.bars.size(), {},
                     {.velocities = true}) {}
    void advance(double /*time_s*/) override {
        if (frame_++ > 0) return;
        const PlanDef def{[this](const MotionBounds&) { return tolerance_m_; }, timeline_, {}, {}};
        const Plan plan =
            sim::plan_methods(problem_.system, sim::NamedMethods(1), problem_.world, def, recording_);
        if (plan.horizon_s || !plan.error_estimate_m) throw Failure("no error estimate up to the end");
    }
    void read(State& state) override { recording_.read(frame_, state); }

  private:
    using PlanDef = sim::PlanDef;

    const Problem& problem_;
    Timeline timeline_;
    double tolerance_m_;
    sim::Recording recording_;
    std::size_t frame_ = 0;
};

Series rattle(int order) {
    return {
        "rattle of order " + std::to_string(order), kStepsPerFrame, step_counts(),
        [order](const Problem& problem, double steps) {
            return std::make_unique<CordaRun>(problem, RattleDef{order, 1.0 / (Problem::kFps * steps), 1.0});
        },
        [](const Problem& problem) { return !problem.is_string; }};
}

Series relaxation(int sweeps) {
    return {"relaxation with " + std::to_string(sweeps) + (sweeps == 1 ? " sweep" : " sweeps"),
            kStepsPerFrame, step_counts(),
            [sweeps](const Problem& problem, double steps) {
                return std::make_unique<CordaRun>(
                    problem, RelaxationDef{1.0 / (Problem::kFps * steps), sweeps, 0.0, {}});
            },
            is_flexible_chain};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda;
    using namespace corda::peers;
    const Series exact{"exact", "tolerance", powers_of_ten(2, 15),
                       [](const peers::Problem& problem, double tolerance) {
                           return std::make_unique<CordaRun>(problem, ExactDef{tolerance});
                       },
                       is_any};
    const Series automatic{"plan and run", "tolerance", powers_of_ten(1, 10),
                           [](const peers::Problem& problem, double tolerance) {
                               return std::make_unique<AutoRun>(problem, tolerance);
                           },
                           is_any};
    const int failed = run_peer(argc, argv, "Corda", CORDA_VERSION,
                                {exact, rattle(2), rattle(4), rattle(8), relaxation(1), relaxation(16)});
    return failed != 0 ? failed : run_peer(argc, argv, "Corda auto", CORDA_VERSION, {automatic});
}
