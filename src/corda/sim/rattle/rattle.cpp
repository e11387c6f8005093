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

/// A step is divided into at most 2^24 parts, so that a step of 1 s can follow frequencies of 1e7 / s.
constexpr int kMaxLevel = 24;
constexpr std::uint64_t kMinParts = std::uint64_t{1} << kMaxLevel;
/// Two parts are joined again if the doubled span stays below this share of the guard. Below 1, because each
/// change of the parts costs some energy.
constexpr double kJoinShare = 0.8;
/// A stage whose kick is below this share of its span does not determine the tension.
constexpr double kShortKick = 1e-3;
constexpr double kMaxStepsPerFrame = 1e7;

void refuse_rigid_strings(const System& system) {
    for (const Body& body : system.bodies) {
        if (!body.material.is_string || body.material.compliance_1_n > 0.0) continue;
        throw Refusal(
            Refusal::Reason::kRigidString,
            "method rattle takes fixed steps and would miss the moments at which the rigid links of a "
            "string come taut");
    }
}

/// The frame interval over the smallest whole number that makes a stable step.
double stable_step_s(const RattleModel& model, double square_frequency, double frame_interval_s) {
    const double stable_s = model.guard * model.composition.stable_omega_h / std::sqrt(square_frequency);
    const double steps = std::max(1.0, std::ceil(frame_interval_s / stable_s));
    if (!(steps <= kMaxStepsPerFrame)) {
        throw Refusal(Refusal::Reason::kDefinition,
                      fmt::format("its particles vibrate so fast that a frame takes {:.2g} steps of method "
                                  "rattle, over the limit of {:g}; give more compliance, less bending, "
                                  "heavier particles or less gravity",
                                  steps, kMaxStepsPerFrame));
    }
    return frame_interval_s / steps;
}

RattleModel prepare_rattle(const System& system, const Forces& forces, const RattleDef& def) {
    RattleModel model{.composition = composition(def.order),
                      .guard = def.guard,
                      .constraints = make_constraint_solver(system),
                      .forces = forces,
                      .elastic = {system, 0, system.particle_count()}};
    model.pins = moving_pins(system);
    const std::vector<std::uint32_t>& held = model.constraints->bars().held;
    if (!model.pins.empty()) model.held_m_s.resize(held.size());
    if (!model.pins.empty() && std::ssize(held) != std::ranges::count(system.inverse_mass_1_kg, 0.0))
        throw Refusal(Refusal::Reason::kUnlikeMoves,
                      "a straight row of bars joins pins that move differently");
    model.impulse.assign(model.constraints->links().size(), 0.0);
    model.history.assign(RattleModel::kHistory * model.composition.stages.size() * model.impulse.size(), 0.0);
    if (model.elastic.empty()) return model;
    model.force_x_n.assign(system.particle_count(), 0.0);
    model.force_y_n.assign(system.particle_count(), 0.0);
    return model;
}

/// Writes the elastic forces at these positions to the model, and returns their bound on the square of the
/// largest frequency.
double find_forces(RattleModel& model, const Motion& motion) {
    if (model.elastic.empty()) return 0.0;
    std::fill(model.force_x_n.begin(), model.force_x_n.end(), 0.0);
    std::fill(model.force_y_n.begin(), model.force_y_n.end(), 0.0);
    return model.elastic.add_forces({motion.x_m.data(), motion.y_m.data()},
                                    {model.force_x_n.data(), model.force_y_n.data()});
}

void set_time(RattleModel& model, double time_s) {
    model.time_s = time_s;
    model.forces.set_time(time_s);
}

/// Gives pins their mean velocities over a stage from the time set.
void move_pins(RattleModel& model, Stage& stage) {
    if (model.pins.empty()) return;
    const std::vector<std::uint32_t>& held = model.constraints->bars().held;
    for (const MovingPin& pin : model.pins) {
        const auto at = static_cast<std::size_t>(std::ranges::lower_bound(held, pin.particle) - held.begin());
        model.held_m_s[at] = (1.0 / stage.span_s) *
                             (pin.displacement(model.time_s + stage.span_s) - pin.displacement(model.time_s));
    }
    stage.held_m_s = model.held_m_s;
}

/// Brings pins to their places, from which rounding has moved them.
void place_pins(const RattleModel& model, double time_s, Motion& motion) {
    for (const MovingPin& pin : model.pins) {
        const Vec2 place_m = pin.place_m(time_s);
        motion.x_m[pin.particle] = place_m.x;
        motion.y_m[pin.particle] = place_m.y;
        motion.x_lost_m[pin.particle] = motion.y_lost_m[pin.particle] = 0.0;
    }
}

