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

void grow_tree(NetModel& net, const BarGroups& bars) {
    std::vector<std::vector<std::uint32_t>> bars_at(net.system.particle_count());
    for (std::uint32_t k = 0; k < net.system.bars.size(); ++k) {
        bars_at[net.system.bars[k].a].push_back(k);
        bars_at[net.system.bars[k].b].push_back(k);
    }
    std::vector<bool> is_reached(net.system.particle_count());
    std::vector<std::uint32_t> to_do;
    for (std::uint32_t i = 0; i < is_reached.size(); ++i) {
        is_reached[i] = net.mass_kg[i] == 0.0 || (net.is_free && i == 0);
        if (is_reached[i]) to_do.push_back(i);
    }
    for (std::size_t k = 0; k < to_do.size(); ++k) {
        const std::uint32_t from = to_do[k];
        count_work(1);
        for (const std::uint32_t bar : bars_at[from]) {
            const std::uint32_t to =
                net.system.bars[bar].a == from ? net.system.bars[bar].b : net.system.bars[bar].a;
            if (is_reached[to]) continue;
            is_reached[to] = true;
            to_do.push_back(to);
            net.arms.push_back(
                {from,
                 to,
                 bars.of_bar[bar],
                 {net.system.x_m[to] - net.system.x_m[from], net.system.y_m[to] - net.system.y_m[from]}});
        }
    }
}

/// True if the bars outside the tree keep their lengths however the groups turn.
bool turns_freely(const NetModel& net, const BarGroups& bars) {
    // Turned by any angles, groups of bars that do not close miss their ends.
    std::vector<Vec2> turned(net.groups);
    for (std::size_t g = 0; g < net.groups; ++g) {
        constexpr double kGoldenShare = 0.6180339887498949;  // no two groups turn alike
        const double turns = kGoldenShare * static_cast<double>(g + 1);
        const double t = turns - std::floor(turns);
        turned[g] = {(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)};
    }
    turned.push_back({1.0, 0.0});
    std::vector<Vec2> at;
    for (std::size_t i = 0; i < net.system.particle_count(); ++i)
        at.push_back({net.system.x_m[i], net.system.y_m[i]});
    for (const NetModel::Arm& arm : net.arms)
        at[arm.particle] = at[arm.parent] + times(arm.along_m, turned[arm.group]);
    count_work(net.system.bars.size());
    for (std::size_t k = 0; k < net.system.bars.size(); ++k) {
        const auto [a, b, reach, rest_m] = net.system.bars[k];
        const Vec2 start{net.system.x_m[b] - net.system.x_m[a], net.system.y_m[b] - net.system.y_m[a]};
        const Vec2 wanted = times(start, turned[bars.of_bar[k]]);
        const Vec2 off = at[b] - at[a] - wanted;
        if (!(std::abs(off.x) + std::abs(off.y) <= kClosed * rest_m)) return false;
    }
    return true;
}

void measure_inertia(NetModel& net) {
    net.moment_kg_m.assign(net.groups + 1, {});
    net.real_kg_m2.assign((net.groups + 1) * net.groups, 0.0);  // the last row is not used
    net.imaginary_kg_m2 = net.real_kg_m2;
    std::vector<Vec2> way(net.mass_kg.size());
    std::vector<Vec2> beyond(net.mass_kg.size());
    std::vector<double> beyond_kg = net.mass_kg;
    for (std::size_t i = net.arms.size(); i-- > 0;) {
        const NetModel::Arm& arm = net.arms[i];
        net.moment_kg_m[arm.group] = net.moment_kg_m[arm.group] + beyond_kg[arm.particle] * arm.along_m;
        beyond_kg[arm.parent] += beyond_kg[arm.particle];
    }
    net.free_kg = std::accumulate(net.mass_kg.begin(), net.mass_kg.end(), 0.0);
    for (std::size_t h = 0; h < net.groups; ++h) {
        count_work(1 + net.mass_kg.size());
        const Vec2 mean = net.is_free ? (1.0 / net.free_kg) * net.moment_kg_m[h] : Vec2{};
        if (net.is_free) way[0] = {-mean.x, -mean.y};
        std::fill(beyond.begin(), beyond.end(), Vec2{});
        for (const NetModel::Arm& arm : net.arms) {
            way[arm.particle] = way[arm.parent] + (arm.group == h ? arm.along_m : Vec2{});
            beyond[arm.particle] = net.mass_kg[arm.particle] * way[arm.particle];
        }
        for (std::size_t i = net.arms.size(); i-- > 0;) {
            const NetModel::Arm& arm = net.arms[i];
            const Vec2 product = times({arm.along_m.x, -arm.along_m.y}, beyond[arm.particle]);
            net.real_kg_m2[arm.group * net.groups + h] += product.x;
            net.imaginary_kg_m2[arm.group * net.groups + h] += product.y;
            beyond[arm.parent] = beyond[arm.parent] + beyond[arm.particle];
        }
    }
}

