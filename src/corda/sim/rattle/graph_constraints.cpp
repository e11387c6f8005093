#include "corda/sim/rattle/graph_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// Corrections end when the error of every squared length is below this share of it, a few roundings. Much
/// less is never reached; more would show as strain.
constexpr double kExcessTolerance = 4e-15;
/// Five to ten corrections are normal. If forty do not suffice, the bars turn too far for the matrix.
constexpr int kMaxCorrections = 40;
/// Bars whose smallest pivot is below this share of its initial value are within about a hundredth of a
/// radian of a line in which they depend on each other.
constexpr double kNearLine = 1e-3;
/// From there, the full Newton method converges in five steps or not at all.
constexpr int kMaxCrossingSteps = 10;
/// At the line two motions branch, and the true one keeps its velocities. In a stage, relative velocities of
/// bars may change by this share of the fastest, and each Newton correction must shrink by kShrink, as it
/// does from a start that is ten times nearer to one branch than to the other.
constexpr double kCrossingChange = 0.05;
constexpr double kShrink = 0.1;
constexpr double kRoundedChange = 1e-11;
/// Largest relative error of an implied bar's squared length: rounding, magnified by the other bars.
constexpr double kImpliedTolerance = 1e-9;
/// Where bars depend on each other, all diagonal entries are raised by this share, so that undetermined
/// directions do not change.
constexpr double kLeapRaise = 1e-10;
/// Bars depend on each other if a pivot is below this share of its diagonal entry. Dependent bars leave 1e-16
/// to 1e-14; a net that is only just determined, sagging by a part in 1e5, leaves 1e-10.
constexpr double kDependentPivot = 1e-12;
/// Implied bars are found with all diagonal entries raised by this share, so that the elimination can
/// continue past one. A pivot is then this share times 1 + c^2, c being the coefficients by which the others
/// imply the bar: 2e-14 to 2e-11 in a grid of 200 x 200 with both diagonals, while independent bars leave
/// 3e-9.
constexpr double kRaise = 1e-14;
constexpr double kImpliedPivot = 1e-11;
/// Largest rate at which an implied bar may change its length, as a share of the largest squared speed at
/// which a bar turns. Bars that do not stay implied have a share near 1.
constexpr double kBendTolerance = 1e-5;

using ImpulseVector = Eigen::Map<Eigen::VectorXd>;

/// Finds the entries of the matrix of the bars and analyses its pattern.
void analyse(BarGraph& graph) {
    const std::vector<Link>& links = graph.bars.links;
    std::vector<std::vector<std::uint32_t>> links_at(graph.bars.inverse_mass_1_kg.size());
    std::vector<Eigen::Triplet<double>> triplets;
    for (std::uint32_t k = 0; k < links.size(); ++k) {
        links_at[links[k].a].push_back(k);
        links_at[links[k].b].push_back(k);
    }
    for (std::uint32_t i = 0; i < links_at.size(); ++i) {
        const double weight = graph.bars.inverse_mass_1_kg[i];
        for (const std::uint32_t row : links_at[i]) {
            for (const std::uint32_t column : links_at[i]) {
                if (row < column) continue;
                const bool same_end = (links[row].b == i) == (links[column].b == i);
                triplets.emplace_back(row, column, same_end ? weight : -weight);
            }
        }
    }
    const auto count = static_cast<Eigen::Index>(links.size());
    graph.dx_m.assign(links.size(), 0.0);
    graph.dy_m.assign(links.size(), 0.0);
    graph.right.setZero(count);
    graph.entries.clear();
    graph.diagonal.clear();
    graph.matrix.resize(count, count);
    graph.matrix.setFromTriplets(triplets.begin(), triplets.end());
    graph.matrix.makeCompressed();
    for (Eigen::Index column = 0; column < count; ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(graph.matrix, column); it; ++it) {
            if (it.row() == column) graph.diagonal.push_back(graph.entries.size());
            graph.entries.push_back(
                {static_cast<std::uint32_t>(it.row()), static_cast<std::uint32_t>(column), it.value()});
        }
    }
    graph.factors.analyse(graph.matrix);
    graph.is_factorised = false;
}

