// Bullet's multibody: a chain of hinges in reduced coordinates by Featherstone's algorithm, in double
// precision, by symplectic Euler and by its fourth-order Runge-Kutta.

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

class BulletRun : public SteppedRun {
  public:
    BulletRun(const Problem& problem, bool by_rk4, double steps)
        : SteppedRun(problem, steps),
          problem_(problem),
          dispatcher_(&configuration_),
          world_(&dispatcher_, &broadphase_, &solver_, &configuration_),
          links_(static_cast<int>(problem.count()) - 1),
          body_(links_, 0.0, btVector3(0, 0, 0), true, false) {
        world_.setGravity(btVector3(0, -problem.gravity(), 0));
        const double link_m = problem.link_m();
        for (int i = 0; i < links_; ++i) {
            const double mass = problem.system.mass_kg[static_cast<std::size_t>(i) + 1];
            // The link's centre is its far end.
            body_.setupRevolute(i, mass, btVector3(0, 0, 0), i - 1, btQuaternion::getIdentity(),
                                btVector3(0, 0, 1), btVector3(0, 0, 0), btVector3(link_m, 0, 0), true);
        }
        body_.finalizeMultiDof();
        body_.setCanSleep(false);
        body_.setLinearDamping(0.0);
        body_.setAngularDamping(0.0);
        body_.setHasSelfCollision(false);
        body_.setMaxCoordinateVelocity(1e9);
        body_.useRK4Integration(by_rk4);
        body_.setJointPos(0, problem.start_angle());
        world_.addMultiBody(&body_);
    }
    ~BulletRun() override { world_.removeMultiBody(&body_); }
    void step() override {
        // Its Runge-Kutta method takes the torques as constant over the step.
        for (int i = 1; problem_.bend_n_m > 0.0 && i < links_; ++i)
            body_.addJointTorque(i, -problem_.bend_n_m * std::sin(body_.getJointPos(i)));
        world_.stepSimulation(step_s_, 0);
    }
    void read_step(State& state) override {
        const double link_m = problem_.link_m();
        double angle = 0.0;
        double omega = 0.0;
        for (int i = 0; i < links_; ++i) {
            const auto k = static_cast<std::size_t>(i);
            angle += body_.getJointPos(i);
            omega += body_.getJointVel(i);
            const double c = link_m * std::cos(angle);
            const double s = link_m * std::sin(angle);
            state.x_m[k + 1] = state.x_m[k] + c;
            state.y_m[k + 1] = state.y_m[k] + s;
            state.vx_m_s[k + 1] = state.vx_m_s[k] - omega * s;
            state.vy_m_s[k + 1] = state.vy_m_s[k] + omega * c;
        }
    }

  private:
    const Problem& problem_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    btMultiBodyDynamicsWorld world_;
    int links_;
    btMultiBody body_;
};

Series series(const char* name, bool by_rk4) {
    return {name, kStepsPerFrame, step_counts(),
            [by_rk4](const Problem& problem, double steps) {
                return std::make_unique<BulletRun>(problem, by_rk4, steps);
            },
            is_chain};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const int version = btGetVersion();
    return run_peer(argc, argv, "Bullet multibody",
                    std::to_string(version / 100) + "." + std::to_string(version % 100),
                    {series("symplectic Euler", false), series("RK4", true)});
}
