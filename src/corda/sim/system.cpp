#include "corda/sim/system.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/events.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/moving_pins.hpp"

namespace corda {
namespace {

using sim::is_finite;

using sim::kNoEvent;

constexpr const char* kBadCuts = "cuts names no link, one twice or a time before 0 s";

[[noreturn]] void fail(const std::string& what, const std::string& problem) {
    throw Refusal(Refusal::Reason::kDefinition, what + ": " + problem);
}

void require(bool holds, const std::string& what, const char* problem) {
    if (!holds) fail(what, problem);
}

bool is_positive(double value) {
    return value > 0.0 && std::isfinite(value);
}

void check_moves(const std::vector<MoveDef>& moves, const std::vector<std::uint32_t>& pinned,
                 const std::string& what) {
    const auto has_order = [](const PathKeyDef& a, const PathKeyDef& b) { return a.time_s < b.time_s; };
    std::set<std::uint32_t> pins;
    for (const MoveDef& move : moves) {
        require(std::ranges::find(pinned, move.pin) != pinned.end(), what, "moves names no pinned particle");
        require(pins.insert(move.pin).second, what, "moves names a pin twice");
        for (const WaveDef& wave : move.waves)
            if (const char* const problem = sim::problem_of(wave)) fail(what, problem);
        for (const PathKeyDef& key : move.path)
            require(is_finite(key.by_m) && key.time_s >= 0.0 && std::isfinite(key.time_s), what,
                    "a key of a path is not finite or before 0 s");
        require(std::ranges::adjacent_find(move.path, std::not_fn(has_order)) == move.path.end(), what,
                "the times of a path do not increase");
        require(move.path.empty() || move.path.front().by_m == Vec2{}, what,
                "a path starts at another place");
    }
}

/// Checks the fields common to ropes and nets.
template <class BodyDef>
void check_body(const BodyDef& def, const std::string& what) {
    const std::size_t count = def.points_m.size();
    require(count >= 2, what, "points_m has fewer than 2 points");
    require(is_finite(def.origin_m), what, "origin_m is not finite");
    require(std::ranges::all_of(def.points_m, is_finite), what, "points_m has a point that is not finite");
    require(def.mass_kg.empty() || def.mass_kg.size() == count, what,
            "mass_kg needs one value per particle, or none");
    require(std::ranges::all_of(def.mass_kg, is_positive), what, "mass_kg has a value that is not > 0");
    require(def.velocity_m_s.empty() || def.velocity_m_s.size() == count, what,
            "velocity_m_s needs one value per particle, or none");
    require(std::ranges::all_of(def.velocity_m_s, is_finite), what,
            "velocity_m_s has a value that is not finite");
    for (const std::uint32_t index : def.pinned)
        if (index >= count)
            fail(what, "pinned names particle " + std::to_string(index) + " of " + std::to_string(count));
    require(sim::are_valid(def.releases, def.pinned), what,
            "releases names no pin, one twice or a time before 0 s");
    check_moves(def.moves, def.pinned, what);
    const double compliance = def.material.compliance_1_n;
    require(compliance >= 0.0 && std::isfinite(compliance), what, "material.compliance_1_n is not >= 0");
}

void check(const RopeDef& rope, const std::string& what) {
    check_body(rope, what);
    const std::size_t count = rope.points_m.size();
    require(rope.reach >= 1, what, "reach is not >= 1");
    require(!rope.closed || count >= 3, what, "closed needs at least 3 points");
    require(rope.payload_kg >= 0.0 && std::isfinite(rope.payload_kg), what, "payload_kg is not >= 0");
    require(rope.bending_n_m2 >= 0.0 && std::isfinite(rope.bending_n_m2), what, "bending_n_m2 is not >= 0");
    const std::size_t links = rope.closed ? count : count - 1;
    require(rope.rest_m.empty() || rope.rest_m.size() == links, what,
            "rest_m needs one value per link, or none");
    require(std::ranges::all_of(rope.rest_m, is_positive), what, "rest_m has a value that is not > 0");
    require(sim::are_valid(rope.cuts, links), what, kBadCuts);
    require(!rope.closed || rope.cuts.size() <= 1, what, "cuts has more than one link of a closed rope");
}

void check(const NetDef& net, const std::string& what) {
    check_body(net, what);
    const std::size_t count = net.points_m.size();
    bool imaginary_ones_follow = false;
    for (const NetBar& bar : net.bars) {
        if (bar.a >= count || bar.b >= count || bar.a == bar.b)
            fail(what, "the bar (" + std::to_string(bar.a) + ", " + std::to_string(bar.b) +
                           ") does not join two particles");
        require(!(bar.is_real && imaginary_ones_follow), what, "bars has a real bar behind an imaginary one");
        imaginary_ones_follow = imaginary_ones_follow || !bar.is_real;
    }
    const auto links = static_cast<std::size_t>(std::ranges::count_if(net.bars, &NetBar::is_real));
    require(sim::are_valid(net.cuts, links), what, kBadCuts);
}

/// Appends the data common to ropes and nets: origin, particles and pins.
template <class BodyDef>
Body append_particles(const BodyDef& def, System& system) {
    const Vec2 offset = def.origin_m - system.origin_m;
    const std::size_t first = system.particle_count();
    const std::size_t count = def.points_m.size();
    for (std::size_t i = 0; i < count; ++i) {
        system.x_m.push_back(offset.x + def.points_m[i].x);
        system.y_m.push_back(offset.y + def.points_m[i].y);
        const Vec2 velocity_m_s = def.velocity_m_s.empty() ? Vec2{} : def.velocity_m_s[i];
        system.vx_m_s.push_back(velocity_m_s.x);
        system.vy_m_s.push_back(velocity_m_s.y);
        system.mass_kg.push_back(def.mass_kg.empty() ? 1.0 : def.mass_kg[i]);
    }
    if constexpr (requires { def.payload_kg; }) system.mass_kg.back() += def.payload_kg;
    for (std::size_t i = first; i < first + count; ++i)
        system.inverse_mass_1_kg.push_back(1.0 / system.mass_kg[i]);
    for (const std::uint32_t index : def.pinned) {
        system.inverse_mass_1_kg[first + index] = 0.0;
        system.vx_m_s[first + index] = 0.0;
        system.vy_m_s[first + index] = 0.0;
    }
    for (MoveDef move : def.moves) {
        move.pin += static_cast<std::uint32_t>(first);
        const Vec2 velocity_m_s = sim::displacement_of(move).derivative()(0.0);
        system.vx_m_s[move.pin] = velocity_m_s.x;
        system.vy_m_s[move.pin] = velocity_m_s.y;
        system.moves.push_back(std::move(move));
    }
    for (const auto& [pin, time_s] : def.releases) {
        system.release_s.resize(first + count, kNoEvent);
        system.release_s[first + pin] = time_s;
    }
    Body body;
    body.first_particle = first;
    body.particle_count = count;
    body.first_bar = system.bars.size();
    body.material = def.material;
    return body;
}

/// Uses the body's own coordinates, so that its place in the scene does not change the bits.
template <class BodyDef>
double distance_m(const BodyDef& def, std::size_t a, std::size_t b) {
    const Vec2 along = def.points_m[b] - def.points_m[a];
    return sim::length(along.x, along.y);
}

/// How many bars of a reach a rope has; 0 if it is too short for them.
std::size_t bars_of_reach(std::size_t particles, std::size_t reach, bool closed) {
    if (!closed) return particles > reach ? particles - reach : 0;
    if (2 * reach == particles) return reach;
    return 2 * reach < particles ? particles : 0;
}

void append_bars(const RopeDef& rope, Body& body, System& system) {
    const auto reach = static_cast<std::size_t>(rope.reach);
    const std::size_t count = rope.points_m.size();
    const auto particle = [&](std::size_t i) {
        return static_cast<std::uint32_t>(body.first_particle + i % count);
    };
    for (std::size_t stride = 1; stride <= std::min(reach, count - 1); ++stride) {
        for (std::size_t i = 0; i < bars_of_reach(count, stride, rope.closed); ++i) {
            const double rest_m = stride == 1 && !rope.rest_m.empty()
                                      ? rope.rest_m[i]
                                      : distance_m(rope, i, (i + stride) % count);
            system.bars.push_back(
                {particle(i), particle(i + stride), static_cast<std::uint32_t>(stride), rest_m});
        }
    }
    body.bar_count = system.bars.size() - body.first_bar;
    body.link_count = bars_of_reach(count, 1, rope.closed);
    body.is_chain = !rope.closed;
    body.payload_kg = rope.payload_kg;
}

void append_bends(const RopeDef& rope, const Body& body, System& system) {
    if (rope.bending_n_m2 == 0.0) return;
    const Bar* const links = system.bars.data() + body.first_bar;
    const std::size_t corners = rope.closed ? body.link_count : body.link_count - 1;
    for (std::size_t k = 0; k < corners; ++k) {
        const Bar& before = links[k];
        const Bar& after = links[(k + 1) % body.link_count];
        system.bends.push_back(
            {before.a, before.b, after.b, rope.bending_n_m2 / (0.5 * (before.rest_m + after.rest_m))});
        for (const auto& [link, time_s] : rope.cuts)
            if (link == k || link == (k + 1) % body.link_count)
                system.bends.back().cut_s = std::min(system.bends.back().cut_s, time_s);
    }
}

void append(const RopeDef& def, System& system) {
    const std::optional<RopeDef> pulled = pulled_in(def);
    const RopeDef& rope = pulled ? *pulled : def;
    Body body = append_particles(rope, system);
    append_bars(rope, body, system);
    sim::add_cuts(rope.cuts, body, system);
    append_bends(rope, body, system);
    system.bodies.push_back(body);
}

void append(const NetDef& net, System& system) {
    Body body = append_particles(net, system);
    for (const NetBar& bar : net.bars) {
        system.bars.push_back({static_cast<std::uint32_t>(body.first_particle + bar.a),
                               static_cast<std::uint32_t>(body.first_particle + bar.b), bar.is_real ? 1U : 2U,
                               distance_m(net, bar.a, bar.b)});
        if (bar.is_real) ++body.link_count;
        ++body.bar_count;
    }
    body.is_chain = false;
    body.is_net = true;
    sim::add_cuts(net.cuts, body, system);
    system.bodies.push_back(body);
}

/// Copies `count` entries from `first` on; of an empty vector none.
template <class T>
std::vector<T> slice(const std::vector<T>& all, std::size_t first, std::size_t count) {
    if (all.empty()) return {};
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

/// The body without its bends.
System alone(const System& system, const Body& body) {
    const std::size_t first = body.first_particle;
    const std::size_t count = body.particle_count;
    System part;
    part.origin_m = system.origin_m;
    part.x_m = slice(system.x_m, first, count);
    part.y_m = slice(system.y_m, first, count);
    part.vx_m_s = slice(system.vx_m_s, first, count);
    part.vy_m_s = slice(system.vy_m_s, first, count);
    part.mass_kg = slice(system.mass_kg, first, count);
    part.inverse_mass_1_kg = slice(system.inverse_mass_1_kg, first, count);
    part.bars = slice(system.bars, body.first_bar, body.bar_count);
    const auto shift = static_cast<std::uint32_t>(first);
    for (Bar& bar : part.bars) {
        bar.a -= shift;
        bar.b -= shift;
    }
    for (MoveDef move : system.moves) {
        if (move.pin < first || move.pin >= first + count) continue;
        move.pin -= shift;
        part.moves.push_back(std::move(move));
    }
    // Those of other bodies are none of its own.
    part.release_s = slice(system.release_s, first, count);
    part.cut_s = slice(system.cut_s, body.first_bar, body.bar_count);
    const auto is_never = [](double time_s) { return time_s == kNoEvent; };
    if (std::ranges::all_of(part.release_s, is_never)) part.release_s.clear();
    if (std::ranges::all_of(part.cut_s, is_never)) part.cut_s.clear();
    part.bodies = {body};
    part.bodies.front().first_particle = 0;
    part.bodies.front().first_bar = 0;
    return part;
}

}  // namespace

LinkRange links_between_pins(const RopeDef& rope) {
    if (rope.closed) return {0, rope.points_m.size()};
    if (rope.pinned.empty()) return {};
    const auto [first, last] = std::ranges::minmax_element(rope.pinned);
    return {*first, *last};
}

std::optional<RopeDef> pulled_in(const RopeDef& given) {
    if (given.rest_m.empty() || !given.material.is_string || given.material.compliance_1_n > 0.0)
        return std::nullopt;
    const LinkRange fixed = links_between_pins(given);
    const std::size_t links = given.rest_m.size();
    std::vector<Vec2> lack_m(links);
    bool lacks = false;
    for (std::size_t k = 0; k < links; ++k) {
        if (fixed.contains(k)) continue;
        const double distance = distance_m(given, k, k + 1);
        if (given.rest_m[k] >= distance) continue;
        lack_m[k] = (1.0 - given.rest_m[k] / distance) * (given.points_m[k + 1] - given.points_m[k]);
        lacks = true;
    }
    if (!lacks) return std::nullopt;
    RopeDef rope = given;
    Vec2 shift_m;
    for (std::size_t k = fixed.begin; k < links; ++k) {
        shift_m = shift_m - lack_m[k];
        rope.points_m[k + 1] = rope.points_m[k + 1] + shift_m;
    }
    shift_m = {};
    for (std::size_t k = fixed.begin; k-- > 0;) {
        shift_m = shift_m + lack_m[k];
        rope.points_m[k] = rope.points_m[k] + shift_m;
    }
    // Rounding must not leave a link longer than it can be.
    for (std::size_t k = 0; k < links; ++k) {
        if (!fixed.contains(k)) rope.rest_m[k] = std::max(rope.rest_m[k], distance_m(rope, k, k + 1));
    }
    return rope;
}

std::size_t System::link_count() const {
    std::size_t count = 0;
    for (const Body& body : bodies) count += body.link_count;
    return count;
}

double links_length_m(const System& system, const Body& body) {
    double length_m = 0.0;
    for (std::size_t i = 0; i < body.link_count; ++i) length_m += system.bars[body.first_bar + i].rest_m;
    return length_m;
}

double largest_length_m(const System& system) {
    double longest_m = 0.0;
    for (const Body& body : system.bodies) longest_m = std::max(longest_m, links_length_m(system, body));
    return longest_m;
}

double mass_ratio(const System& system, const Body& body) {
    double lightest_1_kg = 0.0;
    double heaviest_1_kg = HUGE_VAL;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
        if (system.is_pinned(i)) continue;
        lightest_1_kg = std::max(lightest_1_kg, system.inverse_mass_1_kg[i]);
        heaviest_1_kg = std::min(heaviest_1_kg, system.inverse_mass_1_kg[i]);
    }
    return std::max(1.0, lightest_1_kg / heaviest_1_kg);
}

std::size_t rope_count(const System& system) {
    const auto first_net =
        std::ranges::partition_point(system.bodies, [](const Body& body) { return !body.is_net; });
    return static_cast<std::size_t>(first_net - system.bodies.begin());
}

std::size_t body_of(const System& system, std::size_t particle) {
    const auto after = std::ranges::partition_point(
        system.bodies, [particle](const Body& body) { return body.first_particle <= particle; });
    return static_cast<std::size_t>(after - system.bodies.begin()) - 1;
}

std::string body_name(const System& system, std::size_t body) {
    if (!system.bodies[body].label.empty()) return system.bodies[body].label;
    const std::size_t ropes = rope_count(system);
    return body < ropes ? "rope " + std::to_string(body) : "net " + std::to_string(body - ropes);
}

std::vector<std::string> body_keys(const System& system) {
    std::vector<std::string> keys;
    std::set<std::string> taken;
    std::map<std::string, int> repeats;
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        std::string name = body_name(system, b);
        std::ranges::replace(name, ' ', '_');
        std::string key = name;
        while (!taken.insert(key).second) key = name + "_" + std::to_string(++repeats[name] + 1);
        keys.push_back(key);
    }
    return keys;
}

