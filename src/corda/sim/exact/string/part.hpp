#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/exact/exact.hpp"
#include "corda/sim/exact/string/contacts.hpp"
#include "corda/sim/exact/string/events.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// A rope whose rigid links pull and never push. A link is taut, at its rest length, or slack and without
/// force. Between events the taut links move as rigid chains (chains_of_string()). A taut link goes slack
/// when its tension would become negative. A slack link that reaches its rest length snaps: impulses along
/// the links at their rest length stop their ends from separating (StringContacts). Momentum is kept, energy
/// is lost.
///
/// Each step is searched for events when it is taken, and the integration restarts at each event. As in
/// Dop853, nothing depends on the requested times. Memory is allocated at events only.
class StringPart final : public Exact {
  public:
    /// Requires one body, a chain with is_string and without compliance. Throws corda::Refusal if it resists
    /// bending, if a link is longer than its rest length, if it is taut between two pins, or if its start
    /// does not determine which links are taut. `longer_m`: added to the rest length of a link when it first
    /// is slack, to see what its snaps depend on; one entry per link, or none.
    StringPart(const System& system, const Forces& forces, double tolerance,
               std::vector<double> longer_m = {});

    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::uint64_t rejected_steps() const override;

    /// Number of times at which links went slack or snapped.
    [[nodiscard]] std::uint64_t events() const { return events_; }

    /// The rest lengths of its links, with what `longer_m` has added.
    void read_rest_lengths(std::vector<Bar>& bars) const override;

    /// Also the error from which a link that nearly reached its rest length may have snapped.
    [[nodiscard]] double margin_m() const override { return margin_m_; }

  private:
    struct Decision {
        double time_s;
        double margin_m;
    };

    [[nodiscard]] Dynamics& dynamics() const override { return *dynamics_; }
    Status reach(double time_s, State& state) override;
    /// Finds the taut links of string_ and starts the motion there, with a first step of at least
    /// `first_step_s` if the tolerance allows. False if the taut links cannot be found.
    [[nodiscard]] bool start(double first_step_s);
    [[nodiscard]] bool take_step();
    [[nodiscard]] bool pass_event();
    /// Counts an event; false if there are too many in too short a time.
    [[nodiscard]] bool count_event();

    Forces forces_;
    double tolerance_;
    Vec2 offset_m_;                      ///< position of string_ in the system
    System string_;                      ///< the system relative to its first particle, at start_s_
    std::vector<std::uint8_t> is_taut_;  ///< one per link, from start_s_ on
    std::vector<double> longer_m_;       ///< 0 once it is added
    StringContacts contacts_;
    StringEvents finder_;
    std::unique_ptr<ChainDynamics> dynamics_;
    std::unique_ptr<Dop853> integrator_;  ///< its time 0 is start_s_
    double start_s_ = 0.0;
    double known_s_ = 0.0;             ///< until then the motion is that of integrator_
    std::optional<double> event_s_;    ///< if known_s_ is an event: the time of integrator_ there
    State local_;                      ///< positions of string_'s particles there; scratch
    std::vector<Decision> decisions_;  ///< after the requested time
    double margin_m_ = 0.0;
    std::uint64_t events_ = 0;
    std::uint64_t burst_ = 0;  ///< events since burst_s_
    double burst_s_ = 0.0;
    std::uint64_t steps_before_ = 0;  ///< of former integrators
    std::uint64_t rejected_before_ = 0;
};

}  // namespace corda::sim
