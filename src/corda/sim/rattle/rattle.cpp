#include "corda/sim/rattle/rattle.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

constexpr std::array<double, 1> kOrder2{1.0};

// Suzuki (1990): four times 1 / (4 - 4^(1/3)), and in the middle what makes the sum 1.
constexpr double kSuzuki = 0.41449077179437573714235406286;
constexpr std::array<double, 5> kOrder4{kSuzuki, kSuzuki, -0.65796308717750294856941625145, kSuzuki, kSuzuki};

// Kahan and Li (1997), s9odr6a.
constexpr double kSix1 = 0.39216144400731413927925056;
constexpr double kSix2 = 0.33259913678935943859974864;
constexpr double kSix3 = -0.70624617255763935980996482;
constexpr double kSix4 = 0.08221359629355080023149045;
constexpr double kSix5 = 0.79854399093482996339895035;
constexpr std::array<double, 9> kOrder6{kSix1, kSix2, kSix3, kSix4, kSix5, kSix4, kSix3, kSix2, kSix1};

// Kahan and Li (1997), s17odr8a.
constexpr double kEight1 = 0.13020248308889008087881763;
constexpr double kEight2 = 0.56116298177510838456196441;
constexpr double kEight3 = -0.38947496264484728640807860;
constexpr double kEight4 = 0.15884190655515560089621075;
constexpr double kEight5 = -0.39590389413323757733623154;
constexpr double kEight6 = 0.18453964097831570709183254;
constexpr double kEight7 = 0.25837438768632204729397911;
constexpr double kEight8 = 0.29501172360931029887096624;
constexpr double kEight9 = -0.60550853383003451169892108;
constexpr std::array<double, 17> kOrder8{kEight1, kEight2, kEight3, kEight4, kEight5, kEight6,
                                         kEight7, kEight8, kEight9, kEight8, kEight7, kEight6,
                                         kEight5, kEight4, kEight3, kEight2, kEight1};

constexpr std::array<Composition, 4> kCompositions{
    Composition{2, kOrder2, 2.0},
    Composition{4, kOrder4, 2.72},
    Composition{6, kOrder6, 2.53},
    Composition{8, kOrder8, 3.09},
};

/// Two parts are joined again if the doubled span stays below this share of the guard. Below 1, because each
/// change of the parts costs some energy.
constexpr double kJoinShare = 0.8;
/// A step is divided into at most 2^24 parts, so that a step of 1 s can follow frequencies of 1e7 / s.
constexpr int kMaxLevel = 24;
constexpr std::uint64_t kMinParts = std::uint64_t{1} << kMaxLevel;
constexpr double kMaxStepsPerFrame = 1e7;
/// A stage whose kick is below this share of its span does not determine the tension.
constexpr double kShortKick = 1e-3;

void refuse_rigid_strings(const System& system) {
    for (const Body& body : system.bodies) {
        if (!body.material.is_string || body.material.compliance_1_n > 0.0) continue;
        throw Refusal(
            Refusal::Reason::kRigidString,
            "method rattle takes fixed steps and would miss the moments at which the rigid links of a "
            "string come taut");
    }
}

double power_of_half(int exponent) {
    return 1.0 / static_cast<double>(std::uint64_t{1} << exponent);
}

}  // namespace

const Composition& composition(int order) {
    assert(order == 2 || order == 4 || order == 6 || order == 8);
    return kCompositions[static_cast<std::size_t>(order / 2 - 1)];
}

