#include "corda/sim/exact/implicit_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "corda/sim/exact/chain_closing.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/elastic_dynamics.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

using radau::Index;

/// Share of the tolerance that one step may use. Errors add up: 40 of them in 4 s of a swing of 1000 links.
constexpr double kShareOfAnImplicitStep = 0.002;
/// Share of the length below which estimates are rounding alone.
constexpr double kMinShareOfAnImplicitStep = 1e-14;

bool stretches(const System& system) {
    return system.bodies.front().material.compliance_1_n > 0.0;
}

/// The bodies that implicit steps can move.
const std::vector<Body>& bodies_of(const System& system) {
    if (ImplicitPart::can_move(system, system.bodies.front())) return system.bodies;
    throw Refusal(Refusal::Reason::kImplicit,
                  "implicit steps move open ropes with a pin, and closed ones of rigid links, that neither "
                  "resist bending nor are strings");
}

Vec2 at(const std::vector<double>& x, const std::vector<double>& y, std::size_t i) {
    return {x[i], y[i]};
}

/// Sets the start of rigid links.
void start_rigid(RadauChain& r, ChainDynamics& dynamics, const System& system, const Chain& chain) {
    const Index stride = dynamics.chains().link_count();
    const double* const y = dynamics.initial_state().data();
    std::vector<double> slope(dynamics.initial_state().size());
    std::vector<double> tension_n(system.bars.size());
    dynamics.derivative(y, slope.data());
    dynamics.tensions(y, tension_n);
    for (Index i = 1; i <= r.links; ++i) {
        const Index link = chain.first_link + i - 1;
        r.c[i] = y[link];
        r.s[i] = y[stride + link];
        r.omega[i] = y[2 * stride + link];
        r.slope[i] = slope[2 * stride + link];
        for (RadauChain::Array& stage : r.old_tension) stage[i] = tension_n[chain.lower_particle(i - 1)];
    }
    measure_joints(r);
}

/// Sets the start of links that stretch: their derivatives by (16) and (17).
void start_stretching(RadauChain& r, const Chains& chains, const System& system, const Chain& chain) {
    std::size_t before = chain.first_particle;
    for (Index i = 1; i <= r.links; ++i) {
        const std::size_t after = chain.particle(i - 1);
        const Vec2 along = at(system.x_m, system.y_m, after) - at(system.x_m, system.y_m, before);
        const Vec2 apart = at(system.vx_m_s, system.vy_m_s, after) - at(system.vx_m_s, system.vy_m_s, before);
        const double distance_m = length(along.x, along.y);
        if (distance_m == 0.0)
            throw Refusal(Refusal::Reason::kImplicit,
                          "implicit steps cannot start from links that stretch and have no length");
        const Vec2 direction = (1.0 / distance_m) * along;
        r.c[i] = direction.x;
        r.s[i] = direction.y;
        r.omega[i] = dot(left_of(direction), apart) / distance_m;
        r.pull[i] = (distance_m - r.length_m[i]) / r.stretch_m_n[i];
        r.pull_rate[i] = dot(direction, apart) / r.stretch_m_n[i];
        before = after;
    }
    measure_joints(r);
    r.old_tension.fill(r.pull);
    for (Index i = 1; i <= r.links; ++i) {
        const Vec2 direction{r.c[i], r.s[i]};
        const double near_kg = r.inverse_mass_1_kg[i - 1];
        const double far_kg = r.inverse_mass_1_kg[i];
        Vec2 pull_m_s2;
        if (i == 1) pull_m_s2 = chains.forces_at_start(chain).uniform_at(0.0);
        if (i == r.links && r.ends_pinned)
            pull_m_s2 = pull_m_s2 - chains.forces_at_end(chain).uniform_at(0.0);
        const double length_m = r.length_m[i] + r.stretch_m_n[i] * r.pull[i];
        const double growth_m_s = r.stretch_m_n[i] * r.pull_rate[i];
        const double across =
            far_kg * r.joint_s[i] * r.pull[i + 1] - near_kg * r.joint_s[i - 1] * r.pull[i - 1];
        const double along = far_kg * r.joint_c[i] * r.pull[i + 1] +
                             near_kg * r.joint_c[i - 1] * r.pull[i - 1] - (near_kg + far_kg) * r.pull[i];
        r.slope[i] =
            (dot(pull_m_s2, left_of(direction)) + across - 2.0 * growth_m_s * r.omega[i]) / length_m -
            r.drag_1_s * r.omega[i];
        r.pull_slope[i] =
            (dot(pull_m_s2, direction) + along + length_m * r.omega[i] * r.omega[i]) / r.stretch_m_n[i] -
            r.drag_1_s * r.pull_rate[i];
    }
}

