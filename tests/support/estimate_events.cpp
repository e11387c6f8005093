#include <algorithm>
#include <array>
#include <vector>

#include "support/estimate_families.hpp"

namespace corda::test {
namespace {

/// A scene of any other family whose truth is computed.
EstimateCase any_scene(Random& random) {
    std::vector<EstimateFamily> all;
    for (const auto families :
         {rope_families(), other_families(), mass_and_linkage_families(), look_families(), driven_families()})
        all.insert(all.end(), families.begin(), families.end());
    for (;;) {
        const auto family = static_cast<std::size_t>(pick(random, 0, static_cast<int>(all.size()) - 1));
        EstimateCase made = all[family].make(random);
        if (!made.truth) return made;
    }
}

/// A time of a scene, now and then its start or that of a frame.
double event_s(Random& random, const Scene& scene) {
    const double time_s = pick_real(random, 0.0, 0.8) * scene.world.duration_s;
    if (pick(random, 0, 9) == 0) return 0.0;
    if (pick(random, 0, 3) != 0) return time_s;
    const FrameRate rate = scene.video.scene_rate();
    return rate.time_s(rate.last_frame_within(time_s));
}

template <class Body>
void add_releases(Random& random, const Scene& scene, Body& body) {
    for (const std::uint32_t pin : body.pinned)
        if (pick(random, 0, 1) == 0) body.releases.push_back({pin, event_s(random, scene)});
}

/// One to three, now and then at one time.
template <class Body>
void add_cuts(Random& random, const Scene& scene, std::size_t links, Body& body) {
    const int most = pick(random, 1, 3);
    const double together_s = event_s(random, scene);
    const bool are_together = pick(random, 0, 2) == 0;
    for (int k = 0; k < most; ++k) {
        const auto link = static_cast<std::uint32_t>(pick(random, 0, static_cast<int>(links) - 1));
        if (std::ranges::find(body.cuts, link, &CutDef::link) == body.cuts.end())
            body.cuts.push_back({link, are_together ? together_s : event_s(random, scene)});
    }
}

void add_cuts(Random& random, Scene& scene) {
    for (RopeDef& rope : scene.ropes) {
        add_cuts(random, scene, rope.closed ? rope.points_m.size() : rope.points_m.size() - 1, rope);
        if (rope.closed) rope.cuts.resize(1);
    }
    for (NetDef& net : scene.nets) add_cuts(random, scene, net.bars.size(), net);
}

void add_releases(Random& random, Scene& scene) {
    for (RopeDef& rope : scene.ropes) add_releases(random, scene, rope);
    for (NetDef& net : scene.nets) add_releases(random, scene, net);
}

bool has_releases(const Scene& scene) {
    const auto has = [](const auto& body) { return !body.releases.empty(); };
    return std::ranges::any_of(scene.ropes, has) || std::ranges::any_of(scene.nets, has);
}

EstimateCase release(Random& random) {
    for (;;) {
        EstimateCase made = any_scene(random);
        add_releases(random, made.scene);
        if (has_releases(made.scene)) return made;
    }
}

EstimateCase cut(Random& random) {
    EstimateCase made = any_scene(random);
    add_cuts(random, made.scene);
    return made;
}

EstimateCase release_and_cut(Random& random) {
    EstimateCase made = release(random);
    add_cuts(random, made.scene);
    return made;
}

}  // namespace

std::span<const EstimateFamily> event_families() {
    static const auto families = std::to_array<EstimateFamily>(
        {{"release", release}, {"cut", cut}, {"release_and_cut", release_and_cut}});
    return families;
}

}  // namespace corda::test
