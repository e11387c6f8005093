#include "corda/sim/exact/chain_dynamics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "corda/sim/chain_tensions.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// A chain between two pins whose length exceeds their distance by less than this share is taut: its tensions
/// are not determined.
constexpr double kTaut = 1e-12;

/// Newton steps that close a chain between two pins, all with the matrix of the first. Each step multiplies
/// the gap by about its size relative to the chain, at most 1e-4.
constexpr int kClosingSteps = 4;

double length_of(Vec2 a) {
    return length(a.x, a.y);
}

Vec2 at(const std::vector<double>& x, const std::vector<double>& y, std::size_t i) {
    return {x[i], y[i]};
}

/// The symmetric 2 x 2 matrix for closing a chain, the sum of a_i p_i p_i^T, plus a small multiple of the
/// identity: links in one line cannot move their end along it and must stay unchanged.
struct ClosingMatrix {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;

    void add(double length_m, Vec2 across) {
        xx += length_m * across.x * across.x;
        xy += length_m * across.x * across.y;
        yy += length_m * across.y * across.y;
    }
    /// The determinant in parts of the squared trace.
    [[nodiscard]] double regularity() const { return (xx * yy - xy * xy) / ((xx + yy) * (xx + yy)); }
    [[nodiscard]] Vec2 solve(Vec2 right) const {
        const double extra = 1e-14 * (xx + yy);
        const double x1 = xx + extra;
        const double y1 = yy + extra;
        const double determinant = x1 * y1 - xy * xy;
        return {(y1 * right.x - xy * right.y) / determinant, (x1 * right.y - xy * right.x) / determinant};
    }
};

}  // namespace

ChainDynamics::ChainDynamics(const System& system, std::span<const Body> bodies, const Forces& forces)
    : forces_(forces), mass_kg_(system.mass_kg), links_(system.particle_count()) {
    for (const Body& body : bodies) {
        assert(body.is_chain);
        add_body(system, body);
    }
    bending_ = ChainBending(system, links_, length_m_);
    set_timescales();
    const std::size_t links = length_m_.size();
    for (std::vector<double>* array : {&beyond_, &cosine_, &sine_, &along_, &pivot_, &weight_, &tension_n_})
        array->assign(links, 0.0);
    initial_state_.assign(3 * links + extra_count_, 0.0);
    double* const y = initial_state_.data();
    for (Chain& chain : chains_) {
        if (!chain.starts_pinned) chain.first_extra += 3 * links;
        for (std::size_t i = 0; i < chain.link_count; ++i) {
            const std::size_t before = i == 0 ? chain.first_particle : chain.particle(i - 1);
            const Vec2 along =
                at(system.x_m, system.y_m, chain.particle(i)) - at(system.x_m, system.y_m, before);
            const double distance_m = length_of(along);
            assert(distance_m > 0.0);
            y[chain.first_link + i] = along.x / distance_m;
            y[links + chain.first_link + i] = along.y / distance_m;
        }
        add_initial_velocities(system, chain, y);
        if (!chain.starts_pinned) add_center_of_mass(system, chain, y);
    }
    project(y);
}

void ChainDynamics::add_body(const System& system, const Body& body) {
    const std::size_t end = body.first_particle + body.particle_count;
    std::vector<std::size_t> pinned;
    for (std::size_t i = body.first_particle; i < end; ++i) {
        if (system.is_pinned(i)) {
            pinned.push_back(i);
            mass_kg_[i] = 0.0;
        }
    }
    if (pinned.empty()) {
        add_chain(system, body, body.first_particle, end - 1);
        return;
    }
    for (const std::size_t i : pinned) pins_.push_back({i, at(system.x_m, system.y_m, i)});
    if (pinned.front() > body.first_particle) add_chain(system, body, pinned.front(), body.first_particle);
    for (std::size_t k = 1; k < pinned.size(); ++k) add_chain(system, body, pinned[k - 1], pinned[k]);
    if (pinned.back() < end - 1) add_chain(system, body, pinned.back(), end - 1);
}