/// Writes a trajectory's state with complete velocities to `output`, and the elastic forces there to the
/// model. False if the bars do not determine them.
bool complete(RattleModel& model, const Trajectory& trajectory, Motion& output) {
    const std::vector<double>& inverse_mass = model.constraints->bars().inverse_mass_1_kg;
    const std::span<const Link> links = model.constraints->links();
    // The second half of the last stage's kick.
    output = trajectory.motion;
    set_time(model, trajectory.time_s);
    const double half_s = 0.5 * trajectory.last_span_s;
    const double decay = model.forces.decay(half_s);
    if (!model.elastic.empty()) {
        find_forces(model, output);
        for (std::size_t i = 0; i < inverse_mass.size(); ++i) {
            output.vx_m_s[i] += half_s * inverse_mass[i] * model.force_x_n[i];
            output.vy_m_s[i] += half_s * inverse_mass[i] * model.force_y_n[i];
        }
    }
    const Vec2 push_m_s = half_s * model.forces.uniform_m_s2();
    for (std::size_t i = 0; i < inverse_mass.size(); ++i) {
        const bool is_held = inverse_mass[i] == 0.0;
        output.vx_m_s[i] = is_held ? 0.0 : decay * (output.vx_m_s[i] + push_m_s.x);
        output.vy_m_s[i] = is_held ? 0.0 : decay * (output.vy_m_s[i] + push_m_s.y);
    }
    for (const MovingPin& pin : model.pins) {
        const Vec2 velocity_m_s = pin.velocity(model.time_s);
        output.vx_m_s[pin.particle] = velocity_m_s.x;
        output.vy_m_s[pin.particle] = velocity_m_s.y;
    }
    // The impulses q that leave no bar a change of its length.
    for (std::size_t k = 0; k < links.size(); ++k)
        model.impulse[k] = dot(along(links[k], output), apart(links[k], output));
    if (!model.constraints->solve(output, model.impulse)) return false;
    for (std::size_t k = 0; k < links.size(); ++k) {
        const auto [a, b, rest_m] = links[k];
        const Vec2 pull = model.impulse[k] * along(links[k], output);
        output.vx_m_s[a] += inverse_mass[a] * pull.x;
        output.vy_m_s[a] += inverse_mass[a] * pull.y;
        output.vx_m_s[b] -= inverse_mass[b] * pull.x;
        output.vy_m_s[b] -= inverse_mass[b] * pull.y;
    }
    return true;
}

/// Writes the tension over length, N / m, of each rigid bar in a complete state whose elastic forces are the
/// model's. False if bars depend on each other there.
bool find_multipliers(const RattleModel& model, const Motion& motion, std::vector<double>& multiplier) {
    const RigidBars& bars = model.constraints->bars();
    multiplier = loads(bars, motion, model.forces.uniform_m_s2());
    for (const MovingPin& pin : model.pins) {  // drag slows the free ends of its bars alone
        const Vec2 own =
            pin.acceleration(model.time_s) + model.forces.drag_1_s() * pin.velocity(model.time_s);
        for (std::size_t k = 0; k < bars.links.size(); ++k) {
            const double load = dot(along(bars.links[k], motion), own);
            if (bars.links[k].a == pin.particle) multiplier[k] -= load;
            if (bars.links[k].b == pin.particle) multiplier[k] += load;
        }
    }
    if (!model.elastic.empty()) {
        for (std::size_t k = 0; k < bars.links.size(); ++k) {
            const auto [a, b, rest_m] = bars.links[k];
            const double wa = bars.inverse_mass_1_kg[a];
            const double wb = bars.inverse_mass_1_kg[b];
            multiplier[k] +=
                dot(along(bars.links[k], motion), {wb * model.force_x_n[b] - wa * model.force_x_n[a],
                                                   wb * model.force_y_n[b] - wa * model.force_y_n[a]});
        }
    }
    return model.constraints->solve(motion, multiplier) && model.constraints->had_full_rank();
}

/// The multipliers of a stage, `age` parts of the grid ago.
double* multipliers(RattleModel& model, std::size_t stage, int age) {
    const auto slot =
        static_cast<std::size_t>((model.newest - age + RattleModel::kHistory) % RattleModel::kHistory);
    return model.history.data() + (slot * model.composition.stages.size() + stage) * model.impulse.size();
}

