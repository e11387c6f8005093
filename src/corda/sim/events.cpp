#include "corda/sim/events.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace corda::sim {
namespace {

/// True if a bar of a rope spans one of its links; both as numbers in the body.
bool spans(const Body& body, const Bar& bar, std::size_t link) {
    const std::size_t first = bar.a - body.first_particle;
    return (link + body.particle_count - first) % body.particle_count < bar.reach;
}

/// The particles that links join to this one.
std::set<std::uint32_t> neighbors(const System& system, const Body& body, std::uint32_t particle) {
    std::set<std::uint32_t> joined;
    for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
        if (system.bars[k].a == particle) joined.insert(system.bars[k].b);
        if (system.bars[k].b == particle) joined.insert(system.bars[k].a);
    }
    return joined;
}

bool is_time(double time_s) {
    return time_s >= 0.0 && std::isfinite(time_s);
}

}  // namespace

bool are_valid(std::span<const ReleaseDef> releases, std::span<const std::uint32_t> pinned) {
    std::set<std::uint32_t> pins;
    return std::ranges::all_of(releases, [&](const ReleaseDef& release) {
        return std::ranges::find(pinned, release.pin) != pinned.end() && pins.insert(release.pin).second &&
               is_time(release.time_s);
    });
}

bool are_valid(std::span<const CutDef> cuts, std::size_t links) {
    std::set<std::uint32_t> cut;
    return std::ranges::all_of(cuts, [&](const CutDef& one) {
        return one.link < links && cut.insert(one.link).second && is_time(one.time_s);
    });
}

void add_cuts(std::span<const CutDef> cuts, const Body& body, System& system) {
    if (!cuts.empty()) system.cut_s.resize(system.bars.size(), kNoEvent);
    for (const auto& [link, time_s] : cuts) {
        system.cut_s[body.first_bar + link] = time_s;
        const std::uint32_t a = system.bars[body.first_bar + link].a;
        const std::uint32_t b = system.bars[body.first_bar + link].b;
        const auto from_a = body.is_net ? neighbors(system, body, a) : std::set<std::uint32_t>{};
        const auto from_b = body.is_net ? neighbors(system, body, b) : std::set<std::uint32_t>{};
        const auto is_past = [&](std::uint32_t one, std::uint32_t other) {
            return (one == a && from_b.contains(other)) || (one == b && from_a.contains(other));
        };
        for (std::size_t k = body.first_bar + body.link_count; k < system.bars.size(); ++k) {
            const Bar& bar = system.bars[k];
            if (body.is_net ? is_past(bar.a, bar.b) || is_past(bar.b, bar.a) : spans(body, bar, link))
                system.cut_s[k] = std::min(system.cut_s[k], time_s);
        }
    }
}

std::vector<double> event_times_s(const System& system) {
    std::set<double> times_s(system.release_s.begin(), system.release_s.end());
    times_s.insert(system.cut_s.begin(), system.cut_s.end());
    times_s.erase(kNoEvent);
    return {times_s.begin(), times_s.end()};
}

std::string events_text(std::span<const RopeDef> ropes, std::span<const NetDef> nets) {
    std::set<double> releases_s;
    std::set<double> cuts_s;
    const auto include = [&](const auto& body) {
        for (const ReleaseDef& release : body.releases) releases_s.insert(release.time_s);
        for (const CutDef& cut : body.cuts) cuts_s.insert(cut.time_s);
    };
    std::ranges::for_each(ropes, include);
    std::ranges::for_each(nets, include);
    std::string text;
    if (!releases_s.empty()) text = fmt::format("pins let go at {:g} s", fmt::join(releases_s, ", "));
    if (!text.empty() && !cuts_s.empty()) text += ", ";
    if (!cuts_s.empty()) text += fmt::format("links cut at {:g} s", fmt::join(cuts_s, ", "));
    return text;
}

System from_event_on(System system, double time_s) {
    for (std::size_t i = 0; i < system.release_s.size(); ++i)
        if (!system.is_pinned_at(i, time_s)) system.inverse_mass_1_kg[i] = 1.0 / system.mass_kg[i];
    std::erase_if(system.moves, [&](const MoveDef& move) { return !system.is_pinned(move.pin); });
    system.start_s = time_s;
    return system;
}

}  // namespace corda::sim
