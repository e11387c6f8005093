#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/cosine_sine.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/phases.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// Work of a check, in updates of count_work(), that takes several times as long as a thread takes to start
/// and to be waited for. 300 links over 10 s: 1.06 s of CPU with a thread for each comparison, 0.62 s with
/// this.
constexpr double kWorthAThread = 10'000.0;

/// A sequence of pseudorandom signs.
class Signs {
  public:
    explicit Signs(std::size_t seed) : order_(static_cast<std::uint32_t>(seed)) {}

    double next() {
        order_ = order_ * 1664525U + 1013904223U;
        return (order_ >> 31U) == 0U ? 1.0 : -1.0;
    }

  private:
    std::uint32_t order_;
};

/// Moves the free particles of a start by about its rounding in pseudorandom directions. Does not move
/// strings: whether a link is taut must not change.
void move_by_rounding(System& system, std::size_t number) {
    Signs signs(number);
    for (const Body& body : system.bodies) {
        if (body.material.is_string) continue;
        const double rounding_m = std::numeric_limits<double>::epsilon() * links_length_m(system, body);
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
            if (system.is_pinned(i)) continue;
            system.x_m[i] += signs.next() * rounding_m;
            system.y_m[i] += signs.next() * rounding_m;
        }
    }
}

/// Moves the free particles of a rope to either side by this share of its length, or by less: links that
/// stretch become longer by a share of 2e-10 at most.
void move_across(System& rope, double share) {
    constexpr double kOfALink = 1e-5;
    double by_m = share * links_length_m(rope, rope.bodies.front());
    for (const Bar& link : rope.bars) by_m = std::min(by_m, kOfALink * link.rest_m);
    const auto place = [x_m = rope.x_m, y_m = rope.y_m](std::size_t i) { return Vec2{x_m[i], y_m[i]}; };
    const std::size_t last = rope.particle_count() - 1;
    Signs signs(0);
    for (std::size_t i = 0; i <= last; ++i) {
        if (rope.is_pinned(i)) continue;
        const Vec2 along = place(std::min(i + 1, last)) - place(i == 0 ? 0 : i - 1);
        const double length_m = length(along.x, along.y);
        if (length_m == 0.0) continue;
        const Vec2 moved = place(i) + (signs.next() * by_m / length_m) * left_of(along);
        rope.x_m[i] = moved.x;
        rope.y_m[i] = moved.y;
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

/// Moves the lengths of the rigid bars of a check by about their rounding, which the run does not know
/// either: where bars come into line, positions move by its root. Not those of strings.
void round_lengths(System& system, std::size_t check) {
    constexpr double kGolden = 0.6180339887498949;
    for (const Body& body : system.bodies) {
        if (body.material.is_string || body.material.compliance_1_n > 0.0) continue;
        for (std::size_t k = 0; k < body.bar_count; ++k) {
            const double turns = kGolden * static_cast<double>(k + 1 + check * body.bar_count);
            const double share = 4.0 * (turns - std::floor(turns)) - 2.0;
            system.bars[body.first_bar + k].rest_m *= 1.0 + share * std::numeric_limits<double>::epsilon();
        }
    }
}

}  // namespace

class Checks::Check : NonCopyable {
  public:
    Check(const System& system, const Forces& forces, const MethodDef& method, double frame_interval_s,
          std::size_t number, const std::vector<double>& longer_m = {})
        : cosine_sine_(kTurns.at(number % kMaxCount)), system_(system) {
        round_lengths(system_, number);
        const MaterialDef& material = system.bodies.front().material;
        const auto* exact = std::get_if<ExactDef>(&method);
        if (number > 0 && may_buckle_unseen(system, method))
            move_across(system_, kMovedPerTolerance * exact->tolerance);
        else if (number > 0)
            move_by_rounding(system_, number);
        for (std::size_t i = 0; i < system.particle_count(); ++i) {
            const Vec2 position = turned({system_.x_m[i], system_.y_m[i]}, cosine_sine_);
            const Vec2 velocity = turned({system_.vx_m_s[i], system_.vy_m_s[i]}, cosine_sine_);
            system_.x_m[i] = position.x;
            system_.y_m[i] = position.y;
            system_.vx_m_s[i] = velocity.x;
            system_.vy_m_s[i] = velocity.y;
        }
        for (MoveDef& move : system_.moves) {
            for (WaveDef& wave : move.waves) wave.amplitude = turned(wave.amplitude, cosine_sine_);
            for (PathKeyDef& key : move.path) key.by_m = turned(key.by_m, cosine_sine_);
        }
        const Forces turned_forces = forces.turned(cosine_sine_);
        if (exact != nullptr && material.is_string && material.compliance_1_n == 0.0) {
            solver_ = solve_string(turned_forces, method,
                                   longer_m.empty() ? rounding_of_snaps_m(system, number) : longer_m);
        } else {
            solver_ = make_solver(system_, turned_forces, {&method, 1}, frame_interval_s);
        }
        state_ = {0.0, system_.x_m, system_.y_m};
    }

    [[nodiscard]] double margin_m() const { return solver_->margin_m(); }

    /// kDiverged also if it has branched, or ended because it would take more work than this.
    Status advance_to(double time_s, double most_updates) {
        try {
            const Status status = work_.run(work_.updates() + most_updates,
                                            [&] { return solver_->advance_to(time_s, state_); });
            return solver_->has_branched() ? Status::kDiverged : status;
        } catch (const TooMuchWork&) {
            has_ended_ = true;
            return Status::kDiverged;
        }
    }
    [[nodiscard]] bool has_ended() const { return has_ended_; }
    [[nodiscard]] double updates() const { return work_.updates(); }
    [[nodiscard]] std::uint64_t steps() const { return solver_->steps(); }
    /// Where it has a particle, in the scene's directions.
    [[nodiscard]] Vec2 position_m(std::size_t i) const {
        return turned({state_.x_m[i], state_.y_m[i]}, {cosine_sine_.x, -cosine_sine_.y});
    }

  private:
    /// Of the length: a twentieth of the run's tolerance.
    static constexpr double kMovedPerTolerance = 0.2;
    static constexpr std::array<Vec2, kMaxCount> kTurns{
        {{0.8, 0.6}, {5.0 / 13.0, 12.0 / 13.0}, {24.0 / 25.0, 7.0 / 25.0}}};

    /// A solver of system_, a string of rigid links that come taut so much later.
    [[nodiscard]] std::unique_ptr<Solver> solve_string(const Forces& forces, const MethodDef& method,
                                                       const std::vector<double>& longer_m) const {
        std::vector<double> rest_m;
        for (const Bar& bar : system_.bars) rest_m.push_back(bar.rest_m);
        const auto make_part = [=, tolerance = std::get<ExactDef>(method).tolerance](
                                   const System& part, const Forces& there, const MethodDef& by,
                                   std::span<const std::size_t> bars) {
            std::vector<double> own_m;
            for (std::size_t j = 0; j < bars.size(); ++j)  // a former phase may have lengthened it
                own_m.push_back(part.bars[j].rest_m == rest_m[bars[j]] ? longer_m[bars[j]] : 0.0);
            return solve_in_frame_of_pins(part, there, by, [&](const System& body, const Forces& in_frame) {
                return std::make_unique<StringPart>(body, in_frame, tolerance, own_m);
            });
        };
        if (system_.has_events()) return solve_in_phases(system_, forces, method, make_part);
        std::vector<std::size_t> all(system_.bars.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        return make_part(system_, forces, method, all);
    }

    Vec2 cosine_sine_;  ///< of the angle by which it is turned
    System system_;
    std::unique_ptr<Solver> solver_;
    State state_;
    Meter work_;
    bool has_ended_ = false;
};

Checks::Checks(const System& system, const Forces& forces, const Trial& trial, double frame_interval_s) {
    const std::vector<MethodDef> methods = checks_of(system, trial);
    for (const MethodDef& method : methods)
        checks_.push_back(std::make_unique<Check>(system, forces, method, frame_interval_s, size()));
    repeat_run_ = methods.back() == trial.method;
    first_alike_ = repeat_run_ ? 1 : 0;
}

Checks::Checks(const System& string, const Forces& forces, const ExactDef& method, double longer_m) {
    constexpr std::size_t kMaxBits = 3;
    std::vector<double> longer(string.bars.size());
    const auto bits = static_cast<std::size_t>(std::bit_width(longer.size() - 1));
    for (std::size_t number = 0; number < 2 * std::clamp<std::size_t>(bits, 1, kMaxBits); ++number) {
        for (std::size_t k = 0; k < longer.size(); ++k)
            longer[k] = ((k >> (number / 2)) + number) % 2 == 0 ? longer_m : -longer_m;
        checks_.push_back(std::make_unique<Check>(string, forces, method, 0.0, number, longer));
    }
    first_alike_ = size();
}

Checks::~Checks() {
    is_abandoned_ = true;
}

void Checks::start(double time_s, double most_updates) {
    const double expected =
        updates_ / static_cast<double>(size()) * (time_s - time_s_) / time_s_;  // NaN at 0
    time_s_ = time_s;
    most_updates_ = most_updates / static_cast<double>(size());
    if (!(expected > kWorthAThread)) return;  // finish() does it
    // In this thread, by finish(), if the system has none to give.
    constexpr auto kPolicy = std::launch::async | std::launch::deferred;
    for (const auto& check : checks_) {
        pending_.push_back(std::async(kPolicy, [this, &check, time_s] {
            const CancelScope wanted([this] { return !is_abandoned_.load(std::memory_order_relaxed); });
            return check->advance_to(time_s, most_updates_);
        }));
    }
}

Status Checks::finish() {
    constexpr std::chrono::milliseconds kPatience{10};
    Status status = Status::kOk;
    const auto add = [&status](Status one) { status = one == Status::kOk ? status : one; };
    for (std::size_t i = 0; i < checks_.size(); ++i) {
        auto waited = std::future_status::deferred;
        while (!pending_.empty() && (waited = pending_[i].wait_for(kPatience)) == std::future_status::timeout)
            check_cancelled();
        add(waited == std::future_status::deferred ? checks_[i]->advance_to(time_s_, most_updates_)
                                                   : pending_[i].get());
    }
    pending_.clear();
    updates_ = 0.0;
    for (const auto& check : checks_) {
        updates_ += check->updates();
        have_ended_ = have_ended_ || check->has_ended();
    }
    if (!have_ended_) steps_ = checks_.front()->steps();
    return status;
}

double Checks::difference_m(const State& state) const {
    constexpr double kPerRounding = 2.0;
    double largest_m = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        double distance_m2 = 0.0;
        double rounding_m2 = 0.0;
        for (std::size_t a = 0; a < checks_.size(); ++a) {
            const Vec2 at = checks_[a]->position_m(i);
            const Vec2 apart = at - Vec2{state.x_m[i], state.y_m[i]};
            distance_m2 = std::max(dot(apart, apart), distance_m2);
            if (repeat_run_ && a >= first_alike_) rounding_m2 = std::max(dot(apart, apart), rounding_m2);
            for (std::size_t b = first_alike_; b < a; ++b) {
                const Vec2 differ = at - checks_[b]->position_m(i);
                rounding_m2 = std::max(dot(differ, differ), rounding_m2);
            }
        }
        const double distance_m = std::sqrt(distance_m2) + kPerRounding * std::sqrt(rounding_m2);
        if (!(distance_m <= largest_m)) largest_m = std::isnan(distance_m) ? HUGE_VAL : distance_m;
    }
    return largest_m;
}

double Checks::margin_m() const {
    return checks_.front()->margin_m();
}

}  // namespace corda::sim