/// Writes the impulses expected of a stage: those of the polynomial through its multipliers in the last
/// `known` parts of the grid, evaluated one part later; without any, those of the trajectory's last stage.
void guess(RattleModel& model, std::size_t stage, double kick_s, int known, const Trajectory& trajectory) {
    double* const impulse = model.impulse.data();
    const std::size_t count = model.impulse.size();
    const double* const last = known > 0 ? multipliers(model, stage, 1) : trajectory.multiplier.data();
    if (known < 2) {
        for (std::size_t k = 0; k < count; ++k) impulse[k] = kick_s * last[k];
        return;
    }
    const double* const second = multipliers(model, stage, 2);
    if (known < 3) {
        for (std::size_t k = 0; k < count; ++k) impulse[k] = kick_s * (2.0 * last[k] - second[k]);
        return;
    }
    // The slot of age 0 still holds the oldest.
    const double* const third = multipliers(model, stage, 0);
    for (std::size_t k = 0; k < count; ++k) impulse[k] = kick_s * (3.0 * (last[k] - second[k]) + third[k]);
}

/// Applies the decay and the push of a stage together with the elastic forces; returns what is left of it.
CORDA_AVX2_CLONES Stage push(const RattleModel& model, double kick_s, const Stage& stage, Motion& motion) {
    const std::vector<double>& inverse_mass = model.constraints->bars().inverse_mass_1_kg;
    const double slowdown = stage.decay - 1.0;
    CORDA_INDEPENDENT
    for (std::size_t i = 0; i < inverse_mass.size(); ++i) {
        const double weighted_s = kick_s * inverse_mass[i];
        const double change_x =
            slowdown * motion.vx_m_s[i] + stage.push_m_s.x + weighted_s * model.force_x_n[i];
        const double change_y =
            slowdown * motion.vy_m_s[i] + stage.push_m_s.y + weighted_s * model.force_y_n[i];
        add_unrounded(motion.vx_m_s[i], motion.vx_lost_m_s[i], change_x);
        add_unrounded(motion.vy_m_s[i], motion.vy_lost_m_s[i], change_y);
    }
    return {stage.span_s, 1.0, {}};
}

/// Takes the stages of one part. False if one fails, or if the frequencies grow too high for the part.
bool take_part(RattleModel& model, double part_s, bool is_grid, Trajectory& trajectory) {
    const int known = is_grid ? model.known : 0;
    if (is_grid) model.newest = (model.newest + 1) % RattleModel::kHistory;
    for (std::size_t i = 0; i < model.composition.stages.size(); ++i) {
        // The second half of the last stage's kick and the first half of this one's.
        const double span_s = model.composition.stages[i] * part_s;
        const double decay = model.forces.decay(0.5 * (trajectory.last_span_s + span_s));
        const double kick_s = 0.5 * (decay * trajectory.last_span_s + span_s);
        guess(model, i, kick_s, known, trajectory);
        set_time(model, trajectory.time_s);
        Stage stage{span_s, decay, kick_s * model.forces.uniform_m_s2()};
        const double elastic_square = find_forces(model, trajectory.motion);
        if (!model.elastic.empty()) stage = push(model, kick_s, stage, trajectory.motion);
        move_pins(model, stage);
        if (!model.constraints->move(stage, trajectory.motion, model.impulse)) return false;
        trajectory.last_span_s = span_s;
        trajectory.time_s += span_s;
        place_pins(model, trajectory.time_s, trajectory.motion);
        // What the impulses tell of the tensions, and these of the frequencies.
        if (std::abs(kick_s) < kShortKick * std::abs(span_s)) continue;
        std::vector<double>& multiplier = trajectory.multiplier;
        if (model.constraints->tells_tensions()) {
            for (std::size_t k = 0; k < multiplier.size(); ++k) multiplier[k] = model.impulse[k] / kick_s;
        }
        if (is_grid) std::copy(multiplier.begin(), multiplier.end(), multipliers(model, i, 0));
        trajectory.frequency_1_s =
            std::sqrt(model.constraints->square_frequency(multiplier) + elastic_square);
        // Negated, so that a NaN fails.
        if (!(trajectory.frequency_1_s * part_s <= model.guard * model.composition.stable_omega_h))
            return false;
    }
    if (is_grid) model.known = std::min(model.known + 1, RattleModel::kHistory);
    return true;
}

