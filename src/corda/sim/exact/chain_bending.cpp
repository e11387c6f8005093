#include "corda/sim/exact/chain_bending.hpp"

#include <algorithm>

#include "corda/sim/defs.hpp"

namespace corda::sim {
namespace {

/// 1 - a . b of unit vectors, without cancellation if they are nearly equal.
double one_minus_cosine(Vec2 a, Vec2 b) {
    const Vec2 apart = a - b;
    return 0.5 * dot(apart, apart);
}

}  // namespace

ChainBending::ChainBending(const System& system, const std::vector<ChainLink>& links,
                           const std::vector<double>& length_m) {
    for (const Bend& bend : system.bends) {
        const bool is_in_a_chain = bend.b == bend.a + 1 && bend.c == bend.b + 1;
        if (!is_in_a_chain || !(links[bend.a].moves || links[bend.b].moves)) continue;
        if (empty()) {
            for (const double length : length_m) inverse_length_1_m_.push_back(1.0 / length);
            for (std::vector<double>* array : {&stiffness_n_m_, &rigidity_n_m2_, &couple_n_}) {
                array->assign(length_m.size(), 0.0);
            }
        }
        add_bend(system, bend, links[bend.a], links[bend.b], length_m);
    }
}

void ChainBending::add_bend(const System& system, const Bend& bend, const ChainLink& before,
                            const ChainLink& after, const std::vector<double>& length_m) {
    const auto add_clamp = [&](const ChainLink& link, std::uint32_t near, std::uint32_t far) {
        const Vec2 along{system.x_m[far] - system.x_m[near], system.y_m[far] - system.y_m[near]};
        const double distance_m = length(along.x, along.y);
        clamps_.push_back({link.index, (1.0 / distance_m) * along,
                           link.runs_backwards ? -bend.stiffness_n_m : bend.stiffness_n_m});
        return distance_m;
    };
    if (before.moves && after.moves) {
        const bool is_joint = system.is_pinned(bend.b);
        const bool is_turned = before.runs_backwards != after.runs_backwards;
        if (is_joint) {
            joints_.push_back(
                {before.index, after.index, is_turned ? -bend.stiffness_n_m : bend.stiffness_n_m});
        } else {
            stiffness_n_m_[std::min(before.index, after.index)] = bend.stiffness_n_m;
        }
    }
    const double before_m = before.moves ? length_m[before.index] : add_clamp(after, bend.a, bend.b);
    const double after_m = after.moves ? length_m[after.index] : add_clamp(before, bend.b, bend.c);
    const double rigidity_n_m2 = bend.stiffness_n_m * 0.5 * (before_m + after_m);
    for (const ChainLink* link : {&before, &after}) {
        if (!link->moves) continue;
        rigidity_n_m2_[link->index] = std::max(rigidity_n_m2_[link->index], rigidity_n_m2);
    }
}

void ChainBending::find_couples(const double* y) {
    const std::size_t links = couple_n_.size();
    const double* const c = y;
    const double* const s = y + links;
    double before_n_m = 0.0;
    for (std::size_t i = 0; i + 1 < links; ++i) {
        const double after_n_m = stiffness_n_m_[i] * (c[i] * s[i + 1] - s[i] * c[i + 1]);
        couple_n_[i] = (after_n_m - before_n_m) * inverse_length_1_m_[i];
        before_n_m = after_n_m;
    }
    couple_n_[links - 1] = -before_n_m * inverse_length_1_m_[links - 1];
    const auto direction = [&](std::size_t link) { return Vec2{c[link], s[link]}; };
    for (const Joint& joint : joints_) {
        const double torque_n_m = joint.stiffness_n_m * dot(left_of(direction(joint.a)), direction(joint.b));
        couple_n_[joint.a] += torque_n_m * inverse_length_1_m_[joint.a];
        couple_n_[joint.b] -= torque_n_m * inverse_length_1_m_[joint.b];
    }
    for (const Clamp& clamp : clamps_) {
        const double torque_n_m = clamp.stiffness_n_m * dot(left_of(clamp.along), direction(clamp.link));
        couple_n_[clamp.link] -= torque_n_m * inverse_length_1_m_[clamp.link];
    }
}

double ChainBending::energy_j(const double* y) const {
    const std::size_t links = couple_n_.size();
    const auto direction = [&](std::size_t link) { return Vec2{y[link], y[links + link]}; };
    // A negative k o means that one of the two links points the other way.
    const auto energy_of = [](double signed_stiffness_n_m, Vec2 a, Vec2 b) {
        return signed_stiffness_n_m < 0.0 ? -signed_stiffness_n_m * one_minus_cosine(a, -1.0 * b)
                                          : signed_stiffness_n_m * one_minus_cosine(a, b);
    };
    double energy_j = 0.0;
    for (std::size_t i = 0; i + 1 < links; ++i) {
        energy_j += energy_of(stiffness_n_m_[i], direction(i), direction(i + 1));
    }
    for (const Joint& joint : joints_) {
        energy_j += energy_of(joint.stiffness_n_m, direction(joint.a), direction(joint.b));
    }
    for (const Clamp& clamp : clamps_) {
        energy_j += energy_of(clamp.stiffness_n_m, clamp.along, direction(clamp.link));
    }
    return energy_j;
}

}  // namespace corda::sim