/// Factorises the matrix at these positions, its diagonal entries raised by a share; does nothing if the
/// factors are already the result. False if it cannot.
bool factorise(BarGraph& graph, const Motion& motion, double raise) {
    bool is_new = !graph.is_factorised || raise != graph.raise;
    for (std::size_t k = 0; k < graph.bars.links.size(); ++k) {
        const auto [a, b, rest_m] = graph.bars.links[k];
        const double dx_m = (motion.x_m[b] - motion.x_m[a]) + (motion.x_lost_m[b] - motion.x_lost_m[a]);
        const double dy_m = (motion.y_m[b] - motion.y_m[a]) + (motion.y_lost_m[b] - motion.y_lost_m[a]);
        is_new = is_new || dx_m != graph.dx_m[k] || dy_m != graph.dy_m[k];
        graph.dx_m[k] = dx_m;
        graph.dy_m[k] = dy_m;
    }
    if (!is_new) return true;
    graph.is_factorised = false;
    double* const values = graph.matrix.valuePtr();
    for (std::size_t e = 0; e < graph.entries.size(); ++e) {
        const auto [row, column, factor] = graph.entries[e];
        values[e] = factor * (graph.dx_m[row] * graph.dx_m[column] + graph.dy_m[row] * graph.dy_m[column]);
    }
    if (raise > 0.0) graph.matrix.diagonal() *= 1.0 + raise;
    if (!graph.factors.factorise(values)) return false;
    graph.is_factorised = true;
    graph.raise = raise;
    return true;
}

/// Factorises the matrix without a raise; false also if bars depend on each other.
bool is_regular(BarGraph& graph, const Motion& motion) {
    graph.smallest_pivot = 0.0;
    if (!factorise(graph, motion, 0.0)) return false;
    double smallest = 1.0;
    for (std::size_t k = 0; k < graph.diagonal.size(); ++k) {
        const double pivot = graph.factors.pivot(k) / graph.matrix.valuePtr()[graph.diagonal[k]];
        if (!(pivot > kDependentPivot)) return false;  // negated, so that a NaN fails
        smallest = std::min(smallest, pivot);
    }
    graph.smallest_pivot = smallest;
    return true;
}

/// See ConstraintSolver::solve().
bool solve_for(BarGraph& graph, const Motion& motion, std::span<double> right) {
    if (!is_regular(graph, motion) && !factorise(graph, motion, kLeapRaise)) return false;
    std::copy(right.begin(), right.end(), graph.right.data());
    graph.factors.solve(graph.right.data());
    std::copy_n(graph.right.data(), right.size(), right.begin());
    return graph.right.allFinite();
}

/// Changes the velocities by impulses along the bars of the last factorise().
void apply(const BarGraph& graph, const double* impulse, Motion& motion) {
    const std::vector<double>& inverse_mass = graph.bars.inverse_mass_1_kg;
    for (std::size_t k = 0; k < graph.bars.links.size(); ++k) {
        const auto [a, b, rest_m] = graph.bars.links[k];
        const double px = impulse[k] * graph.dx_m[k];
        const double py = impulse[k] * graph.dy_m[k];
        add_unrounded(motion.vx_m_s[a], motion.vx_lost_m_s[a], inverse_mass[a] * px);
        add_unrounded(motion.vy_m_s[a], motion.vy_lost_m_s[a], inverse_mass[a] * py);
        add_unrounded(motion.vx_m_s[b], motion.vx_lost_m_s[b], -inverse_mass[b] * px);
        add_unrounded(motion.vy_m_s[b], motion.vy_lost_m_s[b], -inverse_mass[b] * py);
    }
}

void stand_still(Motion& motion) {
    for (auto* part : {&motion.vx_m_s, &motion.vy_m_s, &motion.vx_lost_m_s, &motion.vy_lost_m_s})
        std::fill(part->begin(), part->end(), 0.0);
}

/// The largest squared relative velocity of a link's ends.
double largest_square(std::span<const Link> links, const Motion& motion) {
    double largest = 0.0;
    for (const Link& link : links) largest = std::max(largest, dot(apart(link, motion), apart(link, motion)));
    return largest;
}

/// True if regular bars leave only the motions of a rigid body.
bool is_rigid(const RigidBars& bars) {
    const std::size_t freedoms = 2 * (bars.inverse_mass_1_kg.size() - bars.held.size()) - bars.links.size();
    return freedoms == (bars.held.empty() ? 3 : bars.held.size() == 1 ? 1 : 0);
}

