#include "corda/sim/exact/net_dynamics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"

namespace corda::sim {
namespace {

/// Share of its length by which a bar outside the tree may miss its end; those that do not close miss it by
/// about as much as it is long.
constexpr double kClosed = 1e-6;

/// The cube of the number of groups, to which the cost of an evaluation is proportional, may be this multiple
/// of the number of particles; beyond, sparse matrices (`rattle`) are quicker. A grid of 200 x 200 has 1600.
constexpr double kMaxCube = 50'000.0;

/// Rows that Gauss's elimination of the upper triangle takes at a time.
constexpr std::size_t kRowsAtATime = 4;

/// The product of complex numbers.
Vec2 times(Vec2 a, Vec2 b) {
    return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
}

[[noreturn]] void refuse() {
    throw Refusal(
        Refusal::Reason::kRigidGraph,
        "method exact moves rigid bars only if they form an open chain, or a net of parallelograms and "
        "triangles that can turn independently");
}

}  // namespace

NetDynamics::NetDynamics(const System& system, const Forces& forces)
    : system_(system), forces_(forces), mass_kg_(system.mass_kg), state_{0.0, system.x_m, system.y_m} {
    assert(system.bodies.size() == 1);
    if (!system.bends.empty()) refuse();
    const std::vector<double> held = inverse_masses_with_taut_rows_held(system);
    const BarGroups bars(system, held);
    groups_ = bars.count;
    std::size_t held_count = 0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (!bars.is_held[i]) continue;
        mass_kg_[i] = 0.0;
        ++held_count;
    }
    is_free_ = held_count == 0;
    const auto size = static_cast<double>(groups_);
    if (size * size * size > kMaxCube * static_cast<double>(mass_kg_.size())) refuse();
    grow_tree(bars);
    if (arms_.size() + std::max<std::size_t>(held_count, 1) != mass_kg_.size() || !turns_freely(bars))
        refuse();
    // As many bars as the groups leave freedoms to lose.
    const auto moves = [&system](const Bar& bar) {
        return !system.is_pinned(bar.a) || !system.is_pinned(bar.b);
    };
    const auto moving = static_cast<std::size_t>(std::ranges::count_if(system.bars, moves));
    const auto free = mass_kg_.size() - static_cast<std::size_t>(std::ranges::count(held, 0.0));
    has_tensions_ = held == system.inverse_mass_1_kg && moving + groups_ + (is_free_ ? 2 : 0) == 2 * free;
    measure_inertia();
    set_start(system);
}

NetDynamics::~NetDynamics() = default;

void NetDynamics::grow_tree(const BarGroups& bars) {
    std::vector<std::vector<std::uint32_t>> bars_at(system_.particle_count());
    for (std::uint32_t k = 0; k < system_.bars.size(); ++k) {
        bars_at[system_.bars[k].a].push_back(k);
        bars_at[system_.bars[k].b].push_back(k);
    }
    std::vector<bool> is_reached(system_.particle_count());
    std::vector<std::uint32_t> to_do;
    for (std::uint32_t i = 0; i < is_reached.size(); ++i) {
        is_reached[i] = mass_kg_[i] == 0.0 || (is_free_ && i == 0);
        if (is_reached[i]) to_do.push_back(i);
    }
    for (std::size_t k = 0; k < to_do.size(); ++k) {
        const std::uint32_t from = to_do[k];
        count_work(1);
        for (const std::uint32_t bar : bars_at[from]) {
            const std::uint32_t to = system_.bars[bar].a == from ? system_.bars[bar].b : system_.bars[bar].a;
            if (is_reached[to]) continue;
            is_reached[to] = true;
            to_do.push_back(to);
            arms_.push_back({from,
                             to,
                             bars.of_bar[bar],
                             {system_.x_m[to] - system_.x_m[from], system_.y_m[to] - system_.y_m[from]}});
        }
    }
}

bool NetDynamics::turns_freely(const BarGroups& bars) const {
    // Turned by any angles, groups of bars that do not close miss their ends.
    std::vector<Vec2> turned(groups_);
    for (std::size_t g = 0; g < groups_; ++g) {
        constexpr double kGoldenShare = 0.6180339887498949;  // no two groups turn alike
        const double turns = kGoldenShare * static_cast<double>(g + 1);
        const double t = turns - std::floor(turns);
        turned[g] = {(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)};
    }
    turned.push_back({1.0, 0.0});
    std::vector<Vec2> at;
    for (std::size_t i = 0; i < system_.particle_count(); ++i) at.push_back({system_.x_m[i], system_.y_m[i]});
    for (const Arm& arm : arms_) at[arm.particle] = at[arm.parent] + times(arm.along_m, turned[arm.group]);
    count_work(system_.bars.size());
    for (std::size_t k = 0; k < system_.bars.size(); ++k) {
        const auto [a, b, reach, rest_m] = system_.bars[k];
        const Vec2 start{system_.x_m[b] - system_.x_m[a], system_.y_m[b] - system_.y_m[a]};
        const Vec2 wanted = times(start, turned[bars.of_bar[k]]);
        const Vec2 off = at[b] - at[a] - wanted;
        if (!(std::abs(off.x) + std::abs(off.y) <= kClosed * rest_m)) return false;
    }
    return true;
}

