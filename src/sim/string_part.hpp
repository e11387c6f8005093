#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/dop853.hpp"
#include "corda/sim/exact_part.hpp"
#include "corda/sim/string_contacts.hpp"
#include "corda/sim/string_dynamics.hpp"
#include "corda/sim/string_events.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// A rope whose rigid links pull and never push. A link is taut, as long as at rest, or slack and without
/// force. From one event to the next the taut ones move as rigid chains (StringDynamics). A taut link goes
/// slack where its tension would turn negative; a slack one that gets to its length at rest snaps: impulses
/// along the links at their rest length take away what separates them (StringContacts). Momentum is kept,
/// energy is lost.
///
/// Events are searched for in every step when it is taken, and the motion starts anew from each: as in
/// Dop853, nothing depends on the times that are asked for. Memory is allocated at events alone.
class StringPart final : public ExactPart {
  public:
    /// Of a chain of `system` with is_string and without compliance. Throws corda::Error where it resists
    /// bending, where a link is longer than at rest, and where it is taut between two pins.
    StringPart(const System& system, const Body& body, const WorldDef& world, double tolerance);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] double energy_scale_j() const override { return dynamics_->energy_scale_j(); }
    /// Snaps take energy.
    [[nodiscard]] bool conserves_energy() const override { return false; }
    /// Slack links carry nothing.
    [[nodiscard]] Loads loads() const override { return dynamics_->loads(output_.data()); }
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::uint64_t rejected_steps() const override;

    /// Times at which links went slack or snapped.
    [[nodiscard]] std::uint64_t events() const { return events_; }

  private:
    /// Finds out which links are taut in string_ and starts the motion there, the first step no shorter than
    /// `first_step_s` where the tolerance allows.
    [[nodiscard]] bool start(double first_step_s);
    [[nodiscard]] bool take_step();
    [[nodiscard]] bool pass_event();
    /// Counts an event; false where there are too many in too short a time.
    [[nodiscard]] bool count_event();

    WorldDef world_;
    double tolerance_;
    Vec2 offset_m_;                      ///< of string_ in the system
    std::size_t first_particle_;         ///< in the system
    System string_;                      ///< the body alone, relative to its first particle; at start_s_
    std::vector<std::uint8_t> is_taut_;  ///< one a link, from start_s_ on
    StringContacts contacts_;
    StringEvents finder_;
    std::unique_ptr<StringDynamics> dynamics_;
    std::unique_ptr<Dop853> integrator_;  ///< its time 0 is start_s_
    double start_s_ = 0.0;
    double known_s_ = 0.0;           ///< from start_s_ to here, the motion is that of integrator_
    std::optional<double> event_s_;  ///< known_s_ is an event, at this time of integrator_
    std::vector<double> output_;     ///< state at the last time asked for
    State local_;                    ///< positions of string_'s particles there; scratch
    std::uint64_t events_ = 0;
    std::uint64_t burst_ = 0;  ///< events since burst_s_
    double burst_s_ = 0.0;
    std::uint64_t steps_before_ = 0;  ///< of former integrators
    std::uint64_t rejected_before_ = 0;
};

}  // namespace corda::sim
