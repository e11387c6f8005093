#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "corda/sim/exact/exact.hpp"
#include "corda/sim/exact/radau_chain.hpp"

namespace corda::sim {

/// A rope whose chains take implicit steps.
class ImplicitPart final : public Exact {
  public:
    /// True for a rope with a pin that does not resist bending and is no string; if it is closed, for one of
    /// rigid links.
    [[nodiscard]] static bool can_move(const System& system, const Body& body);
    /// Requires one body. Throws corda::Refusal for a system that it cannot move, for a rope of rigid links
    /// that is taut between two pins, and for a start at which a link that stretches has no length.
    ImplicitPart(const System& system, const Forces& forces, const ExactDef& def);

    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::uint64_t rejected_steps() const override;

  private:
    /// One of the chains into which pins cut the rope.
    struct Piece {
        Chain chain;
        StepControl control;
        RadauChain radau;
    };

    [[nodiscard]] Dynamics& dynamics() const override { return *dynamics_; }
    Status reach(double time_s, State& state) override;
    Status step(Piece& piece);
    void close(Piece& piece);
    void write_rigid(Piece& piece, double time_s);
    void write_stretching(Piece& piece, double time_s);

    Chains chains_;
    std::unique_ptr<Dynamics> dynamics_;
    std::vector<Piece> pieces_;
    Vec2 origin_m_;  ///< of output_ if links stretch
};

}  // namespace corda::sim
