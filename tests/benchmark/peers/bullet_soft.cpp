// Bullet's deformable world in double precision: points that mass-spring forces join; and its soft
// body, whose links are kept by position based passes.

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

/// The nodes and links of a problem as a soft body, which belongs to the caller.
btSoftBody* soft_body(const Problem& problem, btSoftBodyWorldInfo& info, int passes) {
    const System& system = problem.system;
    btAlignedObjectArray<btVector3> points;
    btAlignedObjectArray<btScalar> masses;
    for (std::size_t i = 0; i < problem.count(); ++i) {
        points.push_back(btVector3(system.x_m[i], system.y_m[i], 0));
        masses.push_back(system.is_pinned(i) ? 0.0 : system.mass_kg[i]);
    }
    auto* const body = new btSoftBody(&info, points.size(), &points[0], &masses[0]);
    body->m_materials[0]->m_kLST = 1.0;
    for (const Bar& bar : system.bars) {
        if (!system.is_pinned(bar.a) || !system.is_pinned(bar.b))
            body->appendLink(static_cast<int>(bar.a), static_cast<int>(bar.b), body->m_materials[0]);
    }
    body->m_cfg.kDP = 0.0;
    body->m_cfg.kDG = 0.0;
    body->m_cfg.drag = 0.0;
    body->m_cfg.piterations = passes;
    body->m_cfg.collisions = 0;
    body->m_sleepingThreshold = 0;
    body->setSelfCollision(false);
    return body;
}

class SoftRun : public SteppedRun {
  public:
    SoftRun(const Problem& problem, int passes, double steps)
        : SteppedRun(problem, steps), problem_(problem), dispatcher_(&configuration_) {
        const btVector3 gravity(0, -problem.gravity(), 0);
        if (is_net(problem)) {
            auto* const bodies = new btDeformableBodySolver();
            bodies_ = std::unique_ptr<btSoftBodySolver>(bodies);
            auto solver = std::make_unique<btDeformableMultiBodyConstraintSolver>();
            solver->setDeformableSolver(bodies);
            auto world = std::make_unique<btDeformableMultiBodyDynamicsWorld>(
                &dispatcher_, &broadphase_, solver.get(), &configuration_, bodies);
            solver_ = std::move(solver);
            // By its implicit steps, points that only springs hold do not move at all.
            world->setImplicit(false);
            prepare(*world, gravity, passes);
            springs_ = std::make_unique<btDeformableMassSpringForce>(problem.stiffness_n_m, 0.0, true);
            weight_ = std::make_unique<btDeformableGravityForce>(gravity);
            world->addForce(body_.get(), springs_.get());
            world->addForce(body_.get(), weight_.get());
            world_ = std::move(world);
        } else {
            solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
            auto world = std::make_unique<btSoftRigidDynamicsWorld>(
                &dispatcher_, &broadphase_, static_cast<btSequentialImpulseConstraintSolver*>(solver_.get()),
                &configuration_);
            prepare(*world, gravity, passes);
            world_ = std::move(world);
        }
    }
    ~SoftRun() override { world_->removeCollisionObject(body_.get()); }
    void step() override { world_->stepSimulation(step_s_, 0); }
    void read_step(State& state) override {
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            const btSoftBody::Node& node = body_->m_nodes[static_cast<int>(i)];
            state.x_m[i] = node.m_x.x();
            state.y_m[i] = node.m_x.y();
            state.vx_m_s[i] = node.m_v.x();
            state.vy_m_s[i] = node.m_v.y();
        }
    }

  private:
    template <class World>
    void prepare(World& world, const btVector3& gravity, int passes) {
        world.setGravity(gravity);
        world.getWorldInfo().m_gravity = gravity;
        world.getWorldInfo().air_density = 0.0;
        world.getWorldInfo().m_maxDisplacement = 1e9;
        world.getWorldInfo().m_sparsesdf.Initialize();
        body_ = std::unique_ptr<btSoftBody>(soft_body(problem_, world.getWorldInfo(), passes));
        world.addSoftBody(body_.get());
    }

    const Problem& problem_;
    btSoftBodyRigidBodyCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    std::unique_ptr<btSoftBodySolver> bodies_;
    std::unique_ptr<btConstraintSolver> solver_;
    std::unique_ptr<btDeformableLagrangianForce> springs_, weight_;
    std::unique_ptr<btSoftBody> body_;
    std::unique_ptr<btDynamicsWorld> world_;
};

Series series(const char* name, int passes, bool (*can_run)(const Problem&)) {
    return {name, kStepsPerFrame, step_counts(),
            [passes](const Problem& problem, double steps) {
                return std::make_unique<SoftRun>(problem, passes, steps);
            },
            can_run};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const int version = btGetVersion();
    return run_peer(argc, argv, "Bullet soft body",
                    std::to_string(version / 100) + "." + std::to_string(version % 100),
                    {series("20 passes", 20, is_flexible_chain), series("mass-spring forces", 1, is_net)});
}
