#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// Number of particles from which a frame of `exact` takes longer than starting a thread (30 us).
constexpr std::size_t kManyParticles = 100;

/// Moves the free particles of a start by about its rounding in pseudorandom directions. Does not move
/// strings: whether a link is taut must not change.
void move_by_rounding(System& system, std::uint32_t order) {
    const auto moved = [&order](double x_m, double length_m) {
        order = order * 1664525U + 1013904223U;
        const double sign = (order >> 31U) == 0U ? 1.0 : -1.0;
        return x_m + sign * std::numeric_limits<double>::epsilon() * length_m;
    };
    for (const Body& body : system.bodies) {
        if (body.material.is_string) continue;
        const double length_m = links_length_m(system, body);
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
            if (system.is_pinned(i)) continue;
            system.x_m[i] = moved(system.x_m[i], length_m);
            system.y_m[i] = moved(system.y_m[i], length_m);
        }
    }
}

/// Per link of a string, twice the rounding of lengths at which it comes taut: a run and a check that rounded
/// alike would both miss what a snap makes of it. Every other check comes taut that much earlier.
std::vector<double> rounding_of_snaps_m(const System& string, std::size_t check) {
    constexpr double kOfALink = 2e-14;
    constexpr double kOfAPlace = 16.0 * std::numeric_limits<double>::epsilon();
    const double sign = check % 2 == 0 ? 1.0 : -1.0;
    const double length_m = links_length_m(string, string.bodies.front());
    std::vector<double> longer_m;
    for (const Bar& link : string.bars)
        longer_m.push_back(sign * (kOfALink * link.rest_m + kOfAPlace * length_m));
    return longer_m;
}

/// Ratio of the error estimate to the difference from a check. The error may exceed the difference by the
/// check's own error, a sixth of it near rounding.
constexpr double kEstimatePerDifference = 3.0;

/// The difference of two runs over time. The tolerance follows from the bounds of the whole motion and is
/// known only at the end; until then that of the motion so far, which is no larger, is used.
class Comparison {
  public:
    explicit Comparison(const ToleranceOf& tolerance_m) : tolerance_m_(&tolerance_m) {}

    void add(double time_s, double difference_m, const MotionBounds& bounds_so_far) {
        if (records_.empty() || difference_m > records_.back().largest_m)
            records_.push_back({difference_m, time_s});
        records_.back().until_s = time_s;
        has_parted_ = !(kEstimatePerDifference * records_.back().largest_m <=
                        kHopeless * (*tolerance_m_)(bounds_so_far));
    }

    /// Estimate of the error so far, without rounding.
    [[nodiscard]] double estimate_m() const {
        return records_.empty() ? 0.0 : kEstimatePerDifference * records_.back().largest_m;
    }

    /// True if the difference is more than the tolerance will ever allow.
    [[nodiscard]] bool has_parted() const { return has_parted_; }

    void conclude(const MotionBounds& bounds, double hidden_m, Trial& trial) const {
        const double tolerance_m = (*tolerance_m_)(bounds);
        const double allowed_m = (tolerance_m - hidden_m) / kEstimatePerDifference;
        trial.to_the_end = !has_parted_ && !records_.empty() && records_.back().largest_m <= allowed_m;
        for (const Record& record : records_) {
            if (!(record.largest_m <= allowed_m)) break;
            trial.reached_s = record.until_s;
            if (record.largest_m <= kHundredth * allowed_m) trial.hundredth_s = record.until_s;
            trial.largest_difference_m = record.largest_m;
        }
        trial.error_estimate_m = kEstimatePerDifference * trial.largest_difference_m + hidden_m;
    }

  private:
    static constexpr double kHundredth = 0.01;
    /// A motion may still grow by about this factor, and the tolerance with it.
    static constexpr double kHopeless = 16.0;

    const ToleranceOf* tolerance_m_;
    /// The largest difference so far, and the last time at which it was the largest.
    struct Record {
        double largest_m;
        double until_s;
    };
    std::vector<Record> records_;  ///< increasing
    bool has_parted_ = false;
};

