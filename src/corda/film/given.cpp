#include "corda/film/given.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/sim/recording.hpp"

namespace corda {

void give_motion(Scene& scene, GivenMotion motion) {
    scene.given = std::make_shared<const GivenMotion>(std::move(motion));
    if (!scene.has_duration && scene.world.duration_s == WorldDef{}.duration_s)
        scene.world.duration_s = scene.given->end_s();
}

void film::validate_given(const Scene& scene) {
    constexpr double kRounding = 1e-6;  // of the time from frame to frame: of times that are sums
    const GivenMotion& given = *scene.given;
    const auto fail = [&](std::string what, std::string remedy) {
        throw Error(ExitCode::kUsage,
                    Problem{{.source = given.source(), .key = {}}, std::move(what), std::move(remedy)});
    };
    std::size_t particles = 0;
    for (const RopeDef& rope : scene.ropes) particles += rope.points_m.size();
    for (const NetDef& net : scene.nets) particles += net.points_m.size();
    if (given.particle_count() != particles)
        fail(fmt::format("positions of {}, and the scene has {}",
                         counted(static_cast<std::int64_t>(given.particle_count()), "particle"), particles),
             "give one position per particle, ropes before nets, or change the ropes of the scene");
    const FrameRate rate = scene.video.scene_rate();
    const double last_s = rate.time_s(rate.frame_count(scene.world.duration_s) - 1);
    if (last_s > given.end_s() + kRounding * rate.interval_s())
        fail(fmt::format("the positions end at {} s, before the last frame at {:.6g} s of a film of {} s",
                         given.end_s(), last_s, scene.world.duration_s),
             fmt::format("give world.duration = {} (--duration {}), or positions up to there", given.end_s(),
                         given.end_s()));
    const bool colors = scene.style.color_by == ColorBy::kTension;
    if (!colors && scene.style.arrows != Arrows::kTension) return;
    Place place = scene.tensions_place;
    if (place.key.empty()) place.key = colors ? "style.color_by" : "style.arrows";
    throw Error(ExitCode::kInvalidScene,
                Problem{place, "tensions are not known where positions are given",
                        colors ? "give \"speed\" or \"strain\"" : "give \"velocity\" or \"weight\""});
}

void film::start_as_given(const GivenMotion& given, System& system) {
    State start = given.at(0.0);
    system.origin_m = {};
    system.x_m = std::move(start.x_m);
    system.y_m = std::move(start.y_m);
    system.vx_m_s.assign(system.particle_count(), 0.0);
    system.vy_m_s = system.vx_m_s;
    system.moves.clear();
    for (std::uint32_t i = 0; i < system.particle_count(); ++i) {
        const double until_s =
            system.release_s.empty() ? std::numeric_limits<double>::infinity() : system.release_s[i];
        if (system.is_pinned(i) && given.moves_before(until_s, i)) system.moves.emplace_back().pin = i;
    }
}

State film::given_state(const GivenMotion& given, double time_s, const System& system,
                        const StateFields& fields) {
    State state = given.at(time_s);
    if (!fields.velocities) {
        state.vx_m_s.clear();
        state.vy_m_s.clear();
    }
    if (fields.tensions) state.tension_n.assign(system.bars.size(), std::numeric_limits<double>::quiet_NaN());
    return state;
}

Figures film::given_figures(const System& system, const State& state) {
    return {.strain = sim::max_strain(system, state),
            .energy_error = {},
            .loads = {},
            .energy_change_j = std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace corda
