// XPBD with small steps (xpbd.hpp), and position based dynamics (Mueller and others 2007) with several passes
// per step.

#include "benchmark/peers/xpbd.hpp"

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

class XpbdRun : public SteppedRun {
  public:
    XpbdRun(const Problem& problem, double steps)
        : SteppedRun(problem, steps), problem_(problem), xpbd_(problem.system, problem.world.gravity_m_s2) {}
    void step() override { xpbd_.step(step_s_); }
    void read_step(State& state) override {
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            state.x_m[i] = xpbd_.position_m[i].x;
            state.y_m[i] = xpbd_.position_m[i].y;
            state.vx_m_s[i] = xpbd_.velocity_m_s[i].x;
            state.vy_m_s[i] = xpbd_.velocity_m_s[i].y;
        }
    }

  private:
    const Problem& problem_;
    Xpbd xpbd_;
};

class PbdRun : public SteppedRun {
  public:
    PbdRun(const Problem& problem, int passes, double steps)
        : SteppedRun(problem, steps),
          system_(problem.system),
          gravity_(problem.world.gravity_m_s2),
          passes_(passes) {
        for (std::size_t i = 0; i < problem.count(); ++i) x_.push_back({system_.x_m[i], system_.y_m[i]});
        before_ = x_;
        v_.resize(x_.size());
    }
    void step() override {
        for (std::size_t i = 0; i < x_.size(); ++i) {
            before_[i] = x_[i];
            if (system_.is_pinned(i)) continue;
            v_[i] = v_[i] + step_s_ * gravity_;
            x_[i] = x_[i] + step_s_ * v_[i];
        }
        for (int pass = 0; pass < passes_; ++pass) {
            for (const Bar& bar : system_.bars) project(bar);
        }
        for (std::size_t i = 0; i < x_.size(); ++i) v_[i] = (1.0 / step_s_) * (x_[i] - before_[i]);
    }
    void read_step(State& state) override {
        for (std::size_t i = 0; i < x_.size(); ++i) {
            state.x_m[i] = x_[i].x;
            state.y_m[i] = x_[i].y;
            state.vx_m_s[i] = v_[i].x;
            state.vy_m_s[i] = v_[i].y;
        }
    }

  private:
    void project(const Bar& bar) {
        const double weight_a = system_.inverse_mass_1_kg[bar.a];
        const double weight_b = system_.inverse_mass_1_kg[bar.b];
        const Vec2 along = x_[bar.b] - x_[bar.a];
        const double length_m = sim::length(along.x, along.y);
        if (system_.bodies[0].material.is_string && length_m < bar.rest_m) return;
        const Vec2 move = ((length_m - bar.rest_m) / (length_m * (weight_a + weight_b))) * along;
        x_[bar.a] = x_[bar.a] + weight_a * move;
        x_[bar.b] = x_[bar.b] - weight_b * move;
    }

    const System& system_;
    Vec2 gravity_;
    int passes_;
    std::vector<Vec2> x_, before_, v_;
};

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const Series xpbd{
        "1 pass", kStepsPerFrame, step_counts(),
        [](const Problem& problem, double steps) { return std::make_unique<XpbdRun>(problem, steps); },
        is_flexible};
    const Series pbd{
        "20 passes", kStepsPerFrame, step_counts(),
        [](const Problem& problem, double steps) { return std::make_unique<PbdRun>(problem, 20, steps); },
        [](const Problem& problem) { return is_flexible(problem) && !is_net(problem); }};
    return run_peer(argc, argv, "XPBD", "own", {xpbd}) + run_peer(argc, argv, "PBD", "own", {pbd});
}