void NetDynamics::measure_inertia() {
    moment_kg_m_.assign(groups_ + 1, {});
    real_kg_m2_.assign((groups_ + 1) * groups_, 0.0);  // the last row is not used
    imaginary_kg_m2_ = real_kg_m2_;
    std::vector<Vec2> way(mass_kg_.size());
    std::vector<Vec2> beyond(mass_kg_.size());
    std::vector<double> beyond_kg = mass_kg_;
    for (std::size_t i = arms_.size(); i-- > 0;) {
        const Arm& arm = arms_[i];
        moment_kg_m_[arm.group] = moment_kg_m_[arm.group] + beyond_kg[arm.particle] * arm.along_m;
        beyond_kg[arm.parent] += beyond_kg[arm.particle];
    }
    free_kg_ = std::accumulate(mass_kg_.begin(), mass_kg_.end(), 0.0);
    for (std::size_t h = 0; h < groups_; ++h) {
        count_work(1 + mass_kg_.size());
        const Vec2 mean = is_free_ ? (1.0 / free_kg_) * moment_kg_m_[h] : Vec2{};
        if (is_free_) way[0] = {-mean.x, -mean.y};
        std::fill(beyond.begin(), beyond.end(), Vec2{});
        for (const Arm& arm : arms_) {
            way[arm.particle] = way[arm.parent] + (arm.group == h ? arm.along_m : Vec2{});
            beyond[arm.particle] = mass_kg_[arm.particle] * way[arm.particle];
        }
        for (std::size_t i = arms_.size(); i-- > 0;) {
            const Arm& arm = arms_[i];
            const Vec2 product = times({arm.along_m.x, -arm.along_m.y}, beyond[arm.particle]);
            real_kg_m2_[arm.group * groups_ + h] += product.x;
            imaginary_kg_m2_[arm.group * groups_ + h] += product.y;
            beyond[arm.parent] = beyond[arm.parent] + beyond[arm.particle];
        }
    }
    inertia_kg_m2_.assign(groups_ * groups_, 0.0);
    right_.assign(groups_ + 1, 0.0);
    square_1_s2_.assign(groups_, 0.0);
}

void NetDynamics::set_start(const System& system) {
    initial_state_.assign(3 * groups_ + (is_free_ ? 4 : 0), 0.0);
    std::fill_n(initial_state_.begin(), groups_, 1.0);
    std::vector<Vec2> momentum;
    Vec2 all_kg_m_s;
    double fastest_m_s = 0.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        momentum.push_back(mass_kg_[i] * Vec2{system.vx_m_s[i], system.vy_m_s[i]});
        all_kg_m_s = all_kg_m_s + momentum.back();
        center_m_ = center_m_ + (mass_kg_[i] / free_kg_) * Vec2{system.x_m[i], system.y_m[i]};
        if (mass_kg_[i] > 0.0)
            fastest_m_s = std::max(fastest_m_s, length(system.vx_m_s[i], system.vy_m_s[i]));
    }
    std::vector<double> size_m(groups_ + 1, 0.0);
    for (std::size_t i = arms_.size(); i-- > 0;) {
        const Arm& arm = arms_[i];
        right_[arm.group] += dot(left_of(arm.along_m), momentum[arm.particle]);
        momentum[arm.parent] = momentum[arm.parent] + momentum[arm.particle];
        size_m[arm.group] = std::max(size_m[arm.group], length(arm.along_m.x, arm.along_m.y));
    }
    double* const y = initial_state_.data();
    if (is_free_) {
        const Vec2 velocity = (1.0 / free_kg_) * all_kg_m_s;
        for (std::size_t g = 0; g < groups_; ++g) right_[g] -= dot(left_of(moment_kg_m_[g]), velocity);
        y[3 * groups_ + 2] = velocity.x;
        y[3 * groups_ + 3] = velocity.y;
    }
    const std::vector<double> momenta = right_;
    measure_torques(y);
    right_ = momenta;
    solve();
    std::copy_n(right_.begin(), groups_, y + 2 * groups_);
    const double length_m = std::accumulate(size_m.begin(), size_m.end(), 0.0);
    if (groups_ > 0) inverse_timescale_1_s_ = forces_.inverse_timescale_1_s(length_m, fastest_m_s);
    if (inverse_timescale_1_s_ == 0.0) inverse_timescale_1_s_ = 1.0;
}

