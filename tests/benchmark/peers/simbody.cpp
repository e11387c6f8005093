// Simbody (simbody_model.cpp), by its explicit Runge-Kutta methods, Verlet's, and CPODES, under error
// control.

#include "benchmark/peers/peer.hpp"
#include "benchmark/peers/simbody_model.hpp"

namespace corda::peers {
namespace {

SimbodyDef def_of(const Problem& problem) {
    const System& system = problem.system;
    SimbodyDef def{system.x_m, system.y_m, system.vx_m_s, system.vy_m_s, system.mass_kg, {}, {}};
    for (std::size_t i = 0; i < problem.count(); ++i) def.is_pinned.push_back(system.is_pinned(i));
    for (const Bar& bar : system.bars) def.bars.emplace_back(bar.a, bar.b);
    def.rest_m = problem.link_m();
    def.stiffness_n_m = problem.stiffness_n_m;
    def.bend_n_m = problem.bend_n_m;
    def.gravity = problem.gravity();
    def.start_angle = problem.start_angle();
    return def;
}

class SimbodyRun : public Run {
  public:
    SimbodyRun(const Problem& problem, SimbodyMethod method, double accuracy)
        : model_(SimbodyModel::make(def_of(problem), method, accuracy)) {}
    void advance(double time_s) override { model_->step_to(time_s); }
    void read(State& state) override { model_->read(state.x_m, state.y_m, state.vx_m_s, state.vy_m_s); }

  private:
    std::unique_ptr<SimbodyModel> model_;
};

Series series(const char* name, SimbodyMethod method) {
    return {name, "accuracy", powers_of_ten(1, 13),
            [method](const Problem& problem, double accuracy) {
                return std::make_unique<SimbodyRun>(problem, method, accuracy);
            },
            [](const Problem& problem) { return !problem.is_string; }};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    return run_peer(
        argc, argv, "Simbody", SimbodyModel::version(),
        {series("Runge-Kutta-Merson", SimbodyMethod::kMerson),
         series("Runge-Kutta-Fehlberg", SimbodyMethod::kFehlberg), series("Verlet", SimbodyMethod::kVerlet),
         series("CPODES Adams", SimbodyMethod::kCpodesAdams)});
}