void ChainDynamics::add_chain(const System& system, const Body& body, std::size_t from, std::size_t to) {
    Chain chain;
    chain.first_link = length_m_.size();
    chain.runs_backwards = to < from;
    chain.link_count = chain.runs_backwards ? from - to : to - from;
    chain.first_particle = from;
    chain.starts_pinned = system.is_pinned(from);
    chain.ends_pinned = system.is_pinned(to);
    if (chain.starts_pinned && chain.ends_pinned && chain.link_count == 1) return;  // it never moves
    chain.start_m = at(system.x_m, system.y_m, from);
    chain.span_m = at(system.x_m, system.y_m, to) - chain.start_m;
    chain.inverse_mass_1_kg = system.inverse_mass_1_kg[from];
    if (!chain.starts_pinned) {
        chain.first_extra = extra_count_;
        extra_count_ += 4;
        energy_offset_j_ += mass_kg_[from] * forces_.potential_j_kg(chain.start_m);
    }
    double fastest_m_s = length_of(at(system.vx_m_s, system.vy_m_s, from));
    for (std::size_t i = 0; i < chain.link_count; ++i) {
        const std::size_t particle = chain.particle(i);
        const std::size_t before = chain.runs_backwards ? particle : particle - 1;
        links_[before] = {length_m_.size(), chain.runs_backwards, true};
        length_m_.push_back(system.bars[body.first_bar + before - body.first_particle].rest_m);
        inverse_length_1_m_.push_back(1.0 / length_m_.back());
        inverse_mass_1_kg_.push_back(system.inverse_mass_1_kg[particle]);
        chain.length_m += length_m_.back();
        fastest_m_s = std::max(fastest_m_s, length_of(at(system.vx_m_s, system.vy_m_s, particle)));
        energy_offset_j_ += mass_kg_[particle] * forces_.potential_j_kg(chain.start_m);
    }
    chain.inverse_timescale_1_s = forces_.inverse_timescale_1_s(chain.length_m, fastest_m_s);
    if (chain.starts_pinned && chain.ends_pinned) refuse_taut(chain.length_m, chain.span_m, from, to);
    chains_.push_back(chain);
}

void ChainDynamics::add_particle(const System& system, std::size_t particle, double length_m,
                                 double inverse_timescale_1_s) {
    Chain chain;
    chain.first_link = link_count();
    chain.first_particle = particle;
    chain.starts_pinned = false;
    chain.first_extra = initial_state_.size();
    chain.start_m = at(system.x_m, system.y_m, particle);
    chain.inverse_mass_1_kg = system.inverse_mass_1_kg[particle];
    chain.length_m = length_m;
    chain.inverse_timescale_1_s = inverse_timescale_1_s;
    chains_.push_back(chain);
    initial_state_.insert(initial_state_.end(), {0.0, 0.0, system.vx_m_s[particle], system.vy_m_s[particle]});
    energy_offset_j_ += mass_kg_[particle] * forces_.potential_j_kg(chain.start_m);
}

void ChainDynamics::refuse_taut(double length_m, Vec2 span_m, std::size_t from, std::size_t to) {
    if (length_m - length_of(span_m) > kTaut * length_m) return;
    throw Refusal(Refusal::Reason::kTautBetweenPins,
                  "method exact cannot work out the tensions of a rope that is taut between two pins "
                  "(particles " +
                      std::to_string(from) + " and " + std::to_string(to) + ", " + std::to_string(length_m) +
                      " m apart)");
}

