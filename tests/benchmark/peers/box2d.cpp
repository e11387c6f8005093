// Box2D: points that rigid or springy distance joints join; a string is a distance joint without a least
// length. Box2D keeps joints to 5 mm, so the problem is scaled to bars of 1 m.

#include <box2d/box2d.h>

#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

class Box2dRun : public SteppedRun {
  public:
    Box2dRun(const Problem& problem, int iterations, double steps)
        : SteppedRun(problem, steps),
          problem_(problem),
          iterations_(iterations),
          scale_(1.0 / problem.system.bars[0].rest_m),
          world_(b2Vec2(0.0F, static_cast<float>(-problem.gravity() * scale_))) {
        const System& system = problem.system;
        for (std::size_t i = 0; i < problem.count(); ++i) {
            b2BodyDef def;
            def.type = system.is_pinned(i) ? b2_staticBody : b2_dynamicBody;
            def.position = scaled(system.x_m[i], system.y_m[i]);
            def.fixedRotation = true;
            def.allowSleep = false;
            b2Body* const body = world_.CreateBody(&def);
            const b2MassData mass{static_cast<float>(system.mass_kg[i]), b2Vec2(0.0F, 0.0F), 0.0F};
            if (!system.is_pinned(i)) body->SetMassData(&mass);
            bodies_.push_back(body);
        }
        for (const Bar& bar : system.bars) add_joint(bar);
    }
    void step() override { world_.Step(static_cast<float>(step_s_), iterations_, iterations_); }
    void read_step(State& state) override {
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            if (problem_.system.is_pinned(i)) continue;
            const b2Vec2 at = bodies_[i]->GetPosition();
            const b2Vec2 velocity = bodies_[i]->GetLinearVelocity();
            state.x_m[i] = static_cast<double>(at.x) / scale_;
            state.y_m[i] = static_cast<double>(at.y) / scale_;
            state.vx_m_s[i] = static_cast<double>(velocity.x) / scale_;
            state.vy_m_s[i] = static_cast<double>(velocity.y) / scale_;
        }
    }

  private:
    [[nodiscard]] b2Vec2 scaled(double x, double y) const {
        return {static_cast<float>(scale_ * x), static_cast<float>(scale_ * y)};
    }
    void add_joint(const Bar& bar) {
        if (problem_.system.is_pinned(bar.a) && problem_.system.is_pinned(bar.b)) return;
        b2DistanceJointDef def;
        def.bodyA = bodies_[bar.a];
        def.bodyB = bodies_[bar.b];
        def.length = def.minLength = def.maxLength = static_cast<float>(scale_ * bar.rest_m);
        if (problem_.is_string) def.minLength = 0.0F;
        if (problem_.stiffness_n_m > 0.0) {
            def.stiffness = static_cast<float>(problem_.stiffness_n_m);
            def.minLength = 0.0F;
            def.maxLength = 100.0F * def.length;
        }
        world_.CreateJoint(&def);
    }

    const Problem& problem_;
    int iterations_;
    double scale_;
    b2World world_;
    std::vector<b2Body*> bodies_;
};

Series series(int iterations) {
    return {std::to_string(iterations) + (iterations == 1 ? " iteration" : " iterations"), kStepsPerFrame,
            step_counts(),
            [iterations](const Problem& problem, double steps) {
                return std::make_unique<Box2dRun>(problem, iterations, steps);
            },
            is_flexible};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const std::string version = std::to_string(b2_version.major) + "." + std::to_string(b2_version.minor) +
                                "." + std::to_string(b2_version.revision);
    return run_peer(argc, argv, "Box2D", version, {series(1), series(8), series(64)});
}