Rattle::Rattle(const System& system, const Forces& forces, const RattleDef& def, double frame_interval_s)
    : Solver(sim::energy_scale_j(system, forces.on_particles(system)), forces.conserve_energy()),
      order_(def.order),
      guard_(def.guard),
      composition_(composition(def.order)),
      constraints_(make_constraint_solver(system)),
      forces_(forces),
      elastic_(system, 0, system.particle_count()),
      mass_kg_(system.mass_kg),
      inverse_mass_1_kg_(constraints_->bars().inverse_mass_1_kg),
      impulse_(constraints_->links().size(), 0.0),
      tension_over_length_n_m_(impulse_.size(), 0.0) {
    refuse_rigid_strings(system);
    if (constraints_->determines_tensions()) find_bars_of_links(system);
    grid_.motion = Motion::start_of(system);
    if (is_elastic()) {
        force_x_n_.assign(mass_kg_.size(), 0.0);
        force_y_n_.assign(mass_kg_.size(), 0.0);
    }
    history_.multipliers.assign(kHistory * composition_.stages.size() * impulse_.size(), 0.0);
    if (!complete(grid_) || !find_tensions()) {
        throw Refusal(Refusal::Reason::kDependentBars,
                      "the rigid bars do not determine their tensions at the start");
    }
    grid_.motion = output_;
    grid_.multiplier = tension_over_length_n_m_;
    const double elastic_square = is_elastic() ? find_forces(output_) : 0.0;
    grid_.frequency_1_s = std::sqrt(constraints_->square_frequency(grid_.multiplier) + elastic_square);
    if (def.step_s) {
        step_s_ = *def.step_s;
    } else {
        const double expected_square = constraints_->expected_square_frequency(
                                           system, kLoadFactor * forces_.strength_m_s2(), grid_.multiplier) +
                                       std::max(elastic_square, elastic_.common_square_frequency());
        const double stable_s = guard_ * composition_.stable_omega_h / std::sqrt(expected_square);
        const double steps = std::max(1.0, std::ceil(frame_interval_s / stable_s));
        if (!(steps <= kMaxStepsPerFrame)) {
            throw Refusal(
                Refusal::Reason::kDefinition,
                fmt::format("its particles vibrate so fast that a frame takes {:.2g} steps of method "
                            "rattle, over the limit of {:g}; give more compliance, less bending, "
                            "heavier particles or less gravity",
                            steps, kMaxStepsPerFrame));
        }
        step_s_ = frame_interval_s / steps;
    }
    assert(step_s_ > 0.0);
}

const char* Rattle::problem_of(const RattleDef& def) {
    const auto& orders = RattleDef::kOrders;
    if (std::ranges::find(orders, def.order) == orders.end()) return "order is none that there is";
    if (def.step_s && !(*def.step_s > 0.0 && std::isfinite(*def.step_s))) return "step_s is not > 0";
    return def.guard > 0.0 && def.guard <= 1.0 ? nullptr : "guard is not within 0 .. 1";
}

std::string Rattle::text_of(const RattleDef& def) {
    return fmt::format("rattle of order {}", def.order) +
           (def.step_s ? fmt::format(", step {:.6g} s", *def.step_s) : "");
}

Status Rattle::advance_to(double time_s, State& state) {
    const FlushDenormals flush;
    const GridTime target = locate(time_s, step_s_);
    assert(step_ <= target.step);
    while (step_ < target.step) {
        if (!step()) return Status::kDiverged;
    }
    if (!target.is_on_grid) {
        between_ = is_near_line_ ? before_ : grid_;
        const auto from = static_cast<double>(is_near_line_ ? step_ - 1 : step_);
        if (!advance(time_s - from * step_s_, between_, nullptr)) return Status::kDiverged;
    }
    const Trajectory& reached = target.is_on_grid ? grid_ : between_;
    if (!complete(reached)) return Status::kDiverged;
    has_branched_ = reached.has_leapt;
    state.time_s = time_s;
    state.x_m = output_.x_m;
    state.y_m = output_.y_m;
    return Status::kOk;
}

bool Rattle::step() {
    if (is_near_line_ && step_over_line()) return true;
    const bool has_lines = constraints_->distance_from_line(grid_.motion) < HUGE_VAL;
    if (has_lines) before_ = grid_;
    if (!advance(step_s_, grid_, &history_)) return false;
    ++step_;
    is_near_line_ = has_lines && constraints_->distance_from_line(grid_.motion) < 1.0;
    return true;
}

