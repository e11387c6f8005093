#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The checks of a trial: tighter runs in turned coordinates, which round otherwise than the trial's run, and
/// than one another, from the start on. Those of large systems advance in threads of their own; positions are
/// the same either way.
class Checks {
  public:
    static constexpr std::size_t kMost = 3;

    /// `count` of them, 1 to kMost. `goes_on` is asked in the caller's thread alone and must outlive this.
    Checks(const System& system, const Forces& forces, const MethodDef& method, double frame_interval_s,
           std::size_t count, const GoesOn& goes_on);
    Checks(const Checks&) = delete;
    Checks& operator=(const Checks&) = delete;
    /// Ends what start() has begun.
    ~Checks();

    [[nodiscard]] std::size_t size() const { return checks_.size(); }

    /// Begins to advance all to a time; the caller may advance the run meanwhile.
    void start(double time_s);
    /// Waits until they are there. kDiverged also if one has branched. Throws what Solver::advance_to throws.
    [[nodiscard]] Status finish();

    /// How far a run is from its checks: the largest distance of a particle from its positions there, and if
    /// there are several, twice what these differ by. That is rounding; if the run were no better, it could
    /// be near them by chance and far from the truth. Infinite for a NaN.
    [[nodiscard]] double difference_m(const State& state) const;

    /// Of one of them, up to the last finish().
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

  private:
    class Check;

    const GoesOn& goes_on_;
    std::atomic<bool> is_abandoned_ = false;
    GoesOn is_wanted_ = [this] { return !is_abandoned_.load(std::memory_order_relaxed); };
    bool in_threads_;
    double time_s_ = 0.0;
    std::uint64_t steps_ = 0;
    std::vector<std::unique_ptr<Check>> checks_;
    std::vector<std::future<Status>> pending_;  ///< declared last: it ends before what it uses does
};

}  // namespace corda::sim
