#include "corda/sim/parts.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "corda/core/disjoint_sets.hpp"

namespace corda::sim {
namespace {

/// If links join the particles in a path, puts both into its order, from the end of the smaller index on.
void order_as_path(const System& body, PartOfBody& part) {
    constexpr std::size_t kNone = SIZE_MAX;
    if (part.bars.size() + 1 != part.particles.size()) return;
    std::vector<std::array<std::size_t, 2>> links_at(body.particle_count(), {kNone, kNone});
    for (const std::size_t k : part.bars) {
        if (body.bars[k].reach > 1) return;
        for (const std::uint32_t end : {body.bars[k].a, body.bars[k].b}) {
            auto& links = links_at[end];
            if (links[1] != kNone) return;
            links[links[0] == kNone ? 0 : 1] = k;
        }
    }
    const auto first =
        std::ranges::find_if(part.particles, [&](std::uint32_t i) { return links_at[i][1] == kNone; });
    std::vector<std::uint32_t> particles{*first};
    std::vector<std::size_t> bars;
    while (particles.size() < part.particles.size()) {
        const std::uint32_t here = particles.back();
        const auto& links = links_at[here];
        const std::size_t next = !bars.empty() && links[0] == bars.back() ? links[1] : links[0];
        bars.push_back(next);
        particles.push_back(body.bars[next].a == here ? body.bars[next].b : body.bars[next].a);
    }
    part = {std::move(particles), std::move(bars), true, false};
}

}  // namespace

std::vector<PartOfBody> connected_parts(const System& body) {
    DisjointSets groups(static_cast<std::uint32_t>(body.particle_count()));
    for (std::size_t k = 0; k < body.bars.size(); ++k)
        if (body.has_bar_at(k, body.start_s)) groups.join(body.bars[k].a, body.bars[k].b);
    std::vector<PartOfBody> all(body.particle_count());  // by the name of their group
    for (PartOfBody& part : all) part.is_loose = true;
    for (std::uint32_t i = 0; i < body.particle_count(); ++i) all[groups.of(i)].particles.push_back(i);
    for (std::size_t k = 0; k < body.bars.size(); ++k) {
        if (!body.has_bar_at(k, body.start_s)) continue;
        PartOfBody& part = all[groups.of(body.bars[k].a)];
        part.bars.push_back(k);
        if (!body.is_pinned(body.bars[k].a) || !body.is_pinned(body.bars[k].b)) part.is_loose = false;
    }
    std::vector<PartOfBody> parts;
    PartOfBody loose;
    loose.is_loose = true;
    for (PartOfBody& part : all) {
        if (part.is_loose) {
            loose.particles.insert(loose.particles.end(), part.particles.begin(), part.particles.end());
            loose.bars.insert(loose.bars.end(), part.bars.begin(), part.bars.end());
            continue;
        }
        part.is_chain = body.bodies.front().is_chain;
        order_as_path(body, part);
        parts.push_back(std::move(part));
    }
    std::ranges::sort(loose.bars);
    if (!loose.particles.empty()) parts.push_back(std::move(loose));
    return parts;
}

PartOfBody whole_of(const System& body) {
    PartOfBody whole;
    whole.particles.resize(body.particle_count());
    std::iota(whole.particles.begin(), whole.particles.end(), std::uint32_t{0});
    for (std::size_t k = 0; k < body.bars.size(); ++k)
        if (body.has_bar_at(k, body.start_s)) whole.bars.push_back(k);
    whole.is_chain = body.bodies.front().is_chain && whole.bars.size() == body.bars.size();
    return whole;
}

System system_of(const System& body, const PartOfBody& part) {
    constexpr std::uint32_t kNone = UINT32_MAX;
    System own;
    own.origin_m = body.origin_m;
    own.start_s = body.start_s;
    std::vector<std::uint32_t> place(body.particle_count(), kNone);
    for (const std::uint32_t i : part.particles) {
        place[i] = static_cast<std::uint32_t>(own.x_m.size());
        own.x_m.push_back(body.x_m[i]);
        own.y_m.push_back(body.y_m[i]);
        own.vx_m_s.push_back(body.vx_m_s[i]);
        own.vy_m_s.push_back(body.vy_m_s[i]);
        own.mass_kg.push_back(body.mass_kg[i]);
        own.inverse_mass_1_kg.push_back(body.inverse_mass_1_kg[i]);
    }
    for (const std::size_t k : part.bars) {
        Bar bar = body.bars[k];
        bar.a = place[bar.a];
        bar.b = place[bar.b];
        if (part.is_chain && bar.b < bar.a) std::swap(bar.a, bar.b);
        own.bars.push_back(bar);
    }
    for (Bend bend : body.bends) {
        if (place[bend.b] == kNone || bend.cut_s <= body.start_s || part.is_loose) continue;
        bend.a = place[bend.a];
        bend.b = place[bend.b];
        bend.c = place[bend.c];
        if (part.is_chain && bend.c < bend.a) std::swap(bend.a, bend.c);
        own.bends.push_back(bend);
    }
    if (part.is_chain) std::ranges::sort(own.bends, {}, &Bend::b);
    for (MoveDef move : body.moves) {
        if (place[move.pin] == kNone) continue;
        move.pin = place[move.pin];
        own.moves.push_back(std::move(move));
    }
    Body whole = body.bodies.front();
    whole.particle_count = part.particles.size();
    whole.bar_count = part.bars.size();
    whole.link_count = static_cast<std::size_t>(
        std::ranges::count_if(own.bars, [](const Bar& bar) { return bar.reach == 1; }));
    whole.is_chain = part.is_chain;
    whole.payload_kg = 0.0;
    own.bodies = {whole};
    return own;
}

}  // namespace corda::sim