void ChainDynamics::set_timescales() {
    for (Chain& chain : chains_) {
        if (bends()) {
            double rigidity_n_m2 = 0.0;
            double mass_kg = chain.starts_pinned ? 0.0 : mass_kg_[chain.first_particle];
            for (std::size_t i = 0; i < chain.link_count; ++i) {
                rigidity_n_m2 = std::max(rigidity_n_m2, bending_.rigidity_n_m2(chain.first_link + i));
                mass_kg += mass_kg_[chain.particle(i)];
            }
            // The slowest vibration of an elastic bar is faster by a factor of 3.5 (clamped) to 22 (free).
            const double volume_m3 = chain.length_m * chain.length_m * chain.length_m;
            chain.inverse_timescale_1_s =
                std::max(chain.inverse_timescale_1_s, std::sqrt(rigidity_n_m2 / (mass_kg * volume_m3)));
        }
        if (chain.inverse_timescale_1_s == 0.0) chain.inverse_timescale_1_s = 1.0;
    }
}

void ChainDynamics::add_initial_velocities(const System& system, const Chain& chain, double* y) {
    const std::size_t links = link_count();
    const auto velocity = [&](std::size_t particle) { return at(system.vx_m_s, system.vy_m_s, particle); };
    measure_joints(chain, y);
    // Impulses obey the equations of the tensions, with velocities in place of accelerations.
    Vec2 before = velocity(chain.first_particle);
    for (std::size_t i = 0; i < chain.link_count; ++i) {
        const std::size_t link = chain.first_link + i;
        const Vec2 after = velocity(chain.particle(i));
        const Vec2 direction{y[link], y[links + link]};
        along_[link] = dot(direction, after - before);
        y[2 * links + link] = dot(left_of(direction), after - before);
        before = after;
    }
    solve_tensions(chain);
    for (std::size_t i = 0; i < chain.link_count; ++i) {
        const std::size_t link = chain.first_link + i;
        y[2 * links + link] = (y[2 * links + link] + pull_across(chain, i)) * inverse_length_1_m_[link];
    }
}

void ChainDynamics::add_center_of_mass(const System& system, const Chain& chain, double* y) {
    double mass_kg = 0.0;
    Vec2 momentum_n_s;
    for (std::size_t i = chain.link_count + 1; i-- > 0;) {
        const std::size_t particle = i == 0 ? chain.first_particle : chain.particle(i - 1);
        mass_kg += mass_kg_[particle];
        momentum_n_s = momentum_n_s + mass_kg_[particle] * at(system.vx_m_s, system.vy_m_s, particle);
        if (i > 0) beyond_[chain.first_link + i - 1] = mass_kg;
    }
    for (std::size_t i = 0; i < chain.link_count; ++i) beyond_[chain.first_link + i] /= mass_kg;
    double* const extra = y + chain.first_extra;
    walk(chain, y, [&](std::size_t particle, Vec2 moved, Vec2 /*velocity*/) {
        if (particle == chain.first_particle) extra[0] = -moved.x, extra[1] = -moved.y;
    });
    extra[2] = momentum_n_s.x / mass_kg;
    extra[3] = momentum_n_s.y / mass_kg;
}

std::vector<ErrorScale> ChainDynamics::error_scales() const {
    std::vector<ErrorScale> scales;
    const std::size_t links = link_count();
    scales.push_back({0, 2 * links, 1.0, 0.0});
    for (const Chain& chain : chains_) {
        scales.push_back({2 * links + chain.first_link, chain.link_count, chain.inverse_timescale_1_s, 1.0});
        if (chain.starts_pinned) continue;
        scales.push_back({chain.first_extra, 2, chain.length_m, 0.0});
        scales.push_back({chain.first_extra + 2, 2, chain.length_m * chain.inverse_timescale_1_s, 1.0});
    }
    return scales;
}

double ChainDynamics::inverse_timescale_1_s() const {
    double largest = 0.0;
    for (const Chain& chain : chains_) largest = std::max(largest, chain.inverse_timescale_1_s);
    return largest > 0.0 ? largest : 1.0;
}

template <bool kBends>
void ChainDynamics::find_tensions(const Chain& chain, const double* y) {
    if (chain.link_count == 0) return;
    measure_joints(chain, y);
    measure_loads(chain, y);
    if constexpr (kBends) add_bending_along(chain);
    solve_tensions(chain);
}