/// Leaves out the links that others imply, as far as a factorisation with this raise shows them.
void leave_out_implied(BarGraph& graph, const Motion& start, double raise) {
    if (!factorise(graph, start, raise)) return;
    std::vector<Link> kept;
    for (std::size_t k = 0; k < graph.bars.links.size(); ++k) {
        const double diagonal = graph.matrix.valuePtr()[graph.diagonal[k]];
        const bool is_implied = !(graph.factors.pivot(k) > kImpliedPivot * diagonal);
        (is_implied ? graph.implied : kept).push_back(graph.bars.links[k]);
    }
    graph.bars.links = std::move(kept);
    analyse(graph);
}

/// True if every motion from these positions that keeps the links' lengths keeps those of the implied bars,
/// to second order.
bool stay_implied(BarGraph& graph, Motion motion) {
    // The change of an implied bar's length in a motion that keeps the others to second order is a quadratic
    // form of the velocities: if it is 0 for generic velocities, it is always 0.
    const std::vector<Link>& links = graph.bars.links;
    std::uint32_t order = 1;
    const auto any = [&order](double weight) {
        order = order * 1664525U + 1013904223U;
        return weight > 0.0 ? static_cast<double>(order) / 2147483648.0 - 1.0 : 0.0;
    };
    for (std::size_t i = 0; i < motion.x_m.size(); ++i) {
        motion.vx_m_s[i] = any(graph.bars.inverse_mass_1_kg[i]);
        motion.vy_m_s[i] = any(graph.bars.inverse_mass_1_kg[i]);
    }
    const auto turn = [&motion](const Link& link) { return dot(along(link, motion), apart(link, motion)); };
    const auto square = [&motion](const Link& link) { return dot(apart(link, motion), apart(link, motion)); };
    // Changes them so that no link turns into `wanted`, twice to remove the rounding of the first time: a
    // large plate leaves next to nothing of them.
    std::vector<double> wanted(links.size(), 0.0);
    std::vector<double> pull(links.size());
    const auto meet = [&] {
        for (int i = 0; i < 2; ++i) {
            for (std::size_t k = 0; k < links.size(); ++k) pull[k] = turn(links[k]) - wanted[k];
            if (!solve_for(graph, motion, pull)) return false;
            apply(graph, pull.data(), motion);
        }
        return true;
    };
    if (!meet()) return false;
    const double largest = largest_square(links, motion);
    for (std::size_t k = 0; k < links.size(); ++k) wanted[k] = -square(links[k]);
    std::vector<double> bends;
    for (const Link& link : graph.implied) {
        if (!(std::abs(turn(link)) <= kBendTolerance * link.rest_m * std::sqrt(largest))) return false;
        bends.push_back(square(link));
    }
    stand_still(motion);  // from here on accelerations in the place of velocities
    if (!meet()) return false;
    for (std::size_t k = 0; k < bends.size(); ++k) {
        if (!(std::abs(bends[k] + turn(graph.implied[k])) <= kBendTolerance * largest)) return false;
    }
    return true;
}

RigidPlate plate_of(const System& system, const std::vector<std::uint32_t>& held) {
    if (held.size() > 1) return {HUGE_VAL, 0.0};  // nothing turns it
    const std::size_t count = system.particle_count();
    RigidPlate plate;
    double mass_kg = 0.0;
    Vec2 moment;
    for (std::size_t i = 0; i < count; ++i) {
        mass_kg += system.mass_kg[i];
        moment = moment + system.mass_kg[i] * Vec2{system.x_m[i], system.y_m[i]};
    }
    const Vec2 center = (1.0 / mass_kg) * moment;
    const Vec2 pivot = held.empty() ? center : Vec2{system.x_m[held.front()], system.y_m[held.front()]};
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 arm = Vec2{system.x_m[i], system.y_m[i]} - pivot;
        plate.inertia_kg_m2 += system.mass_kg[i] * dot(arm, arm);
    }
    const Vec2 lever = center - pivot;
    plate.lever_kg_m = mass_kg * length(lever.x, lever.y);
    return plate;
}

bool meet_implied(const BarGraph& graph, const Motion& motion) {
    return std::ranges::all_of(graph.implied, [&motion](const Link& link) {
        const Vec2 d = along(link, motion);
        const double square = link.rest_m * link.rest_m;
        return std::abs(dot(d, d) - square) <= kImpliedTolerance * square;
    });
}