std::vector<Bar> rigid_bars(const System& system) {
    std::vector<Bar> rigid;
    for (const Body& body : system.bodies) {
        if (body.material.compliance_1_n > 0.0) continue;
        const auto first = system.bars.begin() + static_cast<std::ptrdiff_t>(body.first_bar);
        rigid.insert(rigid.end(), first, first + static_cast<std::ptrdiff_t>(body.bar_count));
    }
    return rigid;
}

std::uint64_t bar_count(std::uint64_t particles, std::uint64_t reach, bool closed) {
    if (particles == 0) return 0;
    if (closed) {
        const bool has_opposite = particles % 2 == 0 && reach >= particles / 2;
        return std::min(reach, (particles - 1) / 2) * particles + (has_opposite ? particles / 2 : 0);
    }
    const std::uint64_t longest = std::min(reach, particles - 1);
    return longest * particles - longest * (longest + 1) / 2;
}

System build_system(std::span<const RopeDef> ropes, std::span<const NetDef> nets) {
    if (ropes.empty() && nets.empty()) fail("scene", "there is neither a rope nor a net");
    for (std::size_t i = 0; i < ropes.size(); ++i) check(ropes[i], "rope " + std::to_string(i));
    for (std::size_t i = 0; i < nets.size(); ++i) check(nets[i], "net " + std::to_string(i));
    System system;
    system.origin_m = ropes.empty() ? nets.front().origin_m : ropes.front().origin_m;
    for (const RopeDef& rope : ropes) append(rope, system);
    for (const NetDef& net : nets) append(net, system);
    if (!system.release_s.empty()) system.release_s.resize(system.particle_count(), kNoEvent);
    if (!system.cut_s.empty()) system.cut_s.resize(system.bars.size(), kNoEvent);
    return system;
}

}  // namespace corda