void ChainDynamics::find_all_tensions(const double* y) {
    if (bends()) {
        bending_.find_couples(y);
        for (const Chain& chain : chains_) find_tensions<true>(chain, y);
    } else {
        for (const Chain& chain : chains_) find_tensions<false>(chain, y);
    }
}

void ChainDynamics::measure_joints(const Chain& chain, const double* y) {
    const double* const c = y + chain.first_link;
    const double* const s = c + link_count();
    const double* const inverse_mass = inverse_mass_1_kg_.data() + chain.first_link;
    double* __restrict const cosine = cosine_.data() + chain.first_link;
    double* __restrict const sine = sine_.data() + chain.first_link;
    for (std::size_t i = 0; i + 1 < chain.link_count; ++i) {
        cosine[i] = inverse_mass[i] * (c[i] * c[i + 1] + s[i] * s[i + 1]);
        sine[i] = inverse_mass[i] * (c[i] * s[i + 1] - s[i] * c[i + 1]);
    }
}

void ChainDynamics::measure_loads(const Chain& chain, const double* y) {
    const std::size_t first = chain.first_link;
    const std::size_t last = first + chain.link_count - 1;
    const double* const s = y + link_count();
    const double* const omega = y + 2 * link_count();
    const double* const length = length_m_.data();
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    double* __restrict const along = along_.data();
    for (std::size_t i = first; i <= last; ++i) along[i] = length[i] * (omega[i] * omega[i]);
    if (chain.starts_pinned) along[first] += dot(uniform_m_s2, {y[first], s[first]});
    if (chain.ends_pinned) along[last] -= dot(uniform_m_s2, {y[last], s[last]});
}

void ChainDynamics::solve_tensions(const Chain& chain) {
    const std::size_t first = chain.first_link;
    sim::solve_tensions({chain.link_count, chain.inverse_mass_1_kg, &inverse_mass_1_kg_[first],
                         &cosine_[first], &sine_[first]},
                        &along_[first], &pivot_[first], &weight_[first], &tension_n_[first]);
}

double ChainDynamics::pull_across(const Chain& chain, std::size_t link) const {
    const std::size_t i = chain.first_link + link;
    const double after = link + 1 < chain.link_count ? sine_[i] * tension_n_[i + 1] : 0.0;
    const double before = link > 0 ? sine_[i - 1] * tension_n_[i - 1] : 0.0;
    return after - before;
}

void ChainDynamics::add_bending_along(const Chain& chain) {
    const double* const couple = bending_.couple_n().data() + chain.first_link;
    const double* const sine = sine_.data() + chain.first_link;
    double* const along = along_.data() + chain.first_link;
    for (std::size_t i = 0; i + 1 < chain.link_count; ++i) {
        along[i] += sine[i] * couple[i + 1];
        along[i + 1] -= sine[i] * couple[i];
    }
}

void ChainDynamics::add_bending_across(const Chain& chain, double* slope) const {
    const std::size_t first = chain.first_link;
    const double* const couple = bending_.couple_n().data();
    double* const slope_omega = slope + 2 * link_count();
    for (std::size_t i = first; i < first + chain.link_count; ++i) {
        const bool is_first = i == first;
        const bool is_last = i + 1 == first + chain.link_count;
        const double near_1_kg = is_first ? chain.inverse_mass_1_kg : inverse_mass_1_kg_[i - 1];
        const double before = is_first ? 0.0 : cosine_[i - 1] * couple[i - 1];
        const double after = is_last ? 0.0 : cosine_[i] * couple[i + 1];
        slope_omega[i] +=
            ((near_1_kg + inverse_mass_1_kg_[i]) * couple[i] - after - before) * inverse_length_1_m_[i];
    }
}