/// Completes a step whose parts fail.
bool leap(RattleModel& model, double span_s, Trajectory& trajectory) {
    Motion motion;
    if (!model.pins.empty() || !complete(model, trajectory, motion)) return false;
    const std::vector<double>& inverse_mass = model.constraints->bars().inverse_mass_1_kg;
    const double decay = model.forces.decay(span_s);
    for (std::size_t i = 0; i < inverse_mass.size(); ++i) {
        if (inverse_mass[i] == 0.0) continue;
        Vec2 push_m_s = span_s * model.forces.uniform_m_s2();
        if (!model.elastic.empty())
            push_m_s = push_m_s + span_s * inverse_mass[i] * Vec2{model.force_x_n[i], model.force_y_n[i]};
        motion.vx_m_s[i] = decay * (motion.vx_m_s[i] + push_m_s.x);
        motion.vy_m_s[i] = decay * (motion.vy_m_s[i] + push_m_s.y);
    }
    if (!model.constraints->leap(span_s, motion)) return false;
    const double elastic_square = find_forces(model, motion);
    std::vector<double> multiplier;
    if (find_multipliers(model, motion, multiplier)) trajectory.multiplier = std::move(multiplier);
    trajectory.motion = std::move(motion);
    trajectory.last_span_s = 0.0;
    trajectory.time_s += span_s;
    set_time(model, trajectory.time_s);
    trajectory.level = 0;
    trajectory.has_leapt = true;
    trajectory.frequency_1_s =
        std::sqrt(model.constraints->square_frequency(trajectory.multiplier) + elastic_square);
    return true;
}

/// Advances by `span_s` in as many parts as are needed. `is_grid`: the parts are those of the grid, in
/// order. False if no part is short enough and there is no leap.
bool advance(RattleModel& model, double span_s, bool is_grid, Trajectory& trajectory) {
    const double limit = model.guard * model.composition.stable_omega_h;
    std::uint64_t done = 0;
    while (done < kMinParts) {
        const std::uint64_t part = kMinParts >> trajectory.level;
        const double part_s = std::ldexp(span_s, -trajectory.level);
        const bool stable = trajectory.frequency_1_s * part_s <= limit;
        if (stable) model.part_start = trajectory;
        if (stable && take_part(model, part_s, is_grid, trajectory)) {
            done += part;
            if (is_grid) ++model.parts;
            const bool joins = trajectory.level > 0 && done % (2 * part) == 0 &&
                               trajectory.frequency_1_s * 2.0 * part_s <= kJoinShare * limit;
            if (!joins) continue;
            --trajectory.level;
        } else {
            if (stable) std::swap(trajectory, model.part_start);
            if (trajectory.level == kMaxLevel) {
                const auto rest = static_cast<double>(kMinParts - done);
                if (!leap(model, std::ldexp(span_s, -kMaxLevel) * rest, trajectory)) return false;
                done = kMinParts;
            } else {
                ++trajectory.level;
            }
        }
        if (is_grid) model.known = 0;
    }
    return true;
}

/// Advances by `span_s` and ends steps at the keys of paths.
bool advance_by_keys(RattleModel& model, double span_s, bool is_grid, Trajectory& trajectory) {
    const double near_s = 1e-9 * span_s;  // a key nearer to an end counts as there
    const double end_s = trajectory.time_s + span_s;
    for (double rest_s = span_s;; rest_s = end_s - trajectory.time_s) {
        const double key_s = std::min(model.forces.next_key_s(trajectory.time_s + near_s),
                                      next_key_s(model.pins, trajectory.time_s + near_s));
        if (!(key_s < end_s - near_s)) return advance(model, rest_s, is_grid, trajectory);
        is_grid = false;
        model.known = 0;
        if (!advance(model, key_s - trajectory.time_s, is_grid, trajectory)) return false;
        trajectory.time_s = key_s;
    }
}

}  // namespace

const Composition& composition(int order) {
    assert(order == 2 || order == 4 || order == 6 || order == 8);
    return kCompositions[static_cast<std::size_t>(order / 2 - 1)];
}

