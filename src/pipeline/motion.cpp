#include "corda/pipeline/motion.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/clock.hpp"

namespace corda::pipeline {

Motion::Motion(const System& system, const WorldDef& world, std::vector<MethodDef> methods, Timeline timeline,
               std::size_t budget_bytes, const OnProgress& on_progress, std::optional<Quantity> quantity,
               const StateFields& readings)
    : system_(&system),
      world_(world),
      methods_(std::move(methods)),
      timeline_(std::move(timeline)),
      recording_(system.particle_count(), timeline_.size(), budget_bytes, system.bars.size(), quantity,
                 readings) {
    if (!methods_.empty()) start(on_progress);
}

Plan Motion::record(const std::function<Plan(const Timeline&, sim::Recording&)>& plan) {
    Plan made = plan(timeline_, recording_);
    for (const BodyPlan& body : made.bodies) methods_.push_back(body.method);
    diverges_ = recording_.size() < timeline_.size();
    return made;
}

void Motion::start(const OnProgress& on_progress) {
    next_ = 0;
    run_.reset();
    run_.emplace(*system_, world_, methods_, timeline_.fps().interval_s(), asking(on_progress));
    run_->set_outputs(recording_.readings());
    methods_ = run_->methods();
}

GoesOn Motion::asking(const OnProgress& on_progress) const {
    return [this, &on_progress] {
        report_progress(on_progress, static_cast<std::int64_t>(next_),
                        static_cast<std::int64_t>(timeline_.size()));
        return true;
    };
}

Status Motion::advance_to(double time_s, bool is_new, const OnProgress& on_progress) {
    const GoesOn goes_on = asking(on_progress);
    try {
        return is_new ? recording_.advance(*run_, timeline_, now_s, goes_on)
                      : run_->advance_to(time_s, goes_on);
    } catch (...) {
        run_.reset();  // it must not be used further; the next that is asked for starts anew
        throw;
    }
}

bool Motion::step(const OnProgress& on_progress) {
    if (next_ == 0) ++passes_;
    const double time_s = timeline_.time_s(next_);
    const bool is_new = next_ == recording_.size();
    if (advance_to(time_s, is_new, on_progress) == Status::kDiverged) {
        diverges_ = true;
        run_.reset();
        return false;
    }
    ++next_;
    return true;
}

void Motion::run_to_end(const OnProgress& on_progress) {
    const auto total = static_cast<std::int64_t>(timeline_.size());
    while (recording_.size() < timeline_.size() && !diverges_) {
        if (!run_ || next_ > recording_.size()) start(on_progress);
        report_progress(on_progress, static_cast<std::int64_t>(next_), total);
        static_cast<void>(step(on_progress));
    }
}

const State& Motion::at(double time_s, const OnProgress& on_progress) {
    const auto index = timeline_.find(time_s);
    if (index && recording_.holds(*index)) {
        recording_.read(*index, state_);
        figures_ = recording_.figures(*index);
        return state_;
    }
    if (const auto kept = kept_.find(time_s); kept != kept_.end()) {
        figures_ = kept->second.figures;
        return kept->second.state;
    }
    if (index && diverges_ && *index >= recording_.size()) fail_diverged(time_s);
    if (!run_ || run_->state().time_s > time_s) start(on_progress);
    while (next_ < timeline_.size() && timeline_.time_s(next_) <= time_s) {
        if (!step(on_progress)) fail_diverged(time_s);
    }
    if (run_->state().time_s < time_s && advance_to(time_s, false, on_progress) == Status::kDiverged) {
        run_.reset();
        fail_diverged(time_s);
    }
    figures_ = run_->figures();
    return run_->state();
}

void Motion::keep(std::span<const double> times_s, const OnProgress& on_progress) {
    for (const double time_s : times_s) {
        const auto index = timeline_.find(time_s);
        if (index && recording_.holds(*index)) continue;
        const State& state = at(time_s, on_progress);
        kept_.try_emplace(time_s, Kept{state, figures_});
    }
}

void Motion::fail_diverged(double time_s) const {
    const double last_s = recording_.size() == 0 ? 0.0 : timeline_.time_s(recording_.size() - 1);
    const bool has_step = std::any_of(methods_.begin(), methods_.end(), [](const MethodDef& method) {
        return !std::holds_alternative<ExactDef>(method);
    });
    throw Error(ExitCode::kDiverged,
                fmt::format("the simulation diverged before t = {:.6g} s (last good state at {:.6g} s); less "
                            "speed or force may help{}",
                            time_s, last_s, has_step ? ", or a smaller solver.step" : ""));
}

}  // namespace corda::pipeline
