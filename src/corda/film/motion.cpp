#include "corda/film/motion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/film/motion_input.hpp"

namespace corda::film {
namespace {

/// More segments would be shorter than a pixel.
constexpr double kMaxPoints = 400.0;

/// A point closer to the end, in frame intervals, gives its segment no direction.
constexpr double kTooClose = 1e-6;

view::TrailPoint trail_point(const State& state, std::size_t i) {
    return {0.0, {state.x_m[i], state.y_m[i]}, {state.vx_m_s[i], state.vy_m_s[i]}};
}

thread_local const SharedMotion::Activity* innermost = nullptr;  ///< of this thread

}  // namespace

std::string divergence_advice(const System& system) {
    constexpr double kUnequal = 1e6;
    double ratio = 1.0;
    for (const Body& body : system.bodies) ratio = std::max(ratio, mass_ratio(system, body));
    return ratio < kUnequal ? "less speed or force"
                            : fmt::format(
                                  "less unequal masses of free particles (they differ by a factor of "
                                  "{:.2g}), less speed or force",
                                  ratio);
}

Motion::Motion(const System& system, const WorldDef& world, std::vector<MethodDef> methods, Timeline timeline,
               std::size_t budget_bytes, std::optional<Quantity> quantity, const StateFields& readings)
    : system_(&system),
      world_(world),
      methods_(std::move(methods)),
      timeline_(std::move(timeline)),
      recording_(system.particle_count(), timeline_.size(), budget_bytes, system.bars.size(), quantity,
                 readings) {
    if (!methods_.empty()) start();
}

Plan Motion::record(const std::function<Plan(const Timeline&, sim::Recording&)>& plan) {
    Plan made = plan(timeline_, recording_);
    for (const BodyPlan& body : made.bodies) methods_.push_back(body.method);
    diverges_ = recording_.size() < timeline_.size();
    return made;
}

void Motion::start() {
    next_ = 0;
    run_.reset();
    run_.emplace(*system_, world_, methods_, timeline_.step_s());
    run_->set_outputs(recording_.fields());
    methods_ = run_->methods();
}

Status Motion::advance_to(double time_s, bool is_new) {
    try {
        return is_new ? recording_.advance(*run_, timeline_, now_s) : run_->advance_to(time_s);
    } catch (...) {
        run_.reset();  // it cannot be used any more; the next call starts again
        throw;
    }
}

bool Motion::step() {
    if (next_ == 0) ++passes_;
    const double time_s = timeline_.time_s(next_);
    const bool is_new = next_ == recording_.size();
    if (advance_to(time_s, is_new) == Status::kDiverged) {
        diverges_ = true;
        run_.reset();
        return false;
    }
    ++next_;
    return true;
}

void Motion::run_to_end() {
    while (recording_.size() < timeline_.size() && !diverges_) {
        if (!run_ || next_ > recording_.size()) start();
        check_cancelled();
        static_cast<void>(step());
    }
}

const State& Motion::at(double time_s) {
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
    if (!run_ || run_->state().time_s > time_s) start();
    while (next_ < timeline_.size() && timeline_.time_s(next_) <= time_s) {
        if (!step()) fail_diverged(time_s);
    }
    if (run_->state().time_s < time_s && advance_to(time_s, false) == Status::kDiverged) {
        run_.reset();
        fail_diverged(time_s);
    }
    figures_ = run_->figures();
    return run_->state();
}

void Motion::keep(std::span<const double> times_s) {
    for (const double time_s : times_s) {
        const auto index = timeline_.find(time_s);
        if (index && recording_.holds(*index)) continue;
        const State& state = at(time_s);
        kept_.try_emplace(time_s, Kept{state, figures_});
    }
}

void Motion::fail_diverged(double time_s) const {
    const double last_s = recording_.size() == 0 ? 0.0 : timeline_.time_s(recording_.size() - 1);
    const bool has_step = std::ranges::any_of(
        methods_, [](const MethodDef& method) { return !std::holds_alternative<ExactDef>(method); });
    throw_error(ExitCode::kDiverged,
                "the simulation diverged before t = {:.6g} s (last good state at {:.6g} s); {} may help{}",
                time_s, last_s, divergence_advice(*system_), has_step ? ", or a smaller solver.step" : "");
}

Energy Motion::energy_of(const State& state) {
    if (state.vx_m_s.empty())
        throw Error(ExitCode::kUsage, "the energy of a state needs FilmDef::readings.velocities");
    if (!meter_) {
        meter_.emplace(*system_, world_, methods_);
        const State start{0.0, system_->x_m, system_->y_m, system_->vx_m_s, system_->vy_m_s};
        weight_at_start_j_ = meter_->of(start).weight_j;
    }
    Energy energy = meter_->of(state);
    energy.weight_j -= weight_at_start_j_;
    return energy;
}

SharedMotion::SharedMotion(const Scene& scene) : system(system_of(scene)), named(named_methods(scene)) {}

SharedMotion::Activity::Activity(const SharedMotion& motion)
    : motion_(&motion), callback_depth_(callback_depth()), outer_(innermost) {
    for (const Activity* other = innermost; other != nullptr; other = other->outer_) {
        if (other->motion_ == motion_ && other->callback_depth_ < callback_depth_) {
            throw Error(
                ExitCode::kUsage,
                "on_progress used the film whose progress it reports; draw and read the film after the "
                "call that reports progress, or make another Film");
        }
    }
    innermost = this;
}

SharedMotion::Activity::~Activity() {
    innermost = outer_;
}

SharedMotion::Use::Use(SharedMotion& motion, const OnProgress& on_progress)
    : activity_(motion), lock_(motion.mutex_), progress_([&] {
          const Motion& whole = *motion.motion;
          report_progress(on_progress, static_cast<std::int64_t>(whole.next()),
                          static_cast<std::int64_t>(whole.timeline().size()));
      }) {}

TrailRecorder::TrailRecorder(std::vector<std::size_t> particles, double trail_s, FrameRate fps)
    : particles_(std::move(particles)),
      trail_s_(trail_s),
      fps_(fps),
      stride_(std::max<std::int64_t>(1, std::llround(std::ceil(trail_s / fps.interval_s() / kMaxPoints)))),
      trails_(particles_.size()) {}

void TrailRecorder::read(Motion& motion, double end_s) {
    if (particles_.empty()) return;
    for (; time_s(points_) <= end_s; ++points_) {
        const State& state = motion.at(time_s(points_));
        for (const std::size_t i : particles_) recorded_.push_back(trail_point(state, i));
    }
}

const std::vector<view::Trail>& TrailRecorder::to(const State& state) {
    std::size_t first = points_;
    while (first > 0 && time_s(first - 1) >= state.time_s - kTooClose * fps_.interval_s()) --first;
    const std::size_t end = first;
    while (first > 0 && state.time_s - time_s(first - 1) < trail_s_) --first;
    for (std::size_t p = 0; p < particles_.size(); ++p) {
        view::Trail& trail = trails_[p];
        trail.clear();
        for (std::size_t k = first; k < end; ++k) {
            trail.push_back(recorded_[k * particles_.size() + p]);
            trail.back().age_s = state.time_s - time_s(k);
        }
        trail.push_back(trail_point(state, particles_[p]));
    }
    return trails_;
}

}  // namespace corda::film