bool Rattle::step_over_line() {
    constexpr double kPast = 0.5;
    is_near_line_ = false;
    const double near = constraints_->distance_from_line(grid_.motion);
    over_ = before_;
    if (!advance((1.0 + kPast) * step_s_, over_, nullptr) || over_.has_leapt ||
        !(constraints_->distance_from_line(over_.motion) > near) ||
        !advance((1.0 - kPast) * step_s_, over_, nullptr) || over_.has_leapt)
        return false;
    std::swap(grid_, over_);
    history_.count = 0;
    ++step_;
    return true;
}

bool Rattle::advance(double span_s, Trajectory& trajectory, History* history) {
    const double limit = guard_ * composition_.stable_omega_h;
    std::uint64_t done = 0;
    while (done < kMinParts) {
        const std::uint64_t part = kMinParts >> trajectory.level;
        const double part_s = span_s * power_of_half(trajectory.level);
        const bool stable = trajectory.frequency_1_s * part_s <= limit;
        if (stable) part_start_ = trajectory;
        if (stable && take_part(part_s, trajectory, history)) {
            done += part;
            if (history != nullptr) ++parts_;
            const bool joins = trajectory.level > 0 && done % (2 * part) == 0 &&
                               trajectory.frequency_1_s * 2.0 * part_s <= kJoinShare * limit;
            if (!joins) continue;
            --trajectory.level;
        } else {
            if (stable) std::swap(trajectory, part_start_);
            if (trajectory.level == kMaxLevel) {
                const auto rest = static_cast<double>(kMinParts - done);
                if (!leap(span_s * power_of_half(kMaxLevel) * rest, trajectory)) return false;
                done = kMinParts;
            } else {
                ++trajectory.level;
            }
        }
        if (history != nullptr) history->count = 0;
    }
    return true;
}

bool Rattle::take_part(double part_s, Trajectory& trajectory, History* history) {
    if (history != nullptr) history->newest = (history->newest + 1) % kHistory;
    for (std::size_t i = 0; i < composition_.stages.size(); ++i) {
        const double span_s = composition_.stages[i] * part_s;
        const double decay = forces_.decay(0.5 * (trajectory.last_span_s + span_s));
        const double kick_s = 0.5 * (decay * trajectory.last_span_s + span_s);
        guess(i, kick_s, trajectory, history);
        Stage stage{span_s, decay, kick_s * forces_.uniform_m_s2()};
        const double elastic_square = is_elastic() ? push(kick_s, stage, trajectory.motion) : 0.0;
        if (!constraints_->move(stage, trajectory.motion, impulse_)) return false;
        trajectory.last_span_s = span_s;
        if (std::abs(kick_s) < kShortKick * std::abs(span_s)) continue;
        if (constraints_->tells_tensions()) {
            for (std::size_t k = 0; k < impulse_.size(); ++k) trajectory.multiplier[k] = impulse_[k] / kick_s;
        }
        if (history != nullptr)
            std::copy(trajectory.multiplier.begin(), trajectory.multiplier.end(),
                      multipliers(*history, i, 0));
        trajectory.frequency_1_s =
            std::sqrt(constraints_->square_frequency(trajectory.multiplier) + elastic_square);
        // Negated, so that a NaN fails.
        if (!(trajectory.frequency_1_s * part_s <= guard_ * composition_.stable_omega_h)) return false;
    }
    if (history != nullptr) history->count = std::min(history->count + 1, kHistory);
    return true;
}

bool Rattle::leap(double span_s, Trajectory& trajectory) {
    if (!complete(trajectory)) return false;
    const double decay = forces_.decay(span_s);
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (inverse_mass_1_kg_[i] == 0.0) continue;
        Vec2 push_m_s = span_s * forces_.uniform_m_s2();
        if (is_elastic())
            push_m_s = push_m_s + span_s * inverse_mass_1_kg_[i] * Vec2{force_x_n_[i], force_y_n_[i]};
        output_.vx_m_s[i] = decay * (output_.vx_m_s[i] + push_m_s.x);
        output_.vy_m_s[i] = decay * (output_.vy_m_s[i] + push_m_s.y);
    }
    if (!constraints_->leap(span_s, output_)) return false;
    const double elastic_square = is_elastic() ? find_forces(output_) : 0.0;
    if (find_tensions()) trajectory.multiplier = tension_over_length_n_m_;
    trajectory.motion = output_;
    trajectory.last_span_s = 0.0;
    trajectory.level = 0;
    trajectory.has_leapt = true;
    trajectory.frequency_1_s =
        std::sqrt(constraints_->square_frequency(trajectory.multiplier) + elastic_square);
    return true;
}