void ChainDynamics::derivative(const double* y, double* slope) {
    if (bends()) {
        bending_.find_couples(y);
        evaluate<true>(y, slope);
    } else {
        evaluate<false>(y, slope);
    }
}

template <bool kBends>
void ChainDynamics::evaluate(const double* y, double* slope) {
    const std::size_t links = link_count();
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    const double drag_1_s = forces_.drag_1_s();
    const double* const c = y;
    const double* const s = y + links;
    const double* const omega = y + 2 * links;
    double* __restrict const slope_c = slope;
    double* __restrict const slope_s = slope + links;
    double* __restrict const slope_omega = slope + 2 * links;
    for (std::size_t i = 0; i < links; ++i) {
        slope_c[i] = -(omega[i] * s[i]);
        slope_s[i] = omega[i] * c[i];
    }
    for (const Chain& chain : chains_) {
        find_tensions<kBends>(chain, y);
        if (chain.link_count > 0) turn(chain, y, slope_omega);
        if (!chain.starts_pinned) {
            const double* const extra = y + chain.first_extra;
            double* const slope_extra = slope + chain.first_extra;
            std::copy_n(extra + 2, 2, slope_extra);
            slope_extra[2] = uniform_m_s2.x - drag_1_s * extra[2];
            slope_extra[3] = uniform_m_s2.y - drag_1_s * extra[3];
        }
        if constexpr (kBends) add_bending_across(chain, slope);
    }
}

void ChainDynamics::turn(const Chain& chain, const double* y, double* __restrict slope_omega) const {
    const double* const c = y;
    const double* const s = y + link_count();
    const double* const omega = y + 2 * link_count();
    const double drag_1_s = forces_.drag_1_s();
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    const std::size_t first = chain.first_link;
    const std::size_t last = first + chain.link_count - 1;
    const auto turn_link = [&](std::size_t i, double across) {
        slope_omega[i] = across * inverse_length_1_m_[i] - drag_1_s * omega[i];
    };
    const double* const sine = sine_.data();
    const double* const tension = tension_n_.data();
    for (std::size_t i = first + 1; i < last; ++i) {
        turn_link(i, sine[i] * tension[i + 1] - sine[i - 1] * tension[i - 1]);
    }
    turn_link(first, pull_across(chain, 0));
    turn_link(last, pull_across(chain, chain.link_count - 1));
    if (chain.starts_pinned)
        slope_omega[first] += dot(uniform_m_s2, left_of({c[first], s[first]})) * inverse_length_1_m_[first];
    if (chain.ends_pinned)
        slope_omega[last] -= dot(uniform_m_s2, left_of({c[last], s[last]})) * inverse_length_1_m_[last];
}

void ChainDynamics::project(double* y) {
    const std::size_t links = link_count();
    double* __restrict const c = y;
    double* __restrict const s = y + links;
    for (std::size_t i = 0; i < links; ++i) {
        const double inverse = 1.0 / std::sqrt(c[i] * c[i] + s[i] * s[i]);
        c[i] *= inverse;
        s[i] *= inverse;
    }
    for (const Chain& chain : chains_) {
        if (chain.starts_pinned && chain.ends_pinned) close(chain, y);
    }
}

void ChainDynamics::close(const Chain& chain, double* y) const {
    const std::size_t links = link_count();
    const std::size_t end = chain.first_link + chain.link_count;
    const auto direction = [&](std::size_t i) { return Vec2{y[i], y[links + i]}; };
    ClosingMatrix matrix;
    for (std::size_t i = chain.first_link; i < end; ++i) matrix.add(length_m_[i], left_of(direction(i)));
    for (int k = 0; k < kClosingSteps; ++k) {
        Vec2 open = chain.span_m;
        for (std::size_t i = chain.first_link; i < end; ++i) open = open - length_m_[i] * direction(i);
        const Vec2 multiplier = matrix.solve(open);
        for (std::size_t i = chain.first_link; i < end; ++i) {
            const Vec2 across = left_of(direction(i));
            const Vec2 turned = direction(i) + dot(across, multiplier) * across;
            const double inverse = 1.0 / length_of(turned);
            y[i] = inverse * turned.x;
            y[links + i] = inverse * turned.y;
        }
    }
    Vec2 open;
    for (std::size_t i = chain.first_link; i < end; ++i) {
        open = open - (length_m_[i] * y[2 * links + i]) * left_of(direction(i));
    }
    const Vec2 multiplier = matrix.solve(open);
    for (std::size_t i = chain.first_link; i < end; ++i)
        y[2 * links + i] += dot(left_of(direction(i)), multiplier);
}