/// Writes the errors of the squared lengths at the end of the stage, over twice its span, to `right`. True if
/// they are small enough and no bar turns too far.
bool correct(BarGraph& graph, double span_s, const Motion& motion) {
    bool met = true;
    for (std::size_t k = 0; k < graph.bars.links.size(); ++k) {
        const Link& link = graph.bars.links[k];
        const Vec2 d{graph.dx_m[k], graph.dy_m[k]};
        const Vec2 e = d + span_s * apart(link, motion);
        const double square = link.rest_m * link.rest_m;
        const double excess = dot(e, e) - square;
        graph.right[static_cast<Eigen::Index>(k)] = 0.5 / span_s * excess;
        met = met && std::abs(excess) <= kExcessTolerance * square &&
              dot(e, d) >= Stage::kMinTurnCosine * square;
    }
    return met;
}

/// Entries in the factors of a matrix that is not symmetric per update of count_work(): each takes 20 to 30
/// ns (40 to 19 800 bars).
constexpr std::uint64_t kEntriesPerUpdate = 2;

/// Completes a stage after its kick by the full Newton method, whose matrix follows the bars to either side
/// of their line. False if it does not converge or may have taken the other branch.
bool cross(BarGraph& graph, CrossingMatrix& crossing, double span_s, Motion& motion, ImpulseVector impulse) {
    impulse.setZero();
    if (crossing.matrix.rows() == 0) {
        crossing.matrix = graph.matrix.selfadjointView<Eigen::Lower>();
        crossing.factors.analyzePattern(crossing.matrix);
    }
    const std::vector<Link>& links = graph.bars.links;
    const auto couple = [&](std::uint32_t row, std::uint32_t column, double factor) {
        const Vec2 e = Vec2{graph.dx_m[row], graph.dy_m[row]} + span_s * apart(links[row], motion);
        crossing.matrix.coeffRef(row, column) = factor * dot(e, {graph.dx_m[column], graph.dy_m[column]});
    };
    const double fastest = std::sqrt(largest_square(links, motion));
    Motion last = motion;
    double last_change = kCrossingChange / kShrink * fastest;
    bool met = correct(graph, span_s, motion);
    for (int i = 0; i < kMaxCrossingSteps && !met; ++i) {
        for (const auto& [row, column, factor] : graph.entries) {
            couple(row, column, factor);
            if (row != column) couple(column, row, factor);
        }
        crossing.factors.factorize(crossing.matrix);
        if (crossing.factors.info() != Eigen::Success) return false;
        const auto entries = static_cast<std::uint64_t>(crossing.factors.nnzL() + crossing.factors.nnzU());
        count_work(1 + entries / kEntriesPerUpdate);
        graph.right = crossing.factors.solve(graph.right);
        impulse += graph.right;
        apply(graph, graph.right.data(), motion);
        double change = 0.0;
        for (const Link& link : links) {
            const Vec2 changed = apart(link, motion) - apart(link, last);
            change = std::max(change, std::sqrt(dot(changed, changed)));
        }
        if (!(change <= kShrink * std::max(last_change, kRoundedChange * fastest))) return false;
        last = motion;
        last_change = change;
        met = correct(graph, span_s, motion);
    }
    return met;
}

}  // namespace

BarGraph::BarGraph(const System& system) : bars(system, inverse_masses_with_taut_rows_held(system)) {
    const Motion start = Motion::start_of(system);
    analyse(*this);
    bool is_determined = is_regular(*this, start);
    // Repeat without the raise: bars with large coefficients may hide one another.
    for (const double share : {kRaise, 0.0, 0.0}) {
        if (is_determined) return;
        leave_out_implied(*this, start, share);
        is_determined = is_regular(*this, start) && (is_rigid(bars) || stay_implied(*this, start));
    }
    if (is_determined) return;
    throw Refusal(Refusal::Reason::kDependentBars,
                  "the lengths of rigid bars depend on each other at the start, but not in the motion that "
                  "follows");
}

GraphConstraints::GraphConstraints(const System& system)
    : graph_(system),
      holds_rows_(graph_.bars.inverse_mass_1_kg != system.inverse_mass_1_kg),
      near_line_(kNearLine * graph_.smallest_pivot),
      load_(system.particle_count()) {
    if (is_rigid(graph_.bars)) plate_ = plate_of(system, graph_.bars.held);
}

