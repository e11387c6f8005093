#include "corda/sim/forces/elastic_forces.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/events.hpp"
#include "corda/sim/forces/forces.hpp"

namespace corda::sim {
namespace {

/// Lower limit of a bar's length, as a share of its rest length, in the bound on the frequency. Otherwise the
/// bound would grow without limit when the bar's ends pass each other, which no step resolves.
constexpr double kMinLengthShare = 0.01;

/// |cos| + |sin| of 0.2 radians, rounded up.
constexpr double kCommonBend = 1.2;

/// The current length of a bar, its inverse and the unit vector along the bar; all 0 for a bar of length 0.
struct Along {
    double length_m;
    double inverse_1_m;
    double x;
    double y;
};

Along along(const double* x_m, const double* y_m, std::uint32_t from, std::uint32_t to) {
    const double dx = x_m[to] - x_m[from];
    const double dy = y_m[to] - y_m[from];
    const double distance_m = length(dx, dy);
    const double inverse = distance_m > 0.0 ? 1.0 / distance_m : 0.0;
    return {distance_m, inverse, dx * inverse, dy * inverse};
}

/// Writes how far apart the ends of the springs of a strip are along an axis.
CORDA_INLINE void measure(const Strip& strip, const double* at_m, double* apart_m) {
    CORDA_INDEPENDENT
    for (std::size_t k = 0; k < strip.count; ++k) apart_m[k] = at_m[strip.b + k] - at_m[strip.a + k];
}

/// Adds forces on the first ends of the springs of a strip to both ends along an axis.
CORDA_INLINE void add(const Strip& strip, const double* pull_n, double* force_n) {
    CORDA_INDEPENDENT
    for (std::size_t k = 0; k < strip.count; ++k) force_n[strip.b + k] -= pull_n[k];
    CORDA_INDEPENDENT
    for (std::size_t k = 0; k < strip.count; ++k) force_n[strip.a + k] += pull_n[k];
}

/// Turns the distances between the ends of some springs, along both axes, into the forces on their first
/// ends. Returns how many are shorter than about half of their rest lengths.
CORDA_INLINE int pull(std::size_t count, const double* __restrict rest_m,
                      const double* __restrict stiffness_n_m, const double* __restrict least_stretch_m,
                      double* __restrict x, double* __restrict y) {
    constexpr double kAboutHalf = -0.499;  // -0.5 and more than rounding
    int short_ones = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double distance_m = length(x[k], y[k]);
        const double inverse_1_m = distance_m > 0.0 ? 1.0 / distance_m : 0.0;
        const double stretch_m = std::max(distance_m - rest_m[k], least_stretch_m[k]);
        const double tension_n = stiffness_n_m[k] * stretch_m;
        short_ones += stretch_m < kAboutHalf * rest_m[k] ? 1 : 0;
        x[k] = tension_n * (x[k] * inverse_1_m);
        y[k] = tension_n * (y[k] * inverse_1_m);
    }
    return short_ones;
}

/// Adds the forces of springs, and returns how many are shorter than about half of their rest lengths.
CORDA_AVX2_CLONES int add_spring_forces(const Springs& springs, Components<const double> at_m,
                                        Components<double> force_n) {
    // To set them to 0 would take longer than a spring.
    // NOLINTBEGIN(cppcoreguidelines-pro-type-member-init)
    std::array<double, Springs::kChunk> x;
    std::array<double, Springs::kChunk> y;
    // NOLINTEND(cppcoreguidelines-pro-type-member-init)
    int short_ones = 0;
    const Strip* strip = springs.strips.data();
    for (std::size_t first = 0; first < springs.bar.size(); first += Springs::kChunk) {
        const std::size_t count = std::min(Springs::kChunk, springs.bar.size() - first);
        const Strip* next = strip;
        for (std::size_t k = 0; k < count; k += next->count, ++next) {
            measure(*next, at_m.x, &x[k]);
            measure(*next, at_m.y, &y[k]);
        }
        short_ones += pull(count, &springs.rest_m[first], &springs.stiffness_n_m[first],
                           &springs.least_stretch_m[first], x.data(), y.data());
        for (std::size_t k = 0; k < count; k += strip->count, ++strip) {
            add(*strip, &x[k], force_n.x);
            add(*strip, &y[k], force_n.y);
        }
    }
    return short_ones;
}

/// With what joins pins that will be let go.
ElasticForces elastic_of_all_phases(const System& system) {
    if (system.release_s.empty()) return {system, 0, system.particle_count()};
    System free = from_event_on(system, std::numeric_limits<double>::max());
    free.start_s = system.start_s;
    return {free, 0, free.particle_count()};
}

}  // namespace

double Springs::stretch_m(std::size_t k, const double* x_m, const double* y_m) const {
    const double distance_m = length(x_m[b[k]] - x_m[a[k]], y_m[b[k]] - y_m[a[k]]);
    return std::max(distance_m - rest_m[k], least_stretch_m[k]);
}

