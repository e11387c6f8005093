// Boost.odeint on the equations of motion: Dormand-Prince 5, Fehlberg 7(8) and Bulirsch-Stoer under error
// control.

#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>

#include <cmath>

#include "benchmark/peers/equations.hpp"

namespace corda::peers {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = std::vector<double>;

template <class Stepper>
class OdeintRun : public Run {
  public:
    OdeintRun(const Problem& problem, Stepper stepper)
        : equations_(problem), stepper_(std::move(stepper)), y_(equations_.start()) {}
    void advance(double time_s) override {
        const auto slope = [this](const Vector& y, Vector& dy, double /*t*/) {
            equations_.slope(y.data(), dy.data());
        };
        int tries = 0;
        while (time_s_ < time_s) {
            const double suggested_s = step_s_;
            double h = std::min(step_s_, time_s - time_s_);
            const bool is_last = h < suggested_s;
            double t = time_s_;
            if (stepper_.try_step(slope, y_, t, h) == odeint::success) {
                time_s_ = is_last && time_s - t < 1e-12 ? time_s : t;
                step_s_ = is_last ? std::max(h, suggested_s) : h;
                tries = 0;
            } else {
                step_s_ = h;
                if (++tries > 200) throw Failure("the step became too short");
            }
        }
    }
    void read(State& state) override { equations_.read(y_.data(), state); }

  private:
    Equations<double> equations_;
    Stepper stepper_;
    Vector y_;
    double time_s_ = 0.0;
    double step_s_ = 1e-3;
};

template <class Stepper>
class DenseRun : public Run {
  public:
    DenseRun(const Problem& problem, Stepper stepper)
        : equations_(problem), stepper_(std::move(stepper)), y_(equations_.start()) {
        stepper_.initialize(y_, 0.0, 1e-3);
    }
    void advance(double time_s) override {
        const auto slope = [this](const Vector& y, Vector& dy, double /*t*/) {
            equations_.slope(y.data(), dy.data());
        };
        while (stepper_.current_time() < time_s) stepper_.do_step(slope);
        stepper_.calc_state(time_s, y_);
    }
    void read(State& state) override { equations_.read(y_.data(), state); }

  private:
    Equations<double> equations_;
    Stepper stepper_;
    Vector y_;
};

template <template <class> class Kind, class Stepper>
std::unique_ptr<Run> make_run(const Problem& problem, Stepper stepper) {
    return std::make_unique<Kind<Stepper>>(problem, std::move(stepper));
}

bool is_smooth(const Problem& problem) {
    return !problem.is_string;
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const auto series = [](const char* name, auto make) {
        return Series{name, "tolerance", powers_of_ten(2, 15), make, is_smooth};
    };
    return run_peer(argc, argv, "Boost.odeint", "Boost " BOOST_LIB_VERSION,
                    {series("Dormand-Prince 5",
                            [](const Problem& problem, double tolerance) {
                                return make_run<DenseRun>(
                                    problem, odeint::make_dense_output(tolerance, tolerance,
                                                                       odeint::runge_kutta_dopri5<Vector>()));
                            }),
                     series("Bulirsch-Stoer",
                            [](const Problem& problem, double tolerance) {
                                return make_run<DenseRun>(
                                    problem, odeint::bulirsch_stoer_dense_out<Vector>(tolerance, tolerance));
                            }),
                     series("Fehlberg 7(8)", [](const Problem& problem, double tolerance) {
                         return make_run<OdeintRun>(
                             problem, odeint::make_controlled(tolerance, tolerance,
                                                              odeint::runge_kutta_fehlberg78<Vector>()));
                     })});
}