double Rattle::find_forces(const Motion& motion) {
    std::fill(force_x_n_.begin(), force_x_n_.end(), 0.0);
    std::fill(force_y_n_.begin(), force_y_n_.end(), 0.0);
    return elastic_.add_forces(motion.x_m.data(), motion.y_m.data(), force_x_n_.data(), force_y_n_.data());
}

double Rattle::push(double kick_s, Stage& stage, Motion& motion) {
    const double square_frequency = find_forces(motion);
    const double slowdown = stage.decay - 1.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        const double weighted_s = kick_s * inverse_mass_1_kg_[i];
        const double change_x = slowdown * motion.vx_m_s[i] + stage.push_m_s.x + weighted_s * force_x_n_[i];
        const double change_y = slowdown * motion.vy_m_s[i] + stage.push_m_s.y + weighted_s * force_y_n_[i];
        add_unrounded(motion.vx_m_s[i], motion.vx_lost_m_s[i], change_x);
        add_unrounded(motion.vy_m_s[i], motion.vy_lost_m_s[i], change_y);
    }
    stage.decay = 1.0;
    stage.push_m_s = {};
    return square_frequency;
}

double* Rattle::multipliers(History& history, std::size_t stage, int age) const {
    const auto slot = static_cast<std::size_t>((history.newest - age + kHistory) % kHistory);
    return history.multipliers.data() + (slot * composition_.stages.size() + stage) * impulse_.size();
}

void Rattle::guess(std::size_t stage, double kick_s, const Trajectory& trajectory, History* history) {
    const std::size_t count = impulse_.size();
    const int known = history != nullptr ? history->count : 0;
    const double* const last = known > 0 ? multipliers(*history, stage, 1) : trajectory.multiplier.data();
    // The polynomial through the known multipliers of this stage, evaluated one part later.
    if (known < 2) {
        for (std::size_t k = 0; k < count; ++k) impulse_[k] = kick_s * last[k];
        return;
    }
    const double* const second = multipliers(*history, stage, 2);
    if (known < 3) {
        for (std::size_t k = 0; k < count; ++k) impulse_[k] = kick_s * (2.0 * last[k] - second[k]);
        return;
    }
    // The slot of age 0 still holds the oldest.
    const double* const third = multipliers(*history, stage, 0);
    for (std::size_t k = 0; k < count; ++k) impulse_[k] = kick_s * (3.0 * (last[k] - second[k]) + third[k]);
}