double ChainDynamics::spread(const Chain& chain, const double* y) const {
    ClosingMatrix matrix;
    for (std::size_t i = chain.first_link; i < chain.first_link + chain.link_count; ++i)
        matrix.add(length_m_[i], {y[i], y[link_count() + i]});
    return matrix.regularity();
}

template <class Visit>
void ChainDynamics::walk(const Chain& chain, const double* y, const Visit& visit) const {
    const std::size_t links = link_count();
    const auto along = [&](std::size_t link) { return length_m_[link] * Vec2{y[link], y[links + link]}; };
    const auto turning = [&](std::size_t link) {
        return (length_m_[link] * y[2 * links + link]) * left_of({y[link], y[links + link]});
    };
    Vec2 moved;
    Vec2 velocity;
    if (!chain.starts_pinned) {
        moved = {y[chain.first_extra], y[chain.first_extra + 1]};
        velocity = {y[chain.first_extra + 2], y[chain.first_extra + 3]};
        for (std::size_t i = chain.first_link; i < chain.first_link + chain.link_count; ++i) {
            moved = moved - beyond_[i] * along(i);
            velocity = velocity - beyond_[i] * turning(i);
        }
        visit(chain.first_particle, moved, velocity);
    }
    const std::size_t moving = chain.ends_pinned ? chain.link_count - 1 : chain.link_count;
    for (std::size_t i = 0; i < moving; ++i) {
        moved = moved + along(chain.first_link + i);
        velocity = velocity + turning(chain.first_link + i);
        visit(chain.particle(i), moved, velocity);
    }
}

void ChainDynamics::positions(const double* y, State& state) const {
    for (const Pin& pin : pins_) {
        state.x_m[pin.particle] = pin.position_m.x;
        state.y_m[pin.particle] = pin.position_m.y;
    }
    for (const Chain& chain : chains_) {
        walk(chain, y, [&](std::size_t particle, Vec2 moved, Vec2 /*velocity*/) {
            state.x_m[particle] = chain.start_m.x + moved.x;
            state.y_m[particle] = chain.start_m.y + moved.y;
        });
    }
}

void ChainDynamics::velocities(const double* y, std::vector<double>& vx_m_s,
                               std::vector<double>& vy_m_s) const {
    for (const Chain& chain : chains_) {
        walk(chain, y, [&](std::size_t particle, Vec2 /*moved*/, Vec2 velocity) {
            vx_m_s[particle] = velocity.x;
            vy_m_s[particle] = velocity.y;
        });
    }
}

double ChainDynamics::energy_j(const double* y) const {
    double energy_j = 0.0;
    for (const Chain& chain : chains_) {
        walk(chain, y, [&](std::size_t particle, Vec2 moved, Vec2 velocity) {
            energy_j += mass_kg_[particle] * (0.5 * dot(velocity, velocity) + forces_.potential_j_kg(moved));
        });
    }
    if (bends()) energy_j += bending_.energy_j(y);
    return energy_offset_j_ + energy_j;
}

void ChainDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    find_all_tensions(y);
    tension_n.assign(links_.size() - 1, 0.0);
    for (std::size_t i = 0; i < tension_n.size(); ++i)
        if (links_[i].moves) tension_n[i] = tension_n_[links_[i].index];
}

}  // namespace corda::sim
