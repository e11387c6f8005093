#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "corda/sim/relaxation/schedule.hpp"

namespace corda::sim {

/// A particle in Verlet's update: x and y of each quantity. One cache line.
struct alignas(64) RelaxationMove {
    std::array<double, 2> move_m{};       ///< Verlet's move in this step, without what the bars add to it
    std::array<double, 2> unrelaxed_m{};  ///< the position before the bars' moves of this step
    std::array<double, 2> last_move_m{};  ///< the whole move of the previous step
    std::array<double, 2> push_m{};       ///< (h^2 / m) f
};

/// State of a relaxation.
struct RelaxationMotion {
    std::vector<double> position_m;     ///< x and y of each particle, interleaved
    std::vector<RelaxationMove> moves;  ///< one per particle
    double keep = 1.0;                  ///< share of the velocity kept per step
};

/// Implementations of the sweeps. Both give the same bits: they do the same correctly rounded operations on
/// each particle in the same order. kScalar takes the bars one by one and waits for the square root and
/// division of each. kAvx2 takes the four bars of a packet at once (RelaxationSchedule), and packets of
/// several sweeps in turn.
enum class RelaxationKernel { kScalar, kAvx2 };

/// The kernels that this CPU can run, the fastest last.
[[nodiscard]] std::span<const RelaxationKernel> relaxation_kernels();

/// Which sweeps to run: `begin` <= k < `end`, counted from the start of a step, `per_step` in each step.
/// Verlet's update of all particles precedes the first sweep of a step.
struct RelaxationSweeps {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
    std::uint64_t per_step = 1;
    bool starts_updated = false;  ///< no update before sweep 0: the particles have been moved already

    [[nodiscard]] bool updates_before(std::uint64_t sweep) const {
        return sweep % per_step == 0 && !(sweep == 0 && starts_updated);
    }
};

/// Sweeps over `bars` in their order and updates all particles, one after the other.
void run_sweeps(std::span<const RelaxationBar> bars, const RelaxationSweeps& sweeps,
                RelaxationMotion& motion);

/// The same for the bars and particles of a schedule, by kAvx2.
void run_sweeps(const RelaxationSchedule& schedule, const RelaxationSweeps& sweeps, RelaxationMotion& motion);

}  // namespace corda::sim