/// Error in metres that vibrations can hide from a trial. Implicit steps damp those that displace particles
/// by less than a share of a step of 0.002 of the tolerance, in a run and its check. If vibrations of bodies
/// that stretch or bend limit the steps of `exact`, a run and its check damp quick ones alike. Their
/// amplitude is then below the check's tolerance; otherwise its error estimates would have shortened the
/// steps.
double hidden_m(const System& system, const Trial& trial) {
    constexpr double kResolved = 0.9;
    constexpr double kOfImplicit = 0.05;
    const auto* run = std::get_if<ExactDef>(&trial.method);
    if (run != nullptr && run->implicit) return kOfImplicit * run->tolerance * largest_length_m(system);
    const auto* check = std::get_if<ExactDef>(&trial.check);
    const bool vibrates = !system.bends.empty() || std::ranges::any_of(system.bodies, [](const Body& body) {
        return body.material.compliance_1_n > 0.0;
    });
    if (run == nullptr || check == nullptr || !vibrates) return 0.0;
    // As many as it takes if the tolerance limits the steps, of order 8. Square roots are the same
    // everywhere.
    const double ratio = run->tolerance / check->tolerance;
    const double steps = std::sqrt(std::sqrt(std::sqrt(ratio))) * static_cast<double>(trial.steps);
    return static_cast<double>(trial.check_steps) >= kResolved * steps
               ? 0.0
               : check->tolerance * largest_length_m(system);
}

/// True if rounding is small compared with a run's error. It moves a chain of equal masses about as much as a
/// tolerance of 1e-12, and a light particle more: the rounding of a tension that carries heavy ones grows
/// with the ratio of masses.
bool is_far_from_rounding(const System& system, const MethodDef& run) {
    constexpr double kNear = 2e-9;
    const auto* exact = std::get_if<ExactDef>(&run);
    return exact != nullptr && exact->tolerance > kNear * mass_ratio(system, system.bodies.front());
}

/// Of positions in the scene's coordinates, as files give them; and of the start and the lengths of bars,
/// which run and checks share and the motion magnifies (a braced net of random scenes: 830 roundings in 1 s).
double rounding_m(const System& system, const MotionBounds& bounds) {
    const auto largest = [](Vec2 v) { return std::max(std::abs(v.x), std::abs(v.y)); };
    const double farthest_m =
        largest(system.origin_m) + std::max(largest(bounds.min_m()), largest(bounds.max_m()));
    constexpr double kMagnified = 4096.0;
    return std::numeric_limits<double>::epsilon() *
           (2.0 * farthest_m + kMagnified * largest_length_m(system));
}

}  // namespace

class Checks::Check : NonCopyable {
  public:
    Check(const System& system, const Forces& forces, const MethodDef& method, double frame_interval_s,
          std::size_t number, const std::vector<double>& longer_m = {})
        : turn_(turn(number % kMaxCount)), system_(system) {
        if (number > 0) move_by_rounding(system_, static_cast<std::uint32_t>(number));
        for (std::size_t i = 0; i < system.particle_count(); ++i) {
            const Vec2 position = turn_.of({system_.x_m[i], system_.y_m[i]});
            const Vec2 velocity = turn_.of({system_.vx_m_s[i], system_.vy_m_s[i]});
            system_.x_m[i] = position.x;
            system_.y_m[i] = position.y;
            system_.vx_m_s[i] = velocity.x;
            system_.vy_m_s[i] = velocity.y;
        }
        const Forces turned(ForceTerm{turn_.of(forces.uniform_m_s2()), forces.drag_1_s()});
        const MaterialDef& material = system.bodies.front().material;
        const auto* exact = std::get_if<ExactDef>(&method);
        if (exact != nullptr && material.is_string && material.compliance_1_n == 0.0) {
            auto string = std::make_unique<StringPart>(
                system_, turned, exact->tolerance,
                longer_m.empty() ? rounding_of_snaps_m(system, number) : longer_m);
            string_ = string.get();
            solver_ = std::move(string);
        } else {
            solver_ = make_solver(system_, turned, {&method, 1}, frame_interval_s);
        }
        state_ = {0.0, system_.x_m, system_.y_m};
    }

    [[nodiscard]] double margin_m() const { return string_ == nullptr ? HUGE_VAL : string_->margin_m(); }

    /// kDiverged also if it has branched.
    Status advance_to(double time_s) {
        const Status status = solver_->advance_to(time_s, state_);
        return solver_->has_branched() ? Status::kDiverged : status;
    }
    [[nodiscard]] std::uint64_t steps() const { return solver_->steps(); }
    /// Where it has a particle, in the scene's directions.
    [[nodiscard]] Vec2 position_m(std::size_t i) const {
        return Turn{turn_.cosine, -turn_.sine}.of({state_.x_m[i], state_.y_m[i]});
    }

  private:
    /// An angle by its cosine and sine.
    struct Turn {
        double cosine;
        double sine;
        [[nodiscard]] Vec2 of(Vec2 v) const { return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y}; }
    };
    static Turn turn(std::size_t number) {
        constexpr std::array<Turn, kMaxCount> kTurns{
            {{0.8, 0.6}, {5.0 / 13.0, 12.0 / 13.0}, {24.0 / 25.0, 7.0 / 25.0}}};
        return kTurns[number];
    }

    Turn turn_;
    System system_;
    std::unique_ptr<Solver> solver_;
    const StringPart* string_ = nullptr;  ///< solver_, if it is one
    State state_;
};

