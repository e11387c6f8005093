#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/solver.hpp"

namespace corda::sim {

/// A solver per body: bodies do not act on each other.
class BodySolvers final : public Solver {
  public:
    struct Part {
        std::size_t first_particle = 0;
        std::size_t first_bar = 0;
        std::unique_ptr<Solver> solver;
        State state;  ///< of its particles and bars
    };

    /// `parts`: one per body, in order.
    explicit BodySolvers(std::vector<Part> parts);

    Status advance_to(double time_s, State& state, StopCheck& stop) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] bool has_branched() const override;
    [[nodiscard]] std::optional<Loads> loads() const override;
    void velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) override;
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override;
    /// The sum over all bodies.
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::vector<MethodDef> methods() const override;

  private:
    std::vector<Part> parts_;
};

}  // namespace corda::sim
