#pragma once

#include <functional>
#include <span>
#include <string>

#include "support/estimate_judge.hpp"
#include "support/random_system.hpp"

namespace corda::test {

/// Random scenes of one kind.
struct EstimateFamily {
    const char* name;
    std::function<EstimateCase(Random&)> make;

    /// Scene number `n`, the same in every run.
    [[nodiscard]] EstimateCase scene(unsigned n) const;
};

/// Families of scenes for which estimates of method auto are compared with the truth: single ropes of all
/// kinds.
[[nodiscard]] std::span<const EstimateFamily> rope_families();
/// More families: strings, closed ropes, nets, several bodies, and unusual scales, pictures and places.
[[nodiscard]] std::span<const EstimateFamily> other_families();

/// Masses that differ by up to 1e14, and linkages that pass the line of their bars.
[[nodiscard]] std::span<const EstimateFamily> mass_and_linkage_families();

/// Motions that are looked at between frames, in rows that are nearly straight, or by a camera that follows.
[[nodiscard]] std::span<const EstimateFamily> look_families();

/// Pins that move, and wind.
[[nodiscard]] std::span<const EstimateFamily> driven_families();
/// Scenes of the other families in which pins are let go or links are cut.
[[nodiscard]] std::span<const EstimateFamily> event_families();

/// A rope of 1 m from (0, 0) in directions around `angle` from straight down, in radians.
[[nodiscard]] RopeDef crooked_rope(Random& random, int links, double angle, double spread);
/// Removes the pins of a rope and gives it a random velocity and angular velocity.
void throw_it(Random& random, RopeDef& rope);
/// Within -pi .. pi.
[[nodiscard]] double any_angle(Random& random);
[[nodiscard]] double pick_log(Random& random, double least, double most);
/// A scene of that rope with a random size of picture, rate, tolerance and drag.
[[nodiscard]] EstimateCase one_rope(Random& random, RopeDef rope, double duration_s);
/// The same of a net.
[[nodiscard]] EstimateCase one_net(Random& random, NetDef net, double duration_s);
/// Sets size (16 to 4K pixels), frame rate, tolerance and drag at random.
void add_video(Random& random, Scene& scene);

/// A straight rope with rounded points, as in a scene file.
[[nodiscard]] EstimateCase straight_rope(int links, double length_m, double angle_deg,
                                         const std::string& more = "");

}  // namespace corda::test
