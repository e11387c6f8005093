// Augmented vertex block descent: Giles, Diaz and Yuksel, "Augmented Vertex Block Descent", ACM Transactions
// on Graphics 44 (4), 2025. Rigid bars by the augmented Lagrangian with growing stiffness, springs by their
// own stiffness.

#include <algorithm>
#include <cmath>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

class AvbdRun : public SteppedRun {
  public:
    AvbdRun(const Problem& problem, int iterations, double steps)
        : SteppedRun(problem, steps), problem_(problem), system_(problem.system), iterations_(iterations) {
        for (std::size_t i = 0; i < problem.count(); ++i) x_.push_back({system_.x_m[i], system_.y_m[i]});
        before_ = inertial_ = x_;
        v_.resize(x_.size());
        bars_of_.resize(x_.size());
        for (std::size_t k = 0; k < system_.bars.size(); ++k) {
            bars_of_[system_.bars[k].a].push_back(k);
            bars_of_[system_.bars[k].b].push_back(k);
        }
        force_n_.assign(system_.bars.size(), 0.0);
        stiffness_.assign(system_.bars.size(), kLeast);
        offset_m_.assign(system_.bars.size(), 0.0);
    }

    void step() override {
        const double h = step_s_;
        for (std::size_t i = 0; i < x_.size(); ++i) {
            before_[i] = x_[i];
            if (system_.is_pinned(i)) continue;
            inertial_[i] = x_[i] + h * (v_[i] + h * problem_.world.gravity_m_s2);
            x_[i] = inertial_[i];
        }
        for (std::size_t k = 0; k < system_.bars.size(); ++k) {
            offset_m_[k] = is_rigid() ? kAlpha * stretch_m(system_.bars[k], before_) : 0.0;
            force_n_[k] *= kAlpha * kGamma;
            stiffness_[k] = std::max(kGamma * stiffness_[k], kLeast);
        }
        for (int iteration = 0; iteration < iterations_; ++iteration) {
            for (std::size_t i = 0; i < x_.size(); ++i) {
                if (!system_.is_pinned(i)) move(i);
            }
            for (std::size_t k = 0; k < system_.bars.size(); ++k) strengthen(k);
        }
        for (std::size_t i = 0; i < x_.size(); ++i) v_[i] = (1.0 / h) * (x_[i] - before_[i]);
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
    // The paper's parameters; the growth suits constraints in metres and forces in newtons.
    static constexpr double kAlpha = 0.99;
    static constexpr double kGamma = 0.99;
    static constexpr double kGrowth = 1e5;
    static constexpr double kLeast = 1.0;
    static constexpr double kMost = 1e12;

    [[nodiscard]] bool is_rigid() const { return problem_.stiffness_n_m == 0.0; }

    static double stretch_m(const Bar& bar, const std::vector<Vec2>& x) {
        const Vec2 along = x[bar.b] - x[bar.a];
        return sim::length(along.x, along.y) - bar.rest_m;
    }
    [[nodiscard]] double stiffness(std::size_t k) const {
        return is_rigid() ? stiffness_[k] : std::min(stiffness_[k], problem_.stiffness_n_m);
    }
    [[nodiscard]] double pull_n(std::size_t k) const {
        const double pull_n =
            stiffness(k) * (stretch_m(system_.bars[k], x_) - offset_m_[k]) + (is_rigid() ? force_n_[k] : 0.0);
        return problem_.is_string ? std::max(pull_n, 0.0) : pull_n;
    }

    /// Newton's step of one particle, with the second derivative of the bars' lengths as a diagonal.
    void move(std::size_t i) {
        const double inertia = system_.mass_kg[i] / (step_s_ * step_s_);
        Vec2 force = inertia * (inertial_[i] - x_[i]);
        double xx = inertia, xy = 0.0, yy = inertia;
        for (const std::size_t k : bars_of_[i]) {
            const Bar& bar = system_.bars[k];
            const Vec2 along = x_[bar.a == i ? bar.b : bar.a] - x_[i];
            const double length_m = sim::length(along.x, along.y);
            const Vec2 u = (1.0 / length_m) * along;
            const double pull = pull_n(k);
            if (problem_.is_string && pull == 0.0) continue;
            force = force + pull * u;
            const double turn = std::abs(pull) / length_m;
            const double stiff = stiffness(k);
            xx += stiff * u.x * u.x + turn * std::abs(u.y);
            xy += stiff * u.x * u.y;
            yy += stiff * u.y * u.y + turn * std::abs(u.x);
        }
        const double determinant = xx * yy - xy * xy;
        x_[i] = x_[i] + Vec2{(yy * force.x - xy * force.y) / determinant,
                             (xx * force.y - xy * force.x) / determinant};
    }

    void strengthen(std::size_t k) {
        const double wrong_m = stretch_m(system_.bars[k], x_) - offset_m_[k];
        const double pull = pull_n(k);
        if (is_rigid()) force_n_[k] = pull;
        if (!problem_.is_string || pull > 0.0)
            stiffness_[k] = std::min(stiffness_[k] + kGrowth * std::abs(wrong_m), kMost);
    }

    const Problem& problem_;
    const System& system_;
    int iterations_;
    std::vector<Vec2> x_, before_, inertial_, v_;
    std::vector<std::vector<std::size_t>> bars_of_;
    std::vector<double> force_n_, stiffness_, offset_m_;
};

Series series(int iterations) {
    return {std::to_string(iterations) + " iterations", kStepsPerFrame, step_counts(),
            [iterations](const Problem& problem, double steps) {
                return std::make_unique<AvbdRun>(problem, iterations, steps);
            },
            is_flexible};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    return run_peer(argc, argv, "AVBD", "own", {series(4), series(20)});
}
