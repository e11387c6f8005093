#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "corda/sim/relaxation_schedule.hpp"

namespace corda::sim {

/// What moves in a relaxation: x and y of each particle in turn, 2 numbers a particle.
struct RelaxationMotion {
    std::vector<double> position_m;
    std::vector<double> move_m;       ///< Verlet's move in this step, without what the bars add to it
    std::vector<double> unrelaxed_m;  ///< position_m before the bars' moves of this step
    std::vector<double> last_move_m;  ///< the whole move in the step before
    std::vector<double> push_m;       ///< (h^2 / m) f
    double keep = 1.0;                ///< share of the velocity kept a step
};

/// Code that runs passes of a relaxation. All give the same bits: each does the same correctly rounded
/// operations on each particle in the same order.
///
/// kScalar takes the bars one by one in the given order, and waits for each: a bar's square root and division
/// take some 50 cycles, and the next bar of the same reach starts from their result. The others take packets
/// of four bars (RelaxationSchedule), and several passes at once, each `lag` packets behind the one before,
/// so that they wait for little but the divider's throughput.
enum class RelaxationKernel {
    kScalar,
    kSse2,  ///< two bars an instruction; every x86-64 CPU
    kAvx,   ///< four where enough are independent, otherwise two
};

/// The kernels that this CPU can run, the fastest last.
[[nodiscard]] std::span<const RelaxationKernel> relaxation_kernels();

/// Which passes to run: from the start of a step, `count` of them, `sweeps` a step. Verlet's update of all
/// particles precedes the first pass of a step.
struct RelaxationPasses {
    std::uint64_t count = 0;
    std::uint64_t sweeps = 1;
    bool starts_updated = false;  ///< without the update in the first step: the particles have been moved
};

/// Runs passes over `bars` in their order and updates all particles, one thing after the other.
void run_passes(std::span<const RelaxationBar> bars, const RelaxationPasses& passes,
                RelaxationMotion& motion);

/// The same over the bars and particles of a schedule. Requires a kernel that this CPU can run, kScalar
/// excepted.
void run_passes(const RelaxationSchedule& schedule, const RelaxationPasses& passes, RelaxationKernel kernel,
                RelaxationMotion& motion);

}  // namespace corda::sim