Checks::Checks(const System& system, const Forces& forces, const MethodDef& method, double frame_interval_s,
               std::size_t count)
    : in_threads_(system.particle_count() >= kManyParticles) {
    for (std::size_t number = 0; number < count; ++number)
        checks_.push_back(std::make_unique<Check>(system, forces, method, frame_interval_s, number));
}

Checks::Checks(const System& string, const Forces& forces, const ExactDef& method, double longer_m)
    : in_threads_(string.particle_count() >= kManyParticles), are_alike_(false) {
    constexpr std::size_t kMaxBits = 3;
    std::vector<double> longer(string.bars.size());
    const auto bits = static_cast<std::size_t>(std::bit_width(longer.size() - 1));
    for (std::size_t number = 0; number < 2 * std::clamp<std::size_t>(bits, 1, kMaxBits); ++number) {
        for (std::size_t k = 0; k < longer.size(); ++k)
            longer[k] = ((k >> (number / 2)) + number) % 2 == 0 ? longer_m : -longer_m;
        checks_.push_back(std::make_unique<Check>(string, forces, method, 0.0, number, longer));
    }
}

Checks::~Checks() {
    is_abandoned_ = true;
}

void Checks::start(double time_s) {
    time_s_ = time_s;
    if (!in_threads_) return;
    // In this thread, by finish(), if the system has none to give.
    constexpr auto kPolicy = std::launch::async | std::launch::deferred;
    for (const auto& check : checks_) {
        pending_.push_back(std::async(kPolicy, [this, &check, time_s] {
            const CancelScope wanted([this] { return !is_abandoned_.load(std::memory_order_relaxed); });
            return check->advance_to(time_s);
        }));
    }
}

Status Checks::finish() {
    constexpr std::chrono::milliseconds kPatience{10};
    Status status = Status::kOk;
    const auto add = [&status](Status one) { status = one == Status::kOk ? status : one; };
    for (std::size_t i = 0; i < checks_.size(); ++i) {
        auto waited = std::future_status::deferred;
        while (in_threads_ && (waited = pending_[i].wait_for(kPatience)) == std::future_status::timeout)
            check_cancelled();
        add(waited == std::future_status::deferred ? checks_[i]->advance_to(time_s_) : pending_[i].get());
    }
    pending_.clear();
    steps_ = checks_.front()->steps();
    return status;
}

double Checks::difference_m(const State& state) const {
    constexpr double kPerRounding = 2.0;
    double largest_m = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        double distance_m = 0.0;
        double rounding_m = 0.0;
        for (std::size_t a = 0; a < checks_.size(); ++a) {
            const Vec2 at = checks_[a]->position_m(i);
            const Vec2 apart = at - Vec2{state.x_m[i], state.y_m[i]};
            distance_m = std::max(length(apart.x, apart.y), distance_m);
            for (std::size_t b = 0; are_alike_ && b < a; ++b) {
                const Vec2 differ = at - checks_[b]->position_m(i);
                rounding_m = std::max(length(differ.x, differ.y), rounding_m);
            }
        }
        distance_m += kPerRounding * rounding_m;
        if (!(distance_m <= largest_m)) largest_m = std::isnan(distance_m) ? HUGE_VAL : distance_m;
    }
    return largest_m;
}

double Checks::margin_m() const {
    return checks_.front()->margin_m();
}

namespace {

/// Follows the other outcomes of snaps of a rigid string on which the errors of its run and checks decide: in
/// another order, or not at all.
class OtherSnaps {
  public:
    OtherSnaps(const System& system, const Forces& forces, const PlanDef& def, const MethodDef& check)
        : system_(system), forces_(forces), check_(std::get_if<ExactDef>(&check)), alone_(def.tolerance_m) {}

    /// The largest difference of `state`, the run's, from the checks and from other outcomes at a frame time.
    double difference_m(double time_s, const Checks& checks, const State& state, const MotionBounds& bounds,
                        int& passes) {
        const double error_m = alone_.estimate_m() + rounding_m(system_, bounds);
        const double difference_m = checks.difference_m(state);
        alone_.add(time_s, difference_m, bounds);
        const double margin_m = checks.margin_m();
        if (margin_m <= kSure * error_m && longer_m_ < std::max(kCovers * margin_m, error_m)) {
            longer_m_ = kCovers * std::max(margin_m, error_m);
            runs_.emplace(system_, forces_, *check_, longer_m_);
            passes += static_cast<int>(runs_->size());
        }
        if (!runs_) return difference_m;
        runs_->start(time_s);
        if (runs_->finish() == Status::kDiverged) return HUGE_VAL;
        return std::max(difference_m, runs_->difference_m(state));
    }