/// Brings the end of a step of links that stretch to `end`: each link takes a share by its length.
void close_stretching(RadauChain& r, const Span& end) {
    Vec2 open_m = end.place_m;
    Vec2 opening_m_s = end.velocity_m_s;
    const auto length_m = [&r](Index i) { return r.length_m[i] + r.stretch_m_n[i] * r.pull[i]; };
    for (Index i = 1; i <= r.links; ++i) {
        const Vec2 along{r.c[i], r.s[i]};
        open_m = open_m - length_m(i) * along;
        opening_m_s = opening_m_s - (r.stretch_m_n[i] * r.pull_rate[i]) * along -
                      (length_m(i) * r.omega[i]) * left_of(along);
    }
    for (Index i = 1; i <= r.links; ++i) {
        const double share = r.length_m[i] / r.chain_length_m;
        const Vec2 along{r.c[i], r.s[i]};
        const Vec2 across = left_of(along);
        const double turn = share * dot(open_m, across) / length_m(i);
        const Vec2 turned = along + turn * across;
        const double inverse = 1.0 / length(turned.x, turned.y);
        r.turned[i] += turn;
        r.c[i] = inverse * turned.x;
        r.s[i] = inverse * turned.y;
        r.omega[i] += share * dot(opening_m_s, across) / length_m(i);
        r.pull[i] += share * dot(open_m, along) / r.stretch_m_n[i];
        r.pull_rate[i] += share * dot(opening_m_s, along) / r.stretch_m_n[i];
    }
}

RadauChain make_radau_chain(const Chains& chains, const System& system, const Chain& chain,
                            double tolerance) {
    RadauChain r;
    r.stretches = stretches(system);
    r.resize(chain.link_count);
    r.ends_pinned = chain.ends_pinned;
    r.drag_1_s = chains.forces.drag_1_s();
    r.tolerance_m = std::max(kShareOfAnImplicitStep * tolerance, kMinShareOfAnImplicitStep) * chain.length_m;
    r.chain_length_m = chain.length_m;
    for (Index i = 1; i <= r.links; ++i) {
        const Index link = chain.first_link + i - 1;
        r.length_m[i] = chains.length_m[link];
        r.inverse_mass_1_kg[i] = chains.inverse_mass_1_kg[link];
        if (r.stretches) r.stretch_m_n[i] = system.bodies.front().material.compliance_1_n * r.length_m[i];
    }
    return r;
}

}  // namespace

bool ImplicitPart::can_move(const System& system, const Body& body) {
    return moves_as_chains(system, body) && !body.material.is_string && pin_count(system, body) > 0 &&
           system.bends.empty();
}

ImplicitPart::ImplicitPart(const System& system, const Forces& forces, const ExactDef& def)
    : Exact(system, forces, def),
      chains_(cut_at_pins(system, bodies_of(system), forces)),
      origin_m_(at(system.x_m, system.y_m, 0)) {
    for (const Chain& chain : chains_.list) {
        const StepControl control = step_control(chain.inverse_timescale_1_s, def.tolerance);
        pieces_.push_back({chain, control, make_radau_chain(chains_, system, chain, def.tolerance)});
        pieces_.back().radau.step_s = control.first_s;
    }
    if (stretches(system)) {
        dynamics_ = std::make_unique<ElasticDynamics>(system, forces);
        for (Piece& piece : pieces_) start_stretching(piece.radau, chains_, system, piece.chain);
    } else {
        auto rigid = std::make_unique<ChainDynamics>(system, system.bodies, forces);
        for (Piece& piece : pieces_) start_rigid(piece.radau, *rigid, system, piece.chain);
        dynamics_ = std::move(rigid);
    }
    output_ = dynamics_->initial_state();
}

Status ImplicitPart::step(Piece& piece) {
    RadauChain& r = piece.radau;
    double most = std::numeric_limits<double>::infinity();  // no growth after a rejected step
    for (;;) {
        r.step_s = std::min(r.step_s, chains_.next_key_s(piece.chain, r.end_s) - r.end_s);
        if (piece.control.is_too_short(r.step_s, r.end_s) || r.steps == StepControl::kMaxSteps)
            return Status::kDiverged;
        // Time and step agree to the last bit, so that no rounding of times adds up.
        r.step_s = (r.end_s + r.step_s) - r.end_s;
        for (Index k = 0; k < RadauChain::kStages; ++k) {
            const double time_s = r.end_s + radau::kTime[k] * r.step_s;
            r.start_pull_m_s2[k] = chains_.forces_at_start(piece.chain).uniform_at(time_s);
            r.end_pull_m_s2[k] = chains_.forces_at_end(piece.chain).uniform_at(time_s);
        }
        const double factor = try_step(r);
        if (factor > 0.0) {
            accept_step(r);
            if (r.ends_pinned) close(piece);
            measure_joints(r);
            r.step_s = std::min(std::min(factor, most) * r.last_step_s, piece.control.largest_s);
            return Status::kOk;
        }
        r.step_s *= -factor;
        most = 1.0;
        ++r.rejected_steps;
    }
}