void Springs::add(const Spring& spring) {
    const bool continues = bar.size() % kChunk != 0 && spring.a == strips.back().a + strips.back().count &&
                           spring.b == strips.back().b + strips.back().count;
    if (continues)
        ++strips.back().count;
    else
        strips.push_back({spring.a, spring.b, 1});
    bar.push_back(spring.bar);
    a.push_back(spring.a);
    b.push_back(spring.b);
    rest_m.push_back(spring.rest_m);
    stiffness_n_m.push_back(spring.stiffness_n_m);
    least_stretch_m.push_back(spring.least_stretch_m);
}

ElasticForces::ElasticForces(const System& system, std::size_t first_particle, std::size_t particle_count)
    : first_particle_(first_particle) {
    const std::size_t end = first_particle + particle_count;
    auto body = std::ranges::partition_point(
        system.bodies, [&](const Body& before) { return before.first_particle < first_particle; });
    for (; body != system.bodies.end() && body->first_particle < end; ++body) {
        if (body->material.compliance_1_n > 0.0) add_springs(system, *body);
    }
    add_joints(system, particle_count);
    bound_frequencies(system.inverse_mass_1_kg.data() + first_particle, particle_count);
}

void ElasticForces::add_springs(const System& system, const Body& body) {
    const double least_m = body.material.is_string ? 0.0 : -std::numeric_limits<double>::infinity();
    const auto ends = [&](std::size_t k) { return std::minmax(system.bars[k].a, system.bars[k].b); };
    std::vector<std::size_t> order(body.bar_count);
    std::iota(order.begin(), order.end(), body.first_bar);
    // The rows of a grid come first, then its columns: strips are long.
    std::ranges::stable_sort(order, {}, [&](std::size_t k) {
        const auto [a, b] = ends(k);
        return std::pair(b - a, a);
    });
    for (const std::size_t k : order) {
        const Bar& bar = system.bars[k];
        if (system.is_pinned(bar.a) && system.is_pinned(bar.b)) continue;
        if (!system.has_bar_at(k, system.start_s)) continue;
        assert(bar.rest_m > 0.0);
        const auto [a, b] = ends(k);
        springs_.add({k, static_cast<std::uint32_t>(a - first_particle_),
                      static_cast<std::uint32_t>(b - first_particle_), bar.rest_m,
                      1.0 / (body.material.compliance_1_n * bar.rest_m), least_m});
        if (!system.cut_s.empty()) spring_cut_s_.push_back(system.cut_s[k]);
    }
}

void ElasticForces::add_joints(const System& system, std::size_t particle_count) {
    const double* const x_m = system.x_m.data();
    const double* const y_m = system.y_m.data();
    // In the order of bodies, as bars are.
    auto next = std::ranges::partition_point(system.bends,
                                             [&](const Bend& before) { return before.b < first_particle_; });
    for (; next != system.bends.end() && next->b < first_particle_ + particle_count; ++next) {
        const Bend& bend = *next;
        if (system.is_pinned(bend.a) && system.is_pinned(bend.b) && system.is_pinned(bend.c)) continue;
        if (bend.cut_s <= system.start_s) continue;
        joints_.push_back({static_cast<std::uint32_t>(bend.a - first_particle_),
                           static_cast<std::uint32_t>(bend.b - first_particle_),
                           static_cast<std::uint32_t>(bend.c - first_particle_), bend.stiffness_n_m,
                           along(x_m, y_m, bend.a, bend.b).length_m,
                           along(x_m, y_m, bend.b, bend.c).length_m});
        if (!system.cut_s.empty()) joint_cut_s_.push_back(bend.cut_s);
    }
}

void ElasticForces::bound_frequencies(const double* inverse_mass_1_kg, std::size_t particle_count) {
    const auto moves = [&](std::uint32_t i) { return inverse_mass_1_kg[i] > 0.0 ? 1.0 : 0.0; };
    const auto largest = [&](const std::vector<double>& sum_n_m) {
        double square = 0.0;
        for (std::size_t i = 0; i < particle_count; ++i)
            square = std::max(square, inverse_mass_1_kg[i] * sum_n_m[i]);
        return square;
    };
    // Row i of the stiffness matrix: the entry of i itself, and those of the other free particles.
    std::vector<double> sum_n_m(particle_count, 0.0);
    for (std::size_t k = 0; k < springs_.bar.size(); ++k) {
        sum_n_m[springs_.a[k]] += springs_.stiffness_n_m[k] * (1.0 + moves(springs_.b[k]));
        sum_n_m[springs_.b[k]] += springs_.stiffness_n_m[k] * (1.0 + moves(springs_.a[k]));
    }
    spring_square_frequency_ = largest(sum_n_m);
    std::fill(sum_n_m.begin(), sum_n_m.end(), 0.0);
    for (const Joint& joint : joints_) {
        // The angle changes by at most these per metre that a, b or c moves.
        const double a_1_m = 1.0 / joint.before_m;
        const double c_1_m = 1.0 / joint.after_m;
        const double b_1_m = a_1_m + c_1_m;
        const double all_n =
            joint.stiffness_n_m * (moves(joint.a) * a_1_m + moves(joint.b) * b_1_m + moves(joint.c) * c_1_m);
        sum_n_m[joint.a] += a_1_m * all_n;
        sum_n_m[joint.b] += b_1_m * all_n;
        sum_n_m[joint.c] += c_1_m * all_n;
    }
    joint_square_frequency_ = largest(sum_n_m);
}

