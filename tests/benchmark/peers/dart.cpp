// DART: a chain of revolute joints in reduced coordinates, by its own symplectic Euler steps, and by the
// classical Runge-Kutta method on the accelerations that it computes.

#include <dart/config.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

using namespace dart::dynamics;

class DartRun : public SteppedRun {
  public:
    DartRun(const Problem& problem, bool by_rk4, double steps)
        : SteppedRun(problem, steps), problem_(problem), by_rk4_(by_rk4), chain_(Skeleton::create("chain")) {
        chain_->setGravity(Eigen::Vector3d(0, -problem.gravity(), 0));
        chain_->setTimeStep(step_s_);
        const Eigen::Vector3d along(problem.link_m(), 0, 0);
        BodyNode* parent = nullptr;
        for (std::size_t i = 1; i < problem.count(); ++i) {
            RevoluteJoint::Properties joint;
            joint.mName = "joint" + std::to_string(i);
            joint.mAxis = Eigen::Vector3d::UnitZ();
            if (parent != nullptr) joint.mT_ParentBodyToJoint.translation() = along;
            BodyNode::Properties body(BodyNode::AspectProperties("body" + std::to_string(i)));
            body.mInertia.setMass(problem.system.mass_kg[i]);
            body.mInertia.setLocalCOM(along);
            body.mInertia.setMoment(Eigen::Matrix3d::Identity() * 1e-14);
            parent = chain_->createJointAndBodyNodePair<RevoluteJoint>(parent, joint, body).second;
        }
        chain_->setPosition(0, problem.start_angle());
    }
    void step() override {
        // DART's assertions, which Debian keeps, would end the program.
        if (!(chain_->getVelocities().squaredNorm() < kLargest)) throw Failure("diverged");
        if (by_rk4_) {
            rk4_step();
            return;
        }
        find_accelerations();
        chain_->integrateVelocities(step_s_);
        chain_->integratePositions(step_s_);
    }
    void read_step(State& state) override {
        const Eigen::Vector3d tip(problem_.link_m(), 0, 0);
        for (std::size_t i = 0; i + 1 < problem_.count(); ++i) {
            const BodyNode* const body = chain_->getBodyNode(i);
            const Eigen::Vector3d at = body->getTransform() * tip;
            const Eigen::Vector3d velocity = body->getLinearVelocity(tip);
            state.x_m[i + 1] = at.x();
            state.y_m[i + 1] = at.y();
            state.vx_m_s[i + 1] = velocity.x();
            state.vy_m_s[i + 1] = velocity.y();
        }
    }

  private:
    static constexpr double kLargest = 1e12;

    void find_accelerations() {
        if (problem_.bend_n_m > 0.0) {
            Eigen::VectorXd torques = -problem_.bend_n_m * chain_->getPositions().array().sin();
            torques[0] = 0.0;
            chain_->setForces(torques);
        }
        chain_->computeForwardDynamics();
    }
    void rk4_step() {
        const double h = step_s_;
        const Eigen::VectorXd q = chain_->getPositions();
        const Eigen::VectorXd v = chain_->getVelocities();
        Eigen::VectorXd sum_q = Eigen::VectorXd::Zero(q.size());
        Eigen::VectorXd sum_v = sum_q;
        Eigen::VectorXd velocity = v;
        for (const auto& [share, weight] : {std::pair{0.5, 1.0}, {0.5, 2.0}, {1.0, 2.0}, {0.0, 1.0}}) {
            find_accelerations();
            const Eigen::VectorXd acceleration = chain_->getAccelerations();
            sum_q += weight * velocity;
            sum_v += weight * acceleration;
            if (share == 0.0) break;
            chain_->setPositions(q + share * h * velocity);
            velocity = v + share * h * acceleration;
            chain_->setVelocities(velocity);
        }
        chain_->setPositions(q + h / 6.0 * sum_q);
        chain_->setVelocities(v + h / 6.0 * sum_v);
    }

    const Problem& problem_;
    bool by_rk4_;
    SkeletonPtr chain_;
};

Series series(const char* name, bool by_rk4) {
    return {name, kStepsPerFrame, step_counts(),
            [by_rk4](const Problem& problem, double steps) {
                return std::make_unique<DartRun>(problem, by_rk4, steps);
            },
            is_chain};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    return run_peer(argc, argv, "DART", DART_VERSION,
                    {series("symplectic Euler", false), series("RK4 of ours", true)});
}