namespace corda::sim {

std::size_t pin_count(const System& system, const Body& body) {
    const auto first = system.inverse_mass_1_kg.begin() + static_cast<std::ptrdiff_t>(body.first_particle);
    return static_cast<std::size_t>(
        std::count(first, first + static_cast<std::ptrdiff_t>(body.particle_count), 0.0));
}

bool moves_as_chains(const System& system, const Body& body) {
    constexpr std::size_t kMaxOfNet = 4;  // links of a closed rope of which two can be parallel for good
    if (body.is_chain || body.is_net) return body.is_chain;
    if (body.material.is_string || body.material.compliance_1_n > 0.0 || !system.bends.empty()) return false;
    return body.link_count > kMaxOfNet && body.bar_count == body.link_count && pin_count(system, body) > 0;
}

void for_each_body(const System& system, const std::function<void(const System&, std::size_t)>& use) {
    auto bend = system.bends.begin();  // in the order of bodies, as bars are
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        System part = alone(system, body);
        const auto shift = static_cast<std::uint32_t>(body.first_particle);
        for (; bend != system.bends.end() && bend->b < body.first_particle + body.particle_count; ++bend)
            part.bends.push_back(
                {bend->a - shift, bend->b - shift, bend->c - shift, bend->stiffness_n_m, bend->cut_s});
        try {
            use(part, i);
        } catch (const Refusal& refused) {
            if (system.bodies.size() == 1) throw;
            throw Refusal(refused.reason(), body_name(system, i) + ": " + refused.what());
        }
    }
}

}  // namespace corda::sim
