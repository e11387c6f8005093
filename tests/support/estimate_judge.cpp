#include "support/estimate_judge.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/sim/simulation.hpp"

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

/// The times at which a motion is looked at: evenly between frames, and to the end of the scene.
std::vector<double> times_s(const Film& film, const EstimateCase& given) {
    std::vector<double> times;
    const FrameRate rate = given.scene.video.scene_rate();
    for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
        times.push_back(film.time_s(k));
        for (int look = 1; look < given.looks; ++look) {
            const double time_s = film.time_s(k) + look * rate.interval_s() / given.looks;
            if (time_s < given.scene.world.duration_s) times.push_back(time_s);
        }
    }
    if (given.looks > 1 && times.back() < given.scene.world.duration_s)
        times.push_back(given.scene.world.duration_s);
    return times;
}

/// The run of a film, which is the same at all times.
Simulation run_of(const Film& film, const EstimateCase& given) {
    std::vector<MethodDef> methods;
    for (const BodyPlan& body : film.plan().bodies) methods.push_back(body.method);
    return {film.system(), given.scene.world, methods, given.scene.video.fps.interval_s()};
}

/// True if the truth with other steps, and so with other rounding, differs far less than the error, and if
/// its bars keep their lengths as well.
bool is_sure(const Film& film, const EstimateCase& given, const Verdict& verdict) {
    if (given.truth) return true;
    ExtendedMotion truth(film.system(), given.scene.world, given.start);
    ExtendedMotion other(film.system(), given.scene.world, given.start);
    double last_s = 0.0;
    for (const double time_s : times_s(film, given)) {
        if (time_s > verdict.worst_s) break;
        const double between_s = 0.37 * last_s + 0.63 * time_s;
        if (!other.advance_to(between_s) || !other.advance_to(time_s)) return false;
        if (!truth.advance_to(time_s)) return false;
        last_s = time_s;
    }
    Real largest_m = truth.length_error_m();
    for (std::size_t i = 0; i < film.system().particle_count(); ++i)
        largest_m = std::max(largest_m, std::hypot(truth.x_m(i) - other.x_m(i), truth.y_m(i) - other.y_m(i)));
    return largest_m <= 0.1 * *verdict.ratio * verdict.estimate_m;
}

void compare(const Film& film, const EstimateCase& given, bool beyond, Verdict& verdict) {
    ExtendedMotion motion(film.system(), given.scene.world, given.start);
    Simulation run = run_of(film, given);
    verdict.ratio = 0.0;
    const double until_s = verdict.horizon_s.value_or(given.scene.world.duration_s);
    for (const double time_s : times_s(film, given)) {
        if (!beyond && time_s > until_s) break;
        if ((!given.truth && !motion.advance_to(time_s)) || run.advance_to(time_s) == Status::kDiverged) {
            verdict.why_not_judged = motion.failure();
            if (time_s == 0.0) verdict.ratio.reset();
            return;
        }
        const auto truth = [&](std::size_t i) {
            return given.truth ? given.truth(time_s, i) : std::array{motion.x_m(i), motion.y_m(i)};
        };
        const double ratio = error_m(run.state(), film.system().origin_m, truth) / verdict.estimate_m;
        if (beyond && ratio > 1.0) {
            verdict.passes_s = time_s;
            beyond = false;
        }
        if (ratio <= *verdict.ratio || time_s > until_s) continue;
        verdict.ratio = ratio;
        verdict.worst_s = time_s;
    }
}

/// Positions at the frame times, in m: x and y of each particle.
using Frames = std::vector<std::vector<std::array<Real, 2>>>;

/// Where the camera looks at a frame: the mean of the places of the last particle over 0.2 s before and
/// after, with weights that fall evenly; before the start and after the end it rests.
std::array<Real, 2> followed(const Frames& frames, const Scene& scene, std::size_t frame) {
    const auto half = std::llround(std::min(0.2 * scene.video.fps.per_second(), 100.0));
    std::array<Real, 2> sum{};
    for (auto j = -half; j <= half; ++j) {
        const auto at =
            std::clamp<std::int64_t>(static_cast<std::int64_t>(frame) + j, 0, std::ssize(frames) - 1);
        const Real weight =
            static_cast<Real>(half + 1 - std::abs(j)) / static_cast<Real>((half + 1) * (half + 1));
        for (std::size_t axis = 0; axis < 2; ++axis)
            sum[axis] += weight * frames[static_cast<std::size_t>(at)].back()[axis];
    }
    return sum;
}

/// Compares the picture of a camera that follows the last particle.
void compare_in_picture(const Film& film, const EstimateCase& given, Verdict& verdict) {
    const Scene& scene = given.scene;
    ExtendedMotion motion(film.system(), scene.world, given.start);
    Frames truth;
    for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
        if (!motion.advance_to(film.time_s(k))) {
            verdict.why_not_judged = motion.failure();
            return;
        }
        truth.emplace_back();
        for (std::size_t i = 0; i < film.system().particle_count(); ++i)
            truth.back().push_back({motion.x_m(i), motion.y_m(i)});
    }
    const double pixels_per_metre = scene.video.height_px / *film.camera().height_m;
    const double until_s = verdict.horizon_s.value_or(scene.world.duration_s);
    const Vec2 origin_m = film.system().origin_m;
    verdict.ratio = 0.0;
    for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
        // A camera depends on the motion up to 0.2 s ahead.
        if (film.time_s(k) > until_s - (verdict.horizon_s ? 0.2 : 0.0)) break;
        const Vec2 center_m = *film.camera_at(film.time_s(k)).center_m - origin_m;
        const std::array<Real, 2> center = followed(truth, scene, static_cast<std::size_t>(k));
        const State state = film.state(k);
        for (std::size_t i = 0; i < state.x_m.size(); ++i) {
            const auto& at = truth[static_cast<std::size_t>(k)][i];
            const Real x_m = (Real{state.x_m[i]} - center_m.x) - (at[0] - center[0]);
            const Real y_m = (Real{state.y_m[i]} - center_m.y) - (at[1] - center[1]);
            const double error_px = static_cast<double>(std::hypot(x_m, y_m)) * pixels_per_metre;
            const double ratio = error_px / film.error_estimate_px().value();
            if (ratio <= *verdict.ratio) continue;
            verdict.ratio = ratio;
            verdict.worst_s = film.time_s(k);
        }
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
            if (given.scene.camera.follow)
                compare_in_picture(film, given, verdict);
            else
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
