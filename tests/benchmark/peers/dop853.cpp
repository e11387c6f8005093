// DOP853 with its dense output, Corda's integrator, on the equations of motion of the other solvers: what
// Corda's own equations gain over them.

#include "corda/sim/exact/dop853.hpp"
#include "benchmark/peers/equations.hpp"

namespace corda::peers {
namespace {

class Plain : public sim::Ode {
  public:
    explicit Plain(const Problem& problem) : equations(problem) {}
    void derivative(const double* y, double* slope) override { equations.slope(y, slope); }

    Equations<double> equations;
};

class Dop853Run : public Run {
  public:
    Dop853Run(const Problem& problem, double tolerance)
        : ode_(problem),
          integrator_(ode_, ode_.equations.start(), {{0, ode_.equations.size(), 1.0, 1.0}},
                      {.tolerance = tolerance}),
          y_(ode_.equations.size()) {}
    void advance(double time_s) override {
        if (integrator_.advance_to(time_s) == Status::kDiverged) throw Failure("diverged");
        integrator_.interpolate(time_s, y_.data());
    }
    void read(State& state) override { ode_.equations.read(y_.data(), state); }

  private:
    Plain ode_;
    sim::Dop853 integrator_;
    std::vector<double> y_;
};

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    return run_peer(argc, argv, "DOP853", "own",
                    {{"dense output", "tolerance", powers_of_ten(2, 15),
                      [](const Problem& problem, double tolerance) {
                          return std::make_unique<Dop853Run>(problem, tolerance);
                      },
                      [](const Problem& problem) { return !problem.is_string; }}});
}
