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

/// Implementations of the sweeps. All kernels give the same bits: they do the same correctly rounded
/// operations on each particle in the same order.
///
/// kScalar takes the bars one by one and waits for the square root and division of each. kSse2 takes two bars
/// of a packet at once (RelaxationSchedule), and several sweeps, each `lag` packets behind its predecessor.
/// kAvx2 takes four bars at once, and begins the packet of one sweep before it finishes that of another;
/// where these would leave it without work, it runs packets of bars of overlapping sweeps.
enum class RelaxationKernel { kScalar, kSse2, kAvx2 };

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

/// The same for the bars and particles of a schedule, by a kernel of this CPU other than kScalar.
void run_sweeps(const RelaxationSchedule& schedule, const RelaxationSweeps& sweeps, RelaxationKernel kernel,
                RelaxationMotion& motion);

}  // namespace corda::sim