/// Brings the end of a step back to its pin.
void ImplicitPart::close(Piece& piece) {
    RadauChain& r = piece.radau;
    if (r.stretches) return close_stretching(r, span_at(chains_, piece.chain, r.end_s));
    double* const c = output_.data() + piece.chain.first_link;  // scratch
    double* const s = c + chains_.link_count();
    double* const omega = s + chains_.link_count();
    std::copy_n(&r.c[1], r.links, c);
    std::copy_n(&r.s[1], r.links, s);
    std::copy_n(&r.omega[1], r.links, omega);
    close_between_pins(chains_, piece.chain, r.end_s, output_.data());
    for (Index i = 1; i <= r.links; ++i)  // small angles
        r.turned[i] += r.c[i] * s[i - 1] - r.s[i] * c[i - 1];
    std::copy_n(c, r.links, &r.c[1]);
    std::copy_n(s, r.links, &r.s[1]);
    std::copy_n(omega, r.links, &r.omega[1]);
}

/// Writes the state of the chain to output_, that of ChainDynamics.
void ImplicitPart::write_rigid(Piece& piece, double time_s) {
    double* const c = output_.data() + piece.chain.first_link;
    const Index stride = chains_.link_count();
    interpolate(piece.radau, time_s, {c, c + stride, c + 2 * stride, nullptr, nullptr});
    if (piece.chain.ends_pinned) close_between_pins(chains_, piece.chain, time_s, output_.data());
}

/// Writes the state of the chain's particles to output_, that of ElasticDynamics.
void ImplicitPart::write_stretching(Piece& piece, double time_s) {
    const RadauChain& r = piece.radau;
    const Chain& chain = piece.chain;
    std::array<std::vector<double>, 5> links;
    for (std::vector<double>& values : links) values.resize(r.links);
    const auto& [c, s, omega_1_s, length_m, growth_m_s] = links;
    interpolate(piece.radau, time_s,
                {links[0].data(), links[1].data(), links[2].data(), links[3].data(), links[4].data()});
    const Chains::Pin& pin = chains_.pins[chain.start_pin];
    std::vector<Span> particles(r.links,
                                {chain.start_m - origin_m_ + pin.displacement(time_s), pin.velocity(time_s)});
    Span end;
    for (Index i = 0; i < r.links; ++i) {
        const Vec2 along{c[i], s[i]};
        end.place_m = end.place_m + length_m[i] * along;
        end.velocity_m_s =
            end.velocity_m_s + growth_m_s[i] * along + (length_m[i] * omega_1_s[i]) * left_of(along);
        particles[i].place_m = particles[i].place_m + end.place_m;
        particles[i].velocity_m_s = particles[i].velocity_m_s + end.velocity_m_s;
    }
    Span open;
    if (chain.ends_pinned) {
        const Span pin_at_end = span_at(chains_, chain, time_s);
        open = {pin_at_end.place_m - end.place_m, pin_at_end.velocity_m_s - end.velocity_m_s};
    }
    const Index count = output_.size() / 4;
    double share = 0.0;
    for (Index i = 0; i < r.links - (chain.ends_pinned ? 1 : 0); ++i) {
        share += r.length_m[i + 1] / r.chain_length_m;
        const std::size_t particle = chain.particle(i);
        output_[particle] = particles[i].place_m.x + share * open.place_m.x;
        output_[count + particle] = particles[i].place_m.y + share * open.place_m.y;
        output_[2 * count + particle] = particles[i].velocity_m_s.x + share * open.velocity_m_s.x;
        output_[3 * count + particle] = particles[i].velocity_m_s.y + share * open.velocity_m_s.y;
    }
}

Status ImplicitPart::reach(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    for (Piece& piece : pieces_) {
        while (piece.radau.end_s < time_s) {
            if (step(piece) == Status::kDiverged) return Status::kDiverged;
        }
        if (piece.radau.steps == 0) continue;
        if (piece.radau.stretches)
            write_stretching(piece, time_s);
        else
            write_rigid(piece, time_s);
    }
    dynamics_->set_time(time_s);
    dynamics_->positions(output_.data(), state);
    return Status::kOk;
}

std::uint64_t ImplicitPart::steps() const {
    std::uint64_t sum = 0;
    for (const Piece& piece : pieces_) sum += piece.radau.steps;
    return sum;
}

std::uint64_t ImplicitPart::rejected_steps() const {
    std::uint64_t sum = 0;
    for (const Piece& piece : pieces_) sum += piece.radau.rejected_steps;
    return sum;
}

}  // namespace corda::sim