double ElasticForces::add_forces(Components<const double> at_m, Components<double> force_n) const {
    // |T| / d over 1 / (C l) is |1 - l / d|: more than 1 only if d < l / 2.
    double shortest = 0.5;  // d / l
    if (add_spring_forces(springs_, at_m, force_n) > 0) {
        for (std::size_t k = 0; k < springs_.bar.size(); ++k)
            shortest = std::min(shortest, 1.0 + springs_.stretch_m(k, at_m.x, at_m.y) / springs_.rest_m[k]);
    }
    const double push = 1.0 / std::max(shortest, kMinLengthShare) - 1.0;
    return push * spring_square_frequency_ + add_bend_forces(at_m, force_n);
}

double ElasticForces::add_bend_forces(Components<const double> at_m, Components<double> force_n) const {
    // The second derivatives of k (1 - cos) are k cos times the squares of the angle's first derivatives and
    // k sin times its second ones, which are no larger; both grow with the inverse square of the lengths.
    double sharpest = 0.0;
    for (const Joint& joint : joints_) {
        const Along u = along(at_m.x, at_m.y, joint.a, joint.b);
        const Along v = along(at_m.x, at_m.y, joint.b, joint.c);
        const double sine = u.x * v.y - u.y * v.x;
        const double cosine = u.x * v.x + u.y * v.y;
        const double shrink = std::min(
            std::max(joint.before_m * u.inverse_1_m, joint.after_m * v.inverse_1_m), 1.0 / kMinLengthShare);
        sharpest = std::max(sharpest, (std::abs(cosine) + std::abs(sine)) * (shrink * shrink));
        const double a_n = joint.stiffness_n_m * sine * u.inverse_1_m;
        const double c_n = joint.stiffness_n_m * sine * v.inverse_1_m;
        force_n.x[joint.a] += a_n * u.y;
        force_n.y[joint.a] -= a_n * u.x;
        force_n.x[joint.c] += c_n * v.y;
        force_n.y[joint.c] -= c_n * v.x;
        force_n.x[joint.b] -= a_n * u.y + c_n * v.y;
        force_n.y[joint.b] += a_n * u.x + c_n * v.x;
    }
    return sharpest * joint_square_frequency_;
}

double ElasticForces::common_square_frequency() const {
    return spring_square_frequency_ + kCommonBend * joint_square_frequency_;
}

double ElasticForces::energy_j(const double* x_m, const double* y_m, double time_s) const {
    double energy_j = 0.0;
    for (std::size_t k = 0; k < springs_.bar.size(); ++k) {
        if (!spring_cut_s_.empty() && spring_cut_s_[k] <= time_s) continue;
        const double stretch_m = springs_.stretch_m(k, x_m, y_m);
        energy_j += 0.5 * springs_.stiffness_n_m[k] * (stretch_m * stretch_m);
    }
    for (std::size_t k = 0; k < joints_.size(); ++k) {
        if (!joint_cut_s_.empty() && joint_cut_s_[k] <= time_s) continue;
        const Joint& joint = joints_[k];
        const Along u = along(x_m, y_m, joint.a, joint.b);
        const Along v = along(x_m, y_m, joint.b, joint.c);
        // 1 - u . v without cancellation.
        const double dx = v.x - u.x;
        const double dy = v.y - u.y;
        energy_j += 0.5 * joint.stiffness_n_m * (dx * dx + dy * dy);
    }
    return energy_j;
}

void ElasticForces::tensions(const double* x_m, const double* y_m, std::vector<double>& tension_n) const {
    for (std::size_t k = 0; k < springs_.bar.size(); ++k)
        tension_n[springs_.bar[k]] = springs_.stiffness_n_m[k] * springs_.stretch_m(k, x_m, y_m);
}

EnergyMeter::EnergyMeter(const System& system, const Forces& forces, std::span<const MethodDef> methods)
    : system_(&system), weight_n_(forces.on_particles(system)), elastic_(elastic_of_all_phases(system)) {
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        const auto* relaxation = std::get_if<RelaxationDef>(&methods[methods.size() == 1 ? 0 : b]);
        if (relaxation == nullptr || !relaxation->force_n) continue;
        const Body& body = system.bodies[b];
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
            weight_n_[i] = *relaxation->force_n;
    }
}

Energy EnergyMeter::of(const State& state) const {
    Energy energy;
    for (std::size_t i = 0; i < system_->particle_count(); ++i) {
        if (system_->stays_pinned(i)) continue;
        const double vx = state.vx_m_s[i];
        const double vy = state.vy_m_s[i];
        energy.kinetic_j += 0.5 * system_->mass_kg[i] * (vx * vx + vy * vy);
        energy.weight_j -= weight_n_[i].x * state.x_m[i] + weight_n_[i].y * state.y_m[i];
    }
    energy.elastic_j = elastic_.energy_j(state.x_m.data(), state.y_m.data(), state.time_s);
    return energy;
}

}  // namespace corda::sim