    /// The last time at which the checks alone differ by less than a hundredth of the tolerance; 0 if no
    /// other outcomes are followed.
    [[nodiscard]] double reached_s(const MotionBounds& bounds) const {
        Trial alone;
        if (runs_) alone_.conclude(bounds, 0.0, alone);
        return alone.hundredth_s;
    }

  private:
    /// A decision whose margin exceeds this multiple of the error estimate is the true one.
    static constexpr double kSure = 4.0;
    /// Displacement of snaps in parts of the margins that it covers.
    static constexpr double kCovers = 2.0;

    const System& system_;
    const Forces& forces_;
    const ExactDef* check_;
    Comparison alone_;  ///< without other outcomes
    double longer_m_ = 0.0;
    std::optional<Checks> runs_;
};

}  // namespace

CancelScope report_frames(const PlanDef& def, const std::int64_t& frames_done) {
    return CancelScope([&def, &frames_done] {
        report_progress(def.on_progress, frames_done, static_cast<std::int64_t>(def.timeline.size()));
    });
}

std::size_t check_count(const System& system, const MethodDef& method, bool is_first) {
    const bool has_one =
        is_far_from_rounding(system, method) || (is_first && std::holds_alternative<RattleDef>(method));
    return has_one ? 1 : Checks::kMaxCount;
}

bool run_trial(const System& system, const WorldDef& world, const PlanDef& def, TrialKind kind, Trial& trial,
               Recording& recording, int& passes) {
    struct TooManySteps {};
    const double interval_s = def.timeline.step_s();
    const auto total = static_cast<std::int64_t>(def.timeline.size());
    std::int64_t i = 0;
    const CancelScope progress = report_frames(def, i);
    Simulation run(system, world, trial.method, interval_s);
    bool is_last = false;
    const auto count_steps = [&] {
        const double most = kind.first_steps + kind.most_steps_1_s * run.state().time_s;
        if (!is_last && static_cast<double>(run.diagnostics().steps) > most) throw TooManySteps();
    };
    Checks checks(system, world, trial.check, interval_s, check_count(system, trial.method, kind.is_first));
    Comparison comparison(def.tolerance_m);
    const Forces forces(world);
    OtherSnaps other_snaps(system, forces, def, trial.check);
    recording.clear();
    bool is_checked = true;
    bool is_known = false;  // whether the trial holds
    const auto conclude = [&] {
        is_known = true;
        trial.steps = run.diagnostics().steps;
        trial.check_steps = checks.steps();
        comparison.conclude(recording.bounds(), hidden_m(system, trial), trial);
        trial.error_estimate_m += rounding_m(system, recording.bounds());
        trial.to_the_end = trial.to_the_end && !trial.diverged;
        trial.undecided = !trial.to_the_end && other_snaps.reached_s(recording.bounds()) > trial.reached_s;
        if (!trial.to_the_end && !is_last) is_last = kind.is_last(run.state().time_s);
    };
    for (; i < total; ++i) {
        check_cancelled();
        if (!is_checked && !is_known) conclude();
        if (!is_checked && !is_last) return true;
        const bool compares = is_checked && def.timeline.is_frame(static_cast<std::size_t>(i));
        if (i == 0) ++passes;
        if (compares) checks.start(def.timeline.time_s(static_cast<std::size_t>(i)));
        try {
            const CancelScope limit([&] {
                count_steps();
                return true;
            });
            if (recording.advance(run, def.timeline, def.clock_s) == Status::kDiverged) {
                trial.diverged = trial.diverged || is_checked;
                break;
            }
            count_steps();
        } catch (const TooManySteps&) {
            trial.steps = run.diagnostics().steps;
            return false;
        }
        if (is_checked && run.diagnostics().branched_s) trial.diverged = true;
        if (!compares) continue;
        if (i == 0) passes += static_cast<int>(checks.size());
        if (checks.finish() == Status::kDiverged) trial.diverged = true;
        if (!trial.diverged) {
            const double time_s = def.timeline.time_s(static_cast<std::size_t>(i));
            const MotionBounds& bounds = recording.bounds();
            comparison.add(time_s, other_snaps.difference_m(time_s, checks, run.state(), bounds, passes),
                           bounds);
        }
        is_checked = !trial.diverged && !comparison.has_parted();
    }
    conclude();
    return true;
}

std::optional<Refusal> refusal(const System& system, const WorldDef& world, const MethodDef& method,
                               double frame_interval_s) {
    try {
        static_cast<void>(make_solver(system, world, {&method, 1}, frame_interval_s));
    } catch (const Refusal& refused) {
        return refused;
    }
    return std::nullopt;
}

}  // namespace corda::sim