std::vector<ErrorScale> NetDynamics::error_scales() const {
    std::vector<ErrorScale> scales{{0, 2 * groups_, 1.0, 0.0},
                                   {2 * groups_, groups_, inverse_timescale_1_s_, 1.0}};
    if (is_free_) {
        const double length_m = largest_length_m(system_);
        scales.push_back({3 * groups_, 2, length_m, 0.0});
        scales.push_back({3 * groups_ + 2, 2, length_m * inverse_timescale_1_s_, 1.0});
    }
    return scales;
}

CORDA_AVX2_CLONES void NetDynamics::measure_torques(const double* y) {
    const double* const c = y;
    const double* const s = y + groups_;
    const double* const w = y + 2 * groups_;
    double* __restrict const square = square_1_s2_.data();
    double* __restrict const right = right_.data();
    for (std::size_t g = 0; g < groups_; ++g) square[g] = w[g] * w[g];
    for (std::size_t g = 0; g < groups_; ++g) {
        const double* const real = real_kg_m2_.data() + g * groups_;
        const double* const imaginary = imaginary_kg_m2_.data() + g * groups_;
        double* __restrict const inertia = inertia_kg_m2_.data() + g * groups_;
        // conj(z_g) A_gh z_h with z = c + i s: its real part is the inertia, its imaginary part the lever of
        // h's centrifugal forces on g, and the opposite of that of g's on h.
        double torque = 0.0;
        for (std::size_t h = g; h < groups_; ++h) {
            const double x = c[g] * c[h] + s[g] * s[h];
            const double z = c[g] * s[h] - s[g] * c[h];
            inertia[h] = real[h] * x - imaginary[h] * z;
            const double lever = real[h] * z + imaginary[h] * x;
            right[h] -= square[g] * lever;
            torque += square[h] * lever;
        }
        right[g] += torque;
    }
}

CORDA_AVX2_CLONES void NetDynamics::eliminate(std::size_t first, std::size_t end) {
    const std::size_t n = groups_;
    const auto row = [this, n](std::size_t k) { return inertia_kg_m2_.data() + k * n; };
    double* const right = right_.data();
    for (std::size_t k = first; k < end; ++k) {
        const double* const from = row(k);
        for (std::size_t i = k + 1; i < n; ++i) {
            const double factor = from[i] / from[k];
            right[i] -= factor * right[k];
            if (i >= end) continue;
            double* __restrict const to = row(i);
            for (std::size_t j = i; j < n; ++j) to[j] -= factor * from[j];
        }
    }
    if (end - first < kRowsAtATime) return;
    const double* const a = row(first);
    const double* const b = row(first + 1);
    const double* const c = row(first + 2);
    const double* const d = row(first + 3);
    for (std::size_t i = end; i < n; ++i) {
        const double fa = a[i] / a[first];
        const double fb = b[i] / b[first + 1];
        const double fc = c[i] / c[first + 2];
        const double fd = d[i] / d[first + 3];
        double* __restrict const to = row(i);
        for (std::size_t j = i; j < n; ++j)
            to[j] = (((to[j] - fa * a[j]) - fb * b[j]) - fc * c[j]) - fd * d[j];
    }
}

void NetDynamics::solve() {
    constexpr std::size_t kProductsPerUpdate = 100;
    const std::size_t n = groups_;
    for (std::size_t first = 0; first < n; first += kRowsAtATime) {
        count_work((n - first) * (n - first) / kProductsPerUpdate);
        eliminate(first, std::min(first + kRowsAtATime, n));
    }
    for (std::size_t k = n; k-- > 0;) {
        const double* const from = inertia_kg_m2_.data() + k * n;
        double rest = right_[k];
        for (std::size_t j = k + 1; j < n; ++j) rest -= from[j] * right_[j];
        right_[k] = rest / from[k];
    }
}

void NetDynamics::derivative(const double* y, double* slope) {
    const double* const c = y;
    const double* const s = y + groups_;
    const double* const w = y + 2 * groups_;
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    const double drag_1_s = forces_.drag_1_s();
    for (std::size_t g = 0; g < groups_; ++g) {
        slope[g] = -(w[g] * s[g]);
        slope[groups_ + g] = w[g] * c[g];
        right_[g] = is_free_ ? 0.0 : dot(left_of(times(moment_kg_m_[g], {c[g], s[g]})), uniform_m_s2);
    }
    measure_torques(y);
    solve();
    for (std::size_t g = 0; g < groups_; ++g) slope[2 * groups_ + g] = right_[g] - drag_1_s * w[g];
    if (!is_free_) return;
    const double* const center = y + 3 * groups_;
    double* const slope_center = slope + 3 * groups_;
    slope_center[0] = center[2];
    slope_center[1] = center[3];
    slope_center[2] = uniform_m_s2.x - drag_1_s * center[2];
    slope_center[3] = uniform_m_s2.y - drag_1_s * center[3];
}