/// Writes the inertia of a state, and adds to the right-hand sides the torques of centrifugal forces.
CORDA_AVX2_CLONES void measure_torques(const NetModel& net, const double* y, NetEquations& equations) {
    const std::size_t groups = net.groups;
    const double* const c = y;
    const double* const s = y + groups;
    const double* const w = y + 2 * groups;
    double* __restrict const square = equations.square_1_s2.data();
    double* __restrict const right = equations.right.data();
    for (std::size_t g = 0; g < groups; ++g) square[g] = w[g] * w[g];
    for (std::size_t g = 0; g < groups; ++g) {
        const double* const real = net.real_kg_m2.data() + g * groups;
        const double* const imaginary = net.imaginary_kg_m2.data() + g * groups;
        double* __restrict const inertia = equations.inertia_kg_m2.data() + g * groups;
        // conj(z_g) A_gh z_h with z = c + i s: its real part is the inertia, its imaginary part the lever of
        // h's centrifugal forces on g, and the opposite of that of g's on h.
        double torque = 0.0;
        for (std::size_t h = g; h < groups; ++h) {
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

/// A step of solve(): eliminates the rows first .. end from those below.
CORDA_AVX2_CLONES void eliminate(NetEquations& equations, std::size_t first, std::size_t end) {
    const std::size_t n = equations.square_1_s2.size();
    double* const inertia = equations.inertia_kg_m2.data();
    const auto row = [inertia, n](std::size_t k) { return inertia + k * n; };
    double* const right = equations.right.data();
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

/// Replaces torques by the angular accelerations that they cause, or angular momenta by the angular
/// velocities that have them. The inertia is overwritten.
void solve(NetEquations& equations) {
    constexpr std::size_t kProductsPerUpdate = 100;
    const std::size_t n = equations.square_1_s2.size();
    for (std::size_t first = 0; first < n; first += kRowsAtATime) {
        count_work((n - first) * (n - first) / kProductsPerUpdate);
        eliminate(equations, first, std::min(first + kRowsAtATime, n));
    }
    for (std::size_t k = n; k-- > 0;) {
        const double* const from = equations.inertia_kg_m2.data() + k * n;
        double rest = equations.right[k];
        for (std::size_t j = k + 1; j < n; ++j) rest -= from[j] * equations.right[j];
        equations.right[k] = rest / from[k];
    }
}

void set_start(NetModel& net) {
    const System& system = net.system;
    NetEquations equations(net.groups);
    net.start.assign(3 * net.groups + (net.is_free ? 4 : 0), 0.0);
    std::fill_n(net.start.begin(), net.groups, 1.0);
    measure_torques(net, net.start.data(), equations);  // none: nothing turns yet
    std::vector<Vec2> momentum;
    Vec2 all_kg_m_s;
    double fastest_m_s = 0.0;
    for (std::size_t i = 0; i < net.mass_kg.size(); ++i) {
        momentum.push_back(net.mass_kg[i] * Vec2{system.vx_m_s[i], system.vy_m_s[i]});
        all_kg_m_s = all_kg_m_s + momentum.back();
        net.center_m = net.center_m + (net.mass_kg[i] / net.free_kg) * Vec2{system.x_m[i], system.y_m[i]};
        if (net.mass_kg[i] > 0.0)
            fastest_m_s = std::max(fastest_m_s, length(system.vx_m_s[i], system.vy_m_s[i]));
    }
    std::vector<double> size_m(net.groups + 1, 0.0);
    for (std::size_t i = net.arms.size(); i-- > 0;) {
        const NetModel::Arm& arm = net.arms[i];
        equations.right[arm.group] += dot(left_of(arm.along_m), momentum[arm.particle]);
        momentum[arm.parent] = momentum[arm.parent] + momentum[arm.particle];
        size_m[arm.group] = std::max(size_m[arm.group], length(arm.along_m.x, arm.along_m.y));
    }
    double* const y = net.start.data();
    if (net.is_free) {
        const Vec2 velocity = (1.0 / net.free_kg) * all_kg_m_s;
        for (std::size_t g = 0; g < net.groups; ++g)
            equations.right[g] -= dot(left_of(net.moment_kg_m[g]), velocity);
        y[3 * net.groups + 2] = velocity.x;
        y[3 * net.groups + 3] = velocity.y;
    }
    solve(equations);
    std::copy_n(equations.right.begin(), net.groups, y + 2 * net.groups);
    const double length_m = std::accumulate(size_m.begin(), size_m.end(), 0.0);
    if (net.groups > 0) net.inverse_timescale_1_s = net.forces.inverse_timescale_1_s(length_m, fastest_m_s);
    if (net.inverse_timescale_1_s == 0.0) net.inverse_timescale_1_s = 1.0;
}

NetModel make_net(const System& system, const Forces& forces) {
    assert(system.bodies.size() == 1);
    if (!system.bends.empty()) refuse();
    NetModel net{.system = system, .forces = forces, .mass_kg = system.mass_kg};
    const std::vector<double> held = inverse_masses_with_taut_rows_held(system);
    const BarGroups bars(system, held);
    net.groups = bars.count;
    std::size_t held_count = 0;
    for (std::size_t i = 0; i < net.mass_kg.size(); ++i) {
        if (!bars.is_held[i]) continue;
        net.mass_kg[i] = 0.0;
        ++held_count;
    }
    net.is_free = held_count == 0;
    const auto size = static_cast<double>(net.groups);
    if (size * size * size > kMaxCube * static_cast<double>(net.mass_kg.size())) refuse();
    grow_tree(net, bars);
    if (net.arms.size() + std::max<std::size_t>(held_count, 1) != net.mass_kg.size() ||
        !turns_freely(net, bars))
        refuse();
    // As many bars as the groups leave freedoms to lose.
    const auto moves = [&system](const Bar& bar) {
        return !system.is_pinned(bar.a) || !system.is_pinned(bar.b);
    };
    const auto moving = static_cast<std::size_t>(std::ranges::count_if(system.bars, moves));
    const auto free = net.mass_kg.size() - static_cast<std::size_t>(std::ranges::count(held, 0.0));
    net.has_tensions =
        held == system.inverse_mass_1_kg && moving + net.groups + (net.is_free ? 2 : 0) == 2 * free;
    measure_inertia(net);
    set_start(net);
    return net;
}

/// How a group has turned.
Vec2 turn_of(const NetModel& net, const double* y, std::size_t group) {
    return group < net.groups ? Vec2{y[group], y[net.groups + group]} : Vec2{1.0, 0.0};
}

}  // namespace

NetDynamics::NetDynamics(const System& system, const Forces& forces)
    : net_(make_net(system, forces)),
      equations_(net_.groups),
      state_{0.0, system.x_m, system.y_m, system.vx_m_s, system.vy_m_s} {}

NetDynamics::~NetDynamics() = default;

std::vector<ErrorScale> NetDynamics::error_scales() const {
    std::vector<ErrorScale> scales{{0, 2 * net_.groups, 1.0, 0.0},
                                   {2 * net_.groups, net_.groups, net_.inverse_timescale_1_s, 1.0}};
    if (net_.is_free) {
        const double length_m = largest_length_m(net_.system);
        scales.push_back({3 * net_.groups, 2, length_m, 0.0});
        scales.push_back({3 * net_.groups + 2, 2, length_m * net_.inverse_timescale_1_s, 1.0});
    }
    return scales;
}

void NetDynamics::derivative(const double* y, double* slope) {
    const double* const c = y;
    const double* const s = y + net_.groups;
    const double* const w = y + 2 * net_.groups;
    const Vec2 uniform_m_s2 = net_.forces.uniform_m_s2();
    const double drag_1_s = net_.forces.drag_1_s();
    for (std::size_t g = 0; g < net_.groups; ++g) {
        slope[g] = -(w[g] * s[g]);
        slope[net_.groups + g] = w[g] * c[g];
        equations_.right[g] =
            net_.is_free ? 0.0 : dot(left_of(times(net_.moment_kg_m[g], {c[g], s[g]})), uniform_m_s2);
    }
    measure_torques(net_, y, equations_);
    solve(equations_);
    for (std::size_t g = 0; g < net_.groups; ++g)
        slope[2 * net_.groups + g] = equations_.right[g] - drag_1_s * w[g];
    if (!net_.is_free) return;
    const double* const center = y + 3 * net_.groups;
    double* const slope_center = slope + 3 * net_.groups;
    slope_center[0] = center[2];
    slope_center[1] = center[3];
    slope_center[2] = uniform_m_s2.x - drag_1_s * center[2];
    slope_center[3] = uniform_m_s2.y - drag_1_s * center[3];
}

void NetDynamics::project(double* y) {
    make_unit_vectors(net_.groups, y);
}

void NetDynamics::positions(const double* y, State& state) const {
    for (std::size_t i = 0; i < net_.mass_kg.size(); ++i) {
        if (net_.mass_kg[i] > 0.0) continue;
        state.x_m[i] = net_.system.x_m[i];
        state.y_m[i] = net_.system.y_m[i];
    }
    if (net_.is_free) {
        Vec2 mean;
        for (std::size_t g = 0; g < net_.groups; ++g)
            mean = mean + times(net_.moment_kg_m[g], turn_of(net_, y, g));
        const double* const center = y + 3 * net_.groups;
        const Vec2 root = net_.center_m + Vec2{center[0], center[1]} - (1.0 / net_.free_kg) * mean;
        state.x_m[0] = root.x;
        state.y_m[0] = root.y;
    }
    for (const NetModel::Arm& arm : net_.arms) {
        const Vec2 along = times(arm.along_m, turn_of(net_, y, arm.group));
        state.x_m[arm.particle] = state.x_m[arm.parent] + along.x;
        state.y_m[arm.particle] = state.y_m[arm.parent] + along.y;
    }
}

void NetDynamics::velocities(const double* y, State& state) const {
    std::vector<Vec2> spin;
    Vec2 root;
    for (std::size_t g = 0; g < net_.groups; ++g) {
        spin.push_back(y[2 * net_.groups + g] * left_of(turn_of(net_, y, g)));
        root = root - times(net_.moment_kg_m[g], spin[g]);
    }
    spin.push_back({});
    for (std::size_t i = 0; i < net_.mass_kg.size(); ++i) {
        if (net_.mass_kg[i] == 0.0) state.vx_m_s[i] = state.vy_m_s[i] = 0.0;
    }
    if (net_.is_free) {
        state.vx_m_s[0] = y[3 * net_.groups + 2] + root.x / net_.free_kg;
        state.vy_m_s[0] = y[3 * net_.groups + 3] + root.y / net_.free_kg;
    }
    for (const NetModel::Arm& arm : net_.arms) {
        const Vec2 turns = times(arm.along_m, spin[arm.group]);
        state.vx_m_s[arm.particle] = state.vx_m_s[arm.parent] + turns.x;
        state.vy_m_s[arm.particle] = state.vy_m_s[arm.parent] + turns.y;
    }
}

double NetDynamics::energy_j(const double* y) const {
    positions(y, state_);
    velocities(y, state_);
    double energy_j = 0.0;
    for (std::size_t i = 0; i < net_.mass_kg.size(); ++i) {
        const Vec2 velocity{state_.vx_m_s[i], state_.vy_m_s[i]};
        energy_j += net_.mass_kg[i] * (0.5 * dot(velocity, velocity) +
                                       net_.forces.potential_j_kg({state_.x_m[i], state_.y_m[i]}));
    }
    return energy_j;
}

void NetDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    std::fill(tension_n.begin(), tension_n.end(), std::numeric_limits<double>::quiet_NaN());
    if (!net_.has_tensions) return;
    try {
        if (!constraints_) constraints_ = make_constraint_solver(net_.system);
    } catch (const Refusal&) {  // a triangle in line
        net_.has_tensions = false;
        return;
    }
    if (!constraints_->determines_tensions()) return;
    Motion motion = Motion::start_of(net_.system);
    positions(y, state_);
    motion.x_m = state_.x_m;
    motion.y_m = state_.y_m;
    velocities(y, state_);
    motion.vx_m_s = state_.vx_m_s;
    motion.vy_m_s = state_.vy_m_s;
    std::vector<double> load = loads(constraints_->bars(), motion, net_.forces.uniform_m_s2());
    if (!constraints_->solve(motion, load) || !constraints_->had_full_rank()) return;
    std::size_t link = 0;
    for (std::size_t k = 0; k < net_.system.bars.size(); ++k) {
        const auto [a, b, reach, rest_m] = net_.system.bars[k];
        const bool moves = net_.system.inverse_mass_1_kg[a] > 0.0 || net_.system.inverse_mass_1_kg[b] > 0.0;
        tension_n[k] =
            moves ? load[link++] * length(state_.x_m[b] - state_.x_m[a], state_.y_m[b] - state_.y_m[a]) : 0.0;
    }
}

}  // namespace corda::sim