bool Rattle::complete(const Trajectory& trajectory) {
    output_ = trajectory.motion;
    const double half_s = 0.5 * trajectory.last_span_s;
    const double decay = forces_.decay(half_s);
    if (is_elastic()) {
        find_forces(output_);
        for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
            output_.vx_m_s[i] += half_s * inverse_mass_1_kg_[i] * force_x_n_[i];
            output_.vy_m_s[i] += half_s * inverse_mass_1_kg_[i] * force_y_n_[i];
        }
    }
    const Vec2 push_m_s = half_s * forces_.uniform_m_s2();
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        const bool is_held = inverse_mass_1_kg_[i] == 0.0;
        output_.vx_m_s[i] = is_held ? 0.0 : decay * (output_.vx_m_s[i] + push_m_s.x);
        output_.vy_m_s[i] = is_held ? 0.0 : decay * (output_.vy_m_s[i] + push_m_s.y);
    }
    const auto links = constraints_->links();
    const auto along = [&](const Link& link) {
        return Vec2{output_.x_m[link.b] - output_.x_m[link.a], output_.y_m[link.b] - output_.y_m[link.a]};
    };
    for (std::size_t k = 0; k < links.size(); ++k) {
        const Link& link = links[k];
        const Vec2 d = along(link);
        impulse_[k] = d.x * (output_.vx_m_s[link.b] - output_.vx_m_s[link.a]) +
                      d.y * (output_.vy_m_s[link.b] - output_.vy_m_s[link.a]);
    }
    if (!constraints_->solve(output_, impulse_)) return false;
    for (std::size_t k = 0; k < links.size(); ++k) {
        const Link& link = links[k];
        const Vec2 pull = impulse_[k] * along(link);
        output_.vx_m_s[link.a] += inverse_mass_1_kg_[link.a] * pull.x;
        output_.vy_m_s[link.a] += inverse_mass_1_kg_[link.a] * pull.y;
        output_.vx_m_s[link.b] -= inverse_mass_1_kg_[link.b] * pull.x;
        output_.vy_m_s[link.b] -= inverse_mass_1_kg_[link.b] * pull.y;
    }
    return true;
}

bool Rattle::find_tensions() {
    const auto links = constraints_->links();
    tension_over_length_n_m_ = loads(constraints_->bars(), output_, forces_.uniform_m_s2());
    if (is_elastic()) {
        for (std::size_t k = 0; k < links.size(); ++k) {
            const auto [a, b, rest_m] = links[k];
            const double wa = inverse_mass_1_kg_[a];
            const double wb = inverse_mass_1_kg_[b];
            tension_over_length_n_m_[k] +=
                (output_.x_m[b] - output_.x_m[a]) * (wb * force_x_n_[b] - wa * force_x_n_[a]) +
                (output_.y_m[b] - output_.y_m[a]) * (wb * force_y_n_[b] - wa * force_y_n_[a]);
        }
    }
    return constraints_->solve(output_, tension_over_length_n_m_) && constraints_->had_full_rank();
}

void Rattle::velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) {
    vx_m_s = output_.vx_m_s;
    vy_m_s = output_.vy_m_s;
}

void Rattle::find_bars_of_links(const System& system) {
    for (const Body& body : system.bodies) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
            const Bar& bar = system.bars[k];
            const bool moves = inverse_mass_1_kg_[bar.a] > 0.0 || inverse_mass_1_kg_[bar.b] > 0.0;
            if (body.material.compliance_1_n == 0.0 && moves) bar_of_link_.push_back(k);
        }
    }
    assert(bar_of_link_.size() == constraints_->links().size());
}

bool Rattle::tensions(std::vector<double>& tension_n) {
    if (!constraints_->determines_tensions()) return Solver::tensions(tension_n);
    // The factors of complete() serve again. Without full rank the matrix would have to be factorised again,
    // which takes long.
    const bool are_known = constraints_->had_full_rank() && find_tensions();
    for (std::size_t k = 0; k < bar_of_link_.size(); ++k) {
        const auto [a, b, rest_m] = constraints_->links()[k];
        const double length_m = length(output_.x_m[b] - output_.x_m[a], output_.y_m[b] - output_.y_m[a]);
        tension_n[bar_of_link_[k]] =
            are_known ? tension_over_length_n_m_[k] * length_m : std::numeric_limits<double>::quiet_NaN();
    }
    elastic_.tensions(output_.x_m.data(), output_.y_m.data(), tension_n);
    return true;
}

double Rattle::energy_j() const {
    double energy_j = 0.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (inverse_mass_1_kg_[i] == 0.0) continue;
        const double vx = output_.vx_m_s[i];
        const double vy = output_.vy_m_s[i];
        energy_j += mass_kg_[i] *
                    (0.5 * (vx * vx + vy * vy) + forces_.potential_j_kg({output_.x_m[i], output_.y_m[i]}));
    }
    if (is_elastic()) energy_j += elastic_.energy_j(output_.x_m.data(), output_.y_m.data());
    return energy_j;
}

}  // namespace corda::sim
