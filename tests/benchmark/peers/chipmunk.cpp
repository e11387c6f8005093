// Chipmunk in double precision: points that pin joints, damped springs without damping or a slide joint join.

#include <chipmunk/chipmunk.h>

#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

static_assert(sizeof(cpFloat) == sizeof(double));

class ChipmunkRun : public SteppedRun {
  public:
    ChipmunkRun(const Problem& problem, int iterations, double steps)
        : SteppedRun(problem, steps), problem_(problem), space_(cpSpaceNew()) {
        cpSpaceSetGravity(space_, cpv(0.0, -problem.gravity()));
        cpSpaceSetIterations(space_, iterations);
        const System& system = problem.system;
        for (std::size_t i = 0; i < problem.count(); ++i) {
            const bool is_pinned = system.is_pinned(i);
            cpBody* const body = is_pinned ? cpBodyNewStatic() : cpBodyNew(system.mass_kg[i], INFINITY);
            cpBodySetPosition(body, cpv(system.x_m[i], system.y_m[i]));
            if (!is_pinned) cpSpaceAddBody(space_, body);
            bodies_.push_back(body);
        }
        for (const Bar& bar : system.bars) {
            if (system.is_pinned(bar.a) && system.is_pinned(bar.b)) continue;
            cpConstraint* const joint = make_joint(bar);
            // A tenth of the error is taken back per step.
            cpConstraintSetErrorBias(joint, std::pow(0.9, 1.0 / step_s_));
            joints_.push_back(cpSpaceAddConstraint(space_, joint));
        }
    }
    ~ChipmunkRun() override {
        for (cpConstraint* joint : joints_) {
            cpSpaceRemoveConstraint(space_, joint);
            cpConstraintFree(joint);
        }
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            if (!problem_.system.is_pinned(i)) cpSpaceRemoveBody(space_, bodies_[i]);
            cpBodyFree(bodies_[i]);
        }
        cpSpaceFree(space_);
    }
    void step() override { cpSpaceStep(space_, step_s_); }
    void read_step(State& state) override {
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            if (problem_.system.is_pinned(i)) continue;
            const cpVect at = cpBodyGetPosition(bodies_[i]);
            const cpVect velocity = cpBodyGetVelocity(bodies_[i]);
            state.x_m[i] = at.x;
            state.y_m[i] = at.y;
            state.vx_m_s[i] = velocity.x;
            state.vy_m_s[i] = velocity.y;
        }
    }

  private:
    [[nodiscard]] cpConstraint* make_joint(const Bar& bar) const {
        cpBody* const a = bodies_[bar.a];
        cpBody* const b = bodies_[bar.b];
        if (problem_.is_string) return cpSlideJointNew(a, b, cpvzero, cpvzero, 0.0, bar.rest_m);
        if (problem_.stiffness_n_m > 0.0)
            return cpDampedSpringNew(a, b, cpvzero, cpvzero, bar.rest_m, problem_.stiffness_n_m, 0.0);
        return cpPinJointNew(a, b, cpvzero, cpvzero);
    }

    const Problem& problem_;
    cpSpace* space_;
    std::vector<cpBody*> bodies_;
    std::vector<cpConstraint*> joints_;
};

Series series(int iterations) {
    return {std::to_string(iterations) + (iterations == 1 ? " iteration" : " iterations"), kStepsPerFrame,
            step_counts(),
            [iterations](const Problem& problem, double steps) {
                return std::make_unique<ChipmunkRun>(problem, iterations, steps);
            },
            is_flexible};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    return run_peer(argc, argv, "Chipmunk", cpVersionString, {series(1), series(10), series(100)});
}
