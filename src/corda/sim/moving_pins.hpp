#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/forces/time_function.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The displacement of a pin from its place at `start_s`, at times counted from there.
[[nodiscard]] TimeFunction displacement_of(const MoveDef& move, double start_s = 0.0);

/// The displacement that all pins of a body have in common; 0 if none moves, empty if they move differently.
[[nodiscard]] std::optional<TimeFunction> common_displacement(const System& body);

/// A pin that moves, and how.
struct MovingPin {
    std::uint32_t particle = 0;
    Vec2 start_m;
    TimeFunction displacement, velocity, acceleration;

    [[nodiscard]] Vec2 place_m(double time_s) const { return start_m + displacement(time_s); }
};

/// The pins of a body that move. Throws corda::Refusal (kUnlikeMoves) if a bar joins two whose distance
/// changes.
[[nodiscard]] std::vector<MovingPin> moving_pins(const System& body);

/// The first key of their paths after `time_s`; infinite if there is none.
[[nodiscard]] double next_key_s(std::span<const MovingPin> pins, double time_s);

using MakeSolver = std::function<std::unique_ptr<Solver>(const System&, const Forces&)>;

/// A solver of a system of one body whose pins move alike or rest. If they move, `make` gets the body in the
/// frame of its pins, where they rest, and the forces there: the uniform acceleration less that of the frame,
/// in the wind of the frame. What it solves is moved back. So any solver follows pins that move.
[[nodiscard]] std::unique_ptr<Solver> solve_in_frame_of_pins(const System& body, const Forces& forces,
                                                             const MethodDef& method, const MakeSolver& make);

}  // namespace corda::sim
