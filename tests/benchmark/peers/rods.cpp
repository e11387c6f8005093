// Discrete elastic rods in the plane, in positions: Bergou and others, "Discrete Elastic Rods" (2008).
// Symplectic Euler steps with the bending forces, then links brought back to their lengths by fast projection
// (Goldenthal and others 2007). The angles of the truth are another formulation of the same energy: for links
// of one length a it is k / (2 a^2) |x_{i+1} - 2 x_i + x_{i-1}|^2.

#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

class RodRun : public SteppedRun {
  public:
    RodRun(const Problem& problem, double steps)
        : SteppedRun(problem, steps), problem_(problem), system_(problem.system) {
        for (std::size_t i = 0; i < problem.count(); ++i) x_.push_back({system_.x_m[i], system_.y_m[i]});
        before_ = x_;
        v_.resize(x_.size());
        links_.resize(x_.size() - 1);
    }

    void step() override {
        const double bend = problem_.bend_n_m / (problem_.link_m() * problem_.link_m());
        if (bend > 0.0) {
            for (std::size_t i = 1; i + 1 < x_.size(); ++i) {
                const Vec2 pull = bend * (x_[i + 1] - 2.0 * x_[i] + x_[i - 1]);
                push(i - 1, -1.0 * pull);
                push(i, 2.0 * pull);
                push(i + 1, -1.0 * pull);
            }
        }
        for (std::size_t i = 1; i < x_.size(); ++i) {
            v_[i] = v_[i] + step_s_ * problem_.world.gravity_m_s2;
            before_[i] = x_[i];
            x_[i] = x_[i] + step_s_ * v_[i];
        }
        for (int iteration = 0; project(); ++iteration) {
            if (iteration == 50) throw Failure("the projection does not converge");
        }
        for (std::size_t i = 1; i < x_.size(); ++i) v_[i] = (1.0 / step_s_) * (x_[i] - before_[i]);
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
    struct Link {
        Vec2 along;
        double diagonal = 0.0;
        double off = 0.0;  ///< to the link before
        double multiplier = 0.0;
    };

    void push(std::size_t i, Vec2 force) { v_[i] = v_[i] + (step_s_ * system_.inverse_mass_1_kg[i]) * force; }

    /// A Newton step on the lengths. False if they were right already.
    bool project() {
        const double rest2 = problem_.link_m() * problem_.link_m();
        double wrong = 0.0;
        for (std::size_t k = 0; k < links_.size(); ++k) {
            Link& link = links_[k];
            link.along = x_[k + 1] - x_[k];
            const double square = dot(link.along, link.along);
            const double near = system_.inverse_mass_1_kg[k];
            link.diagonal = (near + system_.inverse_mass_1_kg[k + 1]) * square;
            link.multiplier = 0.5 * (square - rest2);
            wrong = std::max(wrong, std::abs(link.multiplier));
            if (k == 0) continue;
            link.off = -near * dot(link.along, links_[k - 1].along);
            const double share = link.off / links_[k - 1].diagonal;
            link.diagonal -= share * link.off;
            link.multiplier -= share * links_[k - 1].multiplier;
        }
        if (!(wrong > 1e-13 * rest2)) return false;
        for (std::size_t k = links_.size(); k-- > 0;) {
            Link& link = links_[k];
            if (k + 1 < links_.size()) link.multiplier -= links_[k + 1].off * links_[k + 1].multiplier;
            link.multiplier /= link.diagonal;
        }
        for (std::size_t k = 0; k < links_.size(); ++k) {
            const Vec2 move = links_[k].multiplier * links_[k].along;
            x_[k] = x_[k] + system_.inverse_mass_1_kg[k] * move;
            x_[k + 1] = x_[k + 1] - system_.inverse_mass_1_kg[k + 1] * move;
        }
        return true;
    }

    const Problem& problem_;
    const System& system_;
    std::vector<Vec2> x_, before_, v_;
    std::vector<Link> links_;
};

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const Series rods{
        "symplectic Euler", kStepsPerFrame, step_counts(),
        [](const Problem& problem, double steps) { return std::make_unique<RodRun>(problem, steps); },
        is_chain};
    return run_peer(argc, argv, "Discrete elastic rods", "own", {rods});
}
