// ODE: points that distance joints join, by its direct solver and by its iterative one; the springs of a net
// are distance joints of that stiffness; a string is a contact without bounce while the bob is as far away as
// its length.

#include <ode/ode.h>

#include <array>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

class OdeRun : public SteppedRun {
  public:
    /// `iterations` of the iterative solver; 0: the direct one.
    OdeRun(const Problem& problem, int iterations, double steps)
        : SteppedRun(problem, steps), problem_(problem), iterations_(iterations), world_(dWorldCreate()) {
        dWorldSetGravity(world_, 0.0, -problem.gravity(), 0.0);
        dWorldSetERP(world_, 0.2);
        dWorldSetCFM(world_, 0.0);
        if (iterations > 0) dWorldSetQuickStepNumIterations(world_, iterations);
        const System& system = problem.system;
        for (std::size_t i = 0; i < problem.count(); ++i) {
            bodies_.push_back(nullptr);
            if (system.is_pinned(i)) continue;
            dBodyID const body = bodies_.back() = dBodyCreate(world_);
            dBodySetPosition(body, system.x_m[i], system.y_m[i], 0.0);
            dMass mass;
            dMassSetSphereTotal(&mass, system.mass_kg[i], 0.01 * system.bars[0].rest_m);
            dBodySetMass(body, &mass);
            dBodySetGyroscopicMode(body, 0);
        }
        contacts_ = dJointGroupCreate(0);
        if (problem.is_string) return;
        for (const Bar& bar : system.bars) add_joint(bar);
    }
    ~OdeRun() override {
        dJointGroupDestroy(contacts_);
        dWorldDestroy(world_);
    }
    void step() override {
        if (problem_.is_string) add_contact();
        if (iterations_ > 0) {
            dWorldQuickStep(world_, step_s_);
        } else {
            dWorldStep(world_, step_s_);
        }
        if (problem_.is_string) dJointGroupEmpty(contacts_);
    }
    void read_step(State& state) override {
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            if (bodies_[i] == nullptr) continue;
            const dReal* const at = dBodyGetPosition(bodies_[i]);
            const dReal* const velocity = dBodyGetLinearVel(bodies_[i]);
            state.x_m[i] = at[0];
            state.y_m[i] = at[1];
            state.vx_m_s[i] = velocity[0];
            state.vy_m_s[i] = velocity[1];
        }
    }

  private:
    void add_joint(const Bar& bar) {
        const System& system = problem_.system;
        if (bodies_[bar.a] == nullptr && bodies_[bar.b] == nullptr) return;
        dJointID const joint = dJointCreateDBall(world_, nullptr);
        dJointAttach(joint, bodies_[bar.a], bodies_[bar.b]);
        dJointSetDBallAnchor1(joint, system.x_m[bar.a], system.y_m[bar.a], 0.0);
        dJointSetDBallAnchor2(joint, system.x_m[bar.b], system.y_m[bar.b], 0.0);
        dJointSetDBallDistance(joint, bar.rest_m);
        if (problem_.stiffness_n_m == 0.0) return;
        // ODE's manual: ERP = h k / (h k + d), CFM = 1 / (h k + d) are a spring k with a damper d.
        dJointSetDBallParam(joint, dParamERP, 1.0);
        dJointSetDBallParam(joint, dParamCFM, 1.0 / (step_s_ * problem_.stiffness_n_m));
    }
    void add_contact() {
        const dReal* const at = dBodyGetPosition(bodies_[1]);
        const double length_m = sim::length(at[0], at[1]);
        const double depth_m = length_m - problem_.system.bars[0].rest_m;
        if (depth_m < 0.0) return;
        dContact contact{};
        contact.geom.pos[0] = at[0];
        contact.geom.pos[1] = at[1];
        contact.geom.normal[0] = -at[0] / length_m;
        contact.geom.normal[1] = -at[1] / length_m;
        contact.geom.depth = depth_m;
        dJointAttach(dJointCreateContact(world_, contacts_, &contact), bodies_[1], nullptr);
    }

    const Problem& problem_;
    int iterations_;
    dWorldID world_;
    dJointGroupID contacts_ = nullptr;
    std::vector<dBodyID> bodies_;
};

Series series(const char* name, int iterations) {
    return {name, kStepsPerFrame, step_counts(),
            [iterations](const Problem& problem, double steps) {
                return std::make_unique<OdeRun>(problem, iterations, steps);
            },
            [iterations](const Problem& problem) {
                return is_flexible(problem) && (iterations > 0 || !is_net(problem));
            }};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    return run_peer(argc, argv, "ODE", ODE_VERSION,
                    {series("direct", 0), series("20 iterations", 20), series("200 iterations", 200)});
}