Rattle::Rattle(const System& system, const Forces& forces, const RattleDef& def, double frame_interval_s)
    : Solver(sim::energy_scale_j(system, forces.on_particles(system)), forces.conserve_energy()),
      model_(prepare_rattle(system, forces, def)),
      mass_kg_(system.mass_kg) {
    refuse_rigid_strings(system);
    const ConstraintSolver& constraints = *model_.constraints;
    if (constraints.determines_tensions()) bar_of_link_ = bars_of_links(system, constraints.bars());
    grid_.motion = Motion::start_of(system);
    if (!complete(model_, grid_, output_) || !find_multipliers(model_, output_, grid_.multiplier)) {
        throw Refusal(Refusal::Reason::kDependentBars,
                      "the rigid bars do not determine their tensions at the start");
    }
    grid_.motion = output_;
    const double elastic_square = find_forces(model_, output_);
    grid_.frequency_1_s = std::sqrt(constraints.square_frequency(grid_.multiplier) + elastic_square);
    if (def.step_s) {
        step_s_ = *def.step_s;
    } else {
        const double expected_square = constraints.expected_square_frequency(
                                           system, kLoadFactor * forces.strength_m_s2(), grid_.multiplier) +
                                       std::max(elastic_square, model_.elastic.common_square_frequency());
        const double drive_1_s = forces.frequency_1_s();
        step_s_ = stable_step_s(model_, std::max(expected_square, drive_1_s * drive_1_s), frame_interval_s);
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
        aside_ = is_near_line_ ? before_ : grid_;
        const auto from = static_cast<double>(is_near_line_ ? step_ - 1 : step_);
        if (!advance_by_keys(model_, time_s - from * step_s_, false, aside_)) return Status::kDiverged;
    }
    const Trajectory& reached = target.is_on_grid ? grid_ : aside_;
    if (!complete(model_, reached, output_)) return Status::kDiverged;
    has_branched_ = reached.has_leapt;
    state.time_s = time_s;
    state.x_m = output_.x_m;
    state.y_m = output_.y_m;
    return Status::kOk;
}

bool Rattle::step() {
    grid_.time_s = static_cast<double>(step_) * step_s_;
    if (is_near_line_ && step_over_line()) return true;
    ConstraintSolver& constraints = *model_.constraints;
    const bool has_lines = constraints.distance_from_line(grid_.motion) < HUGE_VAL;
    if (has_lines) before_ = grid_;
    if (!advance_by_keys(model_, step_s_, true, grid_)) return false;
    ++step_;
    is_near_line_ = has_lines && constraints.distance_from_line(grid_.motion) < 1.0;
    return true;
}

bool Rattle::step_over_line() {
    constexpr double kPast = 0.5;
    is_near_line_ = false;
    const auto advances = [&](double steps) {
        return advance_by_keys(model_, steps * step_s_, false, aside_) && !aside_.has_leapt;
    };
    const double near = model_.constraints->distance_from_line(grid_.motion);
    aside_ = before_;
    if (!advances(1.0 + kPast) || !(model_.constraints->distance_from_line(aside_.motion) > near) ||
        !advances(1.0 - kPast))
        return false;
    std::swap(grid_, aside_);
    model_.known = 0;
    ++step_;
    return true;
}

void Rattle::velocities(State& state) {
    state.vx_m_s = output_.vx_m_s;
    state.vy_m_s = output_.vy_m_s;
}

bool Rattle::tensions(std::vector<double>& tension_n) {
    const ConstraintSolver& constraints = *model_.constraints;
    if (!constraints.determines_tensions()) return Solver::tensions(tension_n);
    // The factors of complete() serve again. Without full rank the matrix would have to be factorised again,
    // which takes long.
    const bool are_known = constraints.had_full_rank() && find_multipliers(model_, output_, multiplier_);
    for (std::size_t k = 0; k < bar_of_link_.size(); ++k) {
        const Vec2 d = along(constraints.links()[k], output_);
        tension_n[bar_of_link_[k]] =
            are_known ? multiplier_[k] * length(d.x, d.y) : std::numeric_limits<double>::quiet_NaN();
    }
    model_.elastic.tensions(output_.x_m.data(), output_.y_m.data(), tension_n);
    return true;
}

double Rattle::energy_j() const {
    double energy_j = 0.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (model_.constraints->bars().inverse_mass_1_kg[i] == 0.0) continue;
        const Vec2 velocity{output_.vx_m_s[i], output_.vy_m_s[i]};
        energy_j += mass_kg_[i] * (0.5 * dot(velocity, velocity) +
                                   model_.forces.potential_j_kg({output_.x_m[i], output_.y_m[i]}));
    }
    if (!model_.elastic.empty()) energy_j += model_.elastic.energy_j(output_.x_m.data(), output_.y_m.data());
    return energy_j;
}

}  // namespace corda::sim
