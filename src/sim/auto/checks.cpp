#include "corda/sim/auto/checks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "corda/sim/distance.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// From here on a frame of `exact` takes longer than starting a thread, some 30 us.
constexpr std::size_t kManyParticles = 100;

/// Moves the free particles of a start by about as much as it is rounded, in directions of no order, others
/// for each seed. Strings stay: whether a link is taut must not change.
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

}  // namespace

class Checks::Check {
  public:
    Check(const System& system, const Forces& forces, const MethodDef& method, double frame_interval_s,
          std::size_t number, const GoesOn& goes_on)
        : turn_(turn(number)), system_(system) {
        if (number > 0) move_by_rounding(system_, static_cast<std::uint32_t>(number));
        for (std::size_t i = 0; i < system.particle_count(); ++i) {
            const Vec2 position = turn_.of({system_.x_m[i], system_.y_m[i]});
            const Vec2 velocity = turn_.of({system_.vx_m_s[i], system_.vy_m_s[i]});
            system_.x_m[i] = position.x;
            system_.y_m[i] = position.y;
            system_.vx_m_s[i] = velocity.x;
            system_.vy_m_s[i] = velocity.y;
        }
        solver_ = make_solver(system_, Forces(ForceTerm{turn_.of(forces.uniform_m_s2()), forces.drag_1_s()}),
                              {&method, 1}, frame_interval_s, goes_on);
        state_ = {0.0, system_.x_m, system_.y_m};
    }
    Check(const Check&) = delete;
    Check& operator=(const Check&) = delete;

    /// kDiverged also if it has branched.
    Status advance_to(double time_s, const GoesOn& goes_on) {
        StopCheck stop(goes_on);
        const Status status = solver_->advance_to(time_s, state_, stop);
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
        constexpr std::array<Turn, kMost> kTurns{
            {{0.8, 0.6}, {5.0 / 13.0, 12.0 / 13.0}, {24.0 / 25.0, 7.0 / 25.0}}};
        return kTurns[number];
    }

    Turn turn_;
    System system_;
    std::unique_ptr<Solver> solver_;
    State state_;
};

Checks::Checks(const System& system, const Forces& forces, const MethodDef& method, double frame_interval_s,
               std::size_t count, const GoesOn& goes_on)
    : goes_on_(goes_on), in_threads_(system.particle_count() >= kManyParticles) {
    for (std::size_t number = 0; number < count; ++number)
        checks_.push_back(std::make_unique<Check>(system, forces, method, frame_interval_s, number, goes_on));
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
        pending_.push_back(
            std::async(kPolicy, [this, &check, time_s] { return check->advance_to(time_s, is_wanted_); }));
    }
}

Status Checks::finish() {
    constexpr std::chrono::milliseconds kPatience{10};
    Status status = Status::kOk;
    const auto add = [&status](Status one) { status = one == Status::kOk ? status : one; };
    for (std::size_t i = 0; i < checks_.size(); ++i) {
        auto waited = std::future_status::deferred;
        while (in_threads_ && (waited = pending_[i].wait_for(kPatience)) == std::future_status::timeout)
            require_going_on(!goes_on_ || goes_on_());
        add(waited == std::future_status::deferred ? checks_[i]->advance_to(time_s_, goes_on_)
                                                   : pending_[i].get());
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
            for (std::size_t b = 0; b < a; ++b) {
                const Vec2 differ = at - checks_[b]->position_m(i);
                rounding_m = std::max(length(differ.x, differ.y), rounding_m);
            }
        }
        distance_m += kPerRounding * rounding_m;
        if (!(distance_m <= largest_m)) largest_m = std::isnan(distance_m) ? HUGE_VAL : distance_m;
    }
    return largest_m;
}

}  // namespace corda::sim