void NetDynamics::project(double* y) {
    for (std::size_t g = 0; g < groups_; ++g) {
        const double inverse = 1.0 / std::sqrt(y[g] * y[g] + y[groups_ + g] * y[groups_ + g]);
        y[g] *= inverse;
        y[groups_ + g] *= inverse;
    }
}

Vec2 NetDynamics::root_m(const double* y) const {
    Vec2 mean;
    for (std::size_t g = 0; g < groups_; ++g) mean = mean + times(moment_kg_m_[g], turn(y, g));
    return center_m_ + Vec2{y[3 * groups_], y[3 * groups_ + 1]} - (1.0 / free_kg_) * mean;
}

void NetDynamics::positions(const double* y, State& state) const {
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (mass_kg_[i] > 0.0) continue;
        state.x_m[i] = system_.x_m[i];
        state.y_m[i] = system_.y_m[i];
    }
    if (is_free_) {
        const Vec2 root = root_m(y);
        state.x_m[0] = root.x;
        state.y_m[0] = root.y;
    }
    for (const Arm& arm : arms_) {
        const Vec2 along = times(arm.along_m, turn(y, arm.group));
        state.x_m[arm.particle] = state.x_m[arm.parent] + along.x;
        state.y_m[arm.particle] = state.y_m[arm.parent] + along.y;
    }
}

void NetDynamics::velocities(const double* y, std::vector<double>& vx_m_s,
                             std::vector<double>& vy_m_s) const {
    std::vector<Vec2> spin;
    Vec2 root;
    for (std::size_t g = 0; g < groups_; ++g) {
        spin.push_back(y[2 * groups_ + g] * left_of(turn(y, g)));
        root = root - times(moment_kg_m_[g], spin[g]);
    }
    spin.push_back({});
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (mass_kg_[i] == 0.0) vx_m_s[i] = vy_m_s[i] = 0.0;
    }
    if (is_free_) {
        vx_m_s[0] = y[3 * groups_ + 2] + root.x / free_kg_;
        vy_m_s[0] = y[3 * groups_ + 3] + root.y / free_kg_;
    }
    for (const Arm& arm : arms_) {
        const Vec2 turns = times(arm.along_m, spin[arm.group]);
        vx_m_s[arm.particle] = vx_m_s[arm.parent] + turns.x;
        vy_m_s[arm.particle] = vy_m_s[arm.parent] + turns.y;
    }
}

double NetDynamics::energy_j(const double* y) const {
    positions(y, state_);
    state_.vx_m_s.resize(mass_kg_.size());
    state_.vy_m_s.resize(mass_kg_.size());
    velocities(y, state_.vx_m_s, state_.vy_m_s);
    double energy_j = 0.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        const Vec2 velocity{state_.vx_m_s[i], state_.vy_m_s[i]};
        energy_j += mass_kg_[i] *
                    (0.5 * dot(velocity, velocity) + forces_.potential_j_kg({state_.x_m[i], state_.y_m[i]}));
    }
    return energy_j;
}

void NetDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    std::fill(tension_n.begin(), tension_n.end(), std::numeric_limits<double>::quiet_NaN());
    if (!has_tensions_) return;
    try {
        if (!constraints_) constraints_ = make_constraint_solver(system_);
    } catch (const Refusal&) {  // a triangle in line
        has_tensions_ = false;
        return;
    }
    if (!constraints_->determines_tensions()) return;
    Motion motion = Motion::start_of(system_);
    positions(y, state_);
    motion.x_m = state_.x_m;
    motion.y_m = state_.y_m;
    velocities(y, motion.vx_m_s, motion.vy_m_s);
    std::vector<double> load = loads(constraints_->bars(), motion, forces_.uniform_m_s2());
    if (!constraints_->solve(motion, load) || !constraints_->had_full_rank()) return;
    std::size_t link = 0;
    for (std::size_t k = 0; k < system_.bars.size(); ++k) {
        const auto [a, b, reach, rest_m] = system_.bars[k];
        const bool moves = system_.inverse_mass_1_kg[a] > 0.0 || system_.inverse_mass_1_kg[b] > 0.0;
        tension_n[k] =
            moves ? load[link++] * length(state_.x_m[b] - state_.x_m[a], state_.y_m[b] - state_.y_m[a]) : 0.0;
    }
}

}  // namespace corda::sim