bool GraphConstraints::move(const Stage& stage, Motion& motion, std::span<double> impulse) {
    ImpulseVector impulses(impulse.data(), static_cast<Eigen::Index>(impulse.size()));
    kick(graph_.bars, stage, motion);
    if (!is_regular(graph_, motion) || graph_.smallest_pivot < near_line_) {
        if (!cross(graph_, crossing_, stage.span_s, motion, impulses)) return false;
    } else {
        apply(graph_, impulse.data(), motion);
        bool met = correct(graph_, stage.span_s, motion);
        for (int i = 0; i < kMaxCorrections && !met; ++i) {
            graph_.factors.solve(graph_.right.data());
            impulses += graph_.right;
            apply(graph_, graph_.right.data(), motion);
            met = correct(graph_, stage.span_s, motion);
        }
        if (!met) return false;
    }
    drift(stage.span_s, motion);
    return meet_implied(graph_, motion);
}

bool GraphConstraints::leap(double span_s, Motion& motion) {
    const std::vector<Link>& links = graph_.bars.links;
    drift(span_s, motion);
    const Motion ahead = motion;
    double largest = HUGE_VAL;
    for (int i = 0; i < kMaxCorrections && largest > kExcessTolerance; ++i) {
        if (!factorise(graph_, motion, kLeapRaise)) return false;
        largest = 0.0;
        for (std::size_t k = 0; k < links.size(); ++k) {
            const Vec2 d{graph_.dx_m[k], graph_.dy_m[k]};
            const double square = links[k].rest_m * links[k].rest_m;
            const double excess = dot(d, d) - square;
            graph_.right[static_cast<Eigen::Index>(k)] = 0.5 * excess;
            largest = std::max(largest, std::abs(excess) / square);
        }
        graph_.factors.solve(graph_.right.data());
        stand_still(motion);
        apply(graph_, graph_.right.data(), motion);
        drift(1.0, motion);
    }
    if (!(largest <= kImpliedTolerance) || !meet_implied(graph_, motion)) return false;
    motion.vx_m_s = ahead.vx_m_s;
    motion.vy_m_s = ahead.vy_m_s;
    motion.vx_lost_m_s = ahead.vx_lost_m_s;
    motion.vy_lost_m_s = ahead.vy_lost_m_s;
    if (!factorise(graph_, motion, kLeapRaise)) return false;
    for (std::size_t k = 0; k < links.size(); ++k)
        graph_.right[static_cast<Eigen::Index>(k)] = dot(along(links[k], motion), apart(links[k], motion));
    graph_.factors.solve(graph_.right.data());
    apply(graph_, graph_.right.data(), motion);
    return graph_.right.allFinite();
}

bool GraphConstraints::solve(const Motion& motion, std::span<double> right) {
    return solve_for(graph_, motion, right);
}

double GraphConstraints::distance_from_line(const Motion& motion) {
    static_cast<void>(is_regular(graph_, motion));
    return graph_.smallest_pivot / near_line_;
}

double GraphConstraints::square_frequency(std::span<const double> multiplier) const {
    const std::vector<Link>& links = graph_.bars.links;
    if (plate_) {
        double pull_j = 0.0;
        for (std::size_t k = 0; k < links.size(); ++k)
            pull_j += multiplier[k] * links[k].rest_m * links[k].rest_m;
        return std::abs(pull_j) / plate_->inertia_kg_m2;
    }
    std::fill(load_.begin(), load_.end(), 0.0);
    for (std::size_t k = 0; k < links.size(); ++k) {
        load_[links[k].a] += std::abs(multiplier[k]);
        load_[links[k].b] += std::abs(multiplier[k]);
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < load_.size(); ++i)
        largest = std::max(largest, graph_.bars.inverse_mass_1_kg[i] * load_[i]);
    return 2.0 * largest;
}

double GraphConstraints::expected_square_frequency(const System& system, double acceleration_m_s2,
                                                   std::span<const double> multiplier) const {
    if (!plate_) return ConstraintSolver::expected_square_frequency(system, acceleration_m_s2, multiplier);
    const double hanging = acceleration_m_s2 * plate_->lever_kg_m / plate_->inertia_kg_m2;
    return std::max(hanging, 2.0 * square_frequency(multiplier));
}

std::vector<double> GraphConstraints::carried_mass(std::span<const double> mass_kg) const {
    double all_kg = 0.0;
    for (std::size_t i = 0; i < mass_kg.size(); ++i) {
        if (graph_.bars.inverse_mass_1_kg[i] > 0.0) all_kg += mass_kg[i];
    }
    return std::vector<double>(graph_.bars.links.size(), graph_.bars.held.empty() ? 0.0 : all_kg);
}

}  // namespace corda::sim
