#include "support/estimate_judge.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "corda/film/film.hpp"

namespace corda::test {
namespace {

using Real = ExtendedMotion::Real;

class Watch {
  public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string why_no_estimate(const Plan& plan) {
    for (const BodyPlan& body : plan.bodies) {
        if (body.reason == PlanReason::kDependent) return "bars depend on each other";
    }
    return "none given";
}

/// The largest error of a printed position, in m.
template <class Truth>
double error_m(const State& state, Vec2 origin_m, const Truth& truth) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        const std::array<Real, 2> at = truth(i);
        const Real x_m = Real{origin_m.x + state.x_m[i]} - (Real{origin_m.x} + at[0]);
        const Real y_m = Real{origin_m.y + state.y_m[i]} - (Real{origin_m.y} + at[1]);
        const auto error_m = static_cast<double>(std::hypot(x_m, y_m));
        if (!(error_m <= largest_m)) largest_m = error_m;
    }
    return largest_m;
}

/// True if the truth with other steps, and so with other rounding, differs far less than the error, and if
/// its bars keep their lengths as well.
bool is_sure(const Film& film, const EstimateCase& given, const Verdict& verdict) {
    if (given.truth) return true;
    ExtendedMotion truth(film.system(), given.scene.world, given.start);
    ExtendedMotion other(film.system(), given.scene.world, given.start);
    for (std::int64_t k = 1; k <= film.last_frame() && film.time_s(k) <= verdict.worst_s; ++k) {
        const double between_s = 0.37 * film.time_s(k - 1) + 0.63 * film.time_s(k);
        if (!other.advance_to(between_s) || !other.advance_to(film.time_s(k))) return false;
        if (!truth.advance_to(film.time_s(k))) return false;
    }
    Real largest_m = truth.length_error_m();
    for (std::size_t i = 0; i < film.system().particle_count(); ++i)
        largest_m = std::max(largest_m, std::hypot(truth.x_m(i) - other.x_m(i), truth.y_m(i) - other.y_m(i)));
    return largest_m <= 0.1 * *verdict.ratio * verdict.estimate_m;
}

void compare(const Film& film, const EstimateCase& given, bool beyond, Verdict& verdict) {
    ExtendedMotion motion(film.system(), given.scene.world, given.start);
    verdict.ratio = 0.0;
    const double until_s = verdict.horizon_s.value_or(given.scene.world.duration_s);
    for (std::int64_t k = 0; k <= film.last_frame() && (beyond || film.time_s(k) <= until_s); ++k) {
        if (!given.truth && !motion.advance_to(film.time_s(k))) {
            verdict.why_not_judged = motion.failure();
            if (k == 0) verdict.ratio.reset();
            return;
        }
        const auto truth = [&](std::size_t i) {
            return given.truth ? given.truth(film.time_s(k), i) : std::array{motion.x_m(i), motion.y_m(i)};
        };
        const double ratio = error_m(film.state(k), film.system().origin_m, truth) / verdict.estimate_m;
        if (beyond && ratio > 1.0) {
            verdict.passes_s = film.time_s(k);
            beyond = false;
        }
        if (ratio <= *verdict.ratio || film.time_s(k) > until_s) continue;
        verdict.ratio = ratio;
        verdict.worst_s = film.time_s(k);
    }
}

}  // namespace

Verdict judge_estimate(const EstimateCase& given, bool beyond) {
    Verdict verdict;
    const Watch watch;
    try {
        Film film(given.scene);
        const Plan& plan = film.plan();
        verdict.plan_s = watch.seconds();
        verdict.horizon_s = plan.horizon_s;
        if (plan.error_estimate_m) {
            verdict.estimate_m = *plan.error_estimate_m;
            compare(film, given, beyond, verdict);
            if (verdict.ratio > 1.0 && !is_sure(film, given, verdict)) {
                verdict.ratio.reset();
                verdict.why_not_judged = "the truth is not sure";
            }
            verdict.truth_s = watch.seconds() - verdict.plan_s;
        } else {
            verdict.why_no_estimate = why_no_estimate(plan);
        }
    } catch (const Error& error) {
        const std::string message = error.what();
        verdict.why_no_estimate = "refused: " + message.substr(0, message.find(';'));
    }
    return verdict;
}

}  // namespace corda::test
