// Method `rattle` on nets whose bars depend on each other, held against rigid bodies and smaller systems, and
// on nets whose cells pass through a line, held against a formulation in directions.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "corda/film/film.hpp"
#include "support/extended_motion.hpp"
#include "support/nets.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// A unit square let go by one corner, with one diagonal or both.
NetDef square(bool both) {
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {0.0, -1.0}, {1.0, -1.0}};
    net.bars = {{0, 1}, {0, 2}, {1, 3}, {2, 3}, {0, 3}};
    if (both) net.bars.push_back({1, 2});
    net.pinned = {0};
    return net;
}

TEST(DependentBars, ASquareWithTwoDiagonalsMovesAsWithOne) {
    test::SolverRun<Rattle> run(square(true), WorldDef{}, RattleDef{8, 1.0 / 240.0});
    const NetDef one = square(false);
    test::ExtendedMotion truth(build_system({}, {&one, 1}), WorldDef{});
    double error_m = 0.0;
    for (int k = 1; k <= 20; ++k) {
        ASSERT_TRUE(run.go(0.1 * k) && truth.advance_to(0.1 * k));
        for (std::size_t i = 0; i < 4; ++i) {
            error_m = std::max(error_m, static_cast<double>(std::hypot(run.state().x_m[i] - truth.x_m(i),
                                                                       run.state().y_m[i] - truth.y_m(i))));
        }
    }
    std::printf("square: %.1e m, strain %.1e\n", error_m, run.strain());
    EXPECT_LT(error_m, 1e-11);
    EXPECT_LT(run.strain(), 1e-14);
    EXPECT_FALSE(run.loads().has_value());
}

/// The angle by which a body that hangs from the origin has turned: that of a pendulum of the same length.
double turned_by(const System& body, double time_s) {
    double mass_kg = 0.0;
    double inertia_kg_m2 = 0.0;
    Vec2 moment_kg_m;
    for (std::size_t i = 0; i < body.particle_count(); ++i) {
        const Vec2 at{body.x_m[i], body.y_m[i]};
        mass_kg += body.mass_kg[i];
        moment_kg_m = moment_kg_m + body.mass_kg[i] * at;
        inertia_kg_m2 += body.mass_kg[i] * dot(at, at);
    }
    RopeDef pendulum;
    pendulum.points_m = {{0.0, 0.0}, (inertia_kg_m2 / dot(moment_kg_m, moment_kg_m)) * moment_kg_m};
    test::ExtendedMotion motion(build_system({&pendulum, 1}), WorldDef{});
    EXPECT_TRUE(motion.advance_to(time_s));
    return static_cast<double>(std::atan2(motion.y_m(1), motion.x_m(1))) -
           std::atan2(moment_kg_m.y, moment_kg_m.x);
}

/// Checks that a net with diagonals, pinned at a corner, swings as a rigid body for a second.
void expect_to_swing_as_a_plate(std::uint32_t columns, std::uint32_t rows, double step_s) {
    NetDef net = test::leaning_net(columns, rows, 0.1, true);
    net.pinned = {0};
    for (std::size_t i = 0; i < net.mass_kg.size(); ++i)
        net.mass_kg[i] = 1.0 + 0.1 * static_cast<double>(i % 7);
    test::SolverRun<Rattle> run(net, WorldDef{}, RattleDef{6, step_s});
    ASSERT_TRUE(run.go(1.0, 10));
    const double angle = turned_by(run.system(), 1.0);
    double error_m = 0.0;
    for (std::size_t i = 0; i < net.points_m.size(); ++i) {
        const Vec2 p = net.points_m[i];
        const Vec2 expected = std::cos(angle) * p + std::sin(angle) * left_of(p);
        error_m =
            std::max(error_m, std::hypot(run.state().x_m[i] - expected.x, run.state().y_m[i] - expected.y));
    }
    std::printf("plate: turned by %.3f, %.1e m, strain %.1e\n", angle, error_m, run.strain());
    EXPECT_LT(error_m, 1e-9);  // 9e-16, 1e-12 m
    EXPECT_LT(run.strain(), 1e-12);
}

TEST(DependentBars, ANetWithDiagonalsSwingsAsARigidBody) {
    expect_to_swing_as_a_plate(8, 6, 1.0 / 600.0);
    expect_to_swing_as_a_plate(33, 24, 1.0 / 120.0);
}

TEST(DependentBars, LargePlatesTakeStepsOfAPendulum) {
    // The tensions in the bars of a plate are large, and say nothing of how fast it moves.
    NetDef net = test::leaning_net(40, 30, 0.1, true);
    net.pinned = {0};
    const Rattle solver(build_system({}, {&net, 1}), Forces(WorldDef{}), RattleDef{}, 1.0 / 60.0);
    EXPECT_EQ(solver.step_s(), 1.0 / 60.0);
}

TEST(DependentBars, AFreeNetKeepsItsMomentum) {
    NetDef net = test::leaning_net(5, 4, 0.1, true);
    net.pinned = {};
    Vec2 sum_kg_m_s;
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < net.mass_kg.size(); ++i) {
        net.mass_kg[i] = 0.1 + 0.3 * static_cast<double>(i % 5);
        const auto order = static_cast<double>(i);
        net.velocity_m_s[i] = {std::sin(3.0 * order), std::cos(5.0 * order)};
        sum_kg_m_s = sum_kg_m_s + net.mass_kg[i] * net.velocity_m_s[i];
        mass_kg += net.mass_kg[i];
    }
    test::SolverRun<Rattle> run(net, WorldDef{}, RattleDef{});
    ASSERT_TRUE(run.go(1.0));
    Vec2 moved_kg_m;
    for (std::size_t i = 0; i < net.mass_kg.size(); ++i) {
        moved_kg_m = moved_kg_m + net.mass_kg[i] * Vec2{run.state().x_m[i] - run.system().x_m[i],
                                                        run.state().y_m[i] - run.system().y_m[i]};
    }
    const Vec2 off = (1.0 / mass_kg) * (moved_kg_m - sum_kg_m_s) + Vec2{0.0, 0.5 * 9.81};
    std::printf("free net: centre off by %.1e, %.1e m, strain %.1e\n", off.x, off.y, run.strain());
    EXPECT_LT(std::hypot(off.x, off.y), 1e-13);
    EXPECT_LT(run.strain(), 1e-13);
}

TEST(DependentBars, ANetHeldByTwoCornersStaysWhereItIs) {
    NetDef net = test::cloth(8, 6, 0.1);
    net.velocity_m_s.assign(net.points_m.size(), {1.0, 2.0});
    test::SolverRun<Rattle> run(net, WorldDef{}, RattleDef{4});
    ASSERT_TRUE(run.go(0.5, 5));
    EXPECT_LT(run.moved_m(), 1e-14);
    EXPECT_FALSE(run.loads().has_value());
}

/// A grid of `size` x `size` unit masses without diagonals, let go by a corner at the origin. Its cells stay
/// rhombi: the columns' and the rows' directions are all there is, and a cell that passes through a line is
/// nothing special to them.
class Rhombi {
  public:
    Rhombi(int size, double spacing_m) : size_(size), spacing_m_(spacing_m) {
        angle_.setZero(2 * (size - 1));
        angle_.tail(size - 1).setConstant(-0.5 * std::numbers::pi);
        turn_1_s_.setZero(2 * (size - 1));
    }

    void advance_to(double time_s) {
        constexpr double kStepSeconds = 1e-4;
        const int steps = static_cast<int>(std::ceil((time_s - time_s_) / kStepSeconds - 1e-6));
        const double h = (time_s - time_s_) / std::max(steps, 1);
        for (int k = 0; k < steps; ++k) {  // Runge-Kutta of order 4
            const Eigen::VectorXd a1 = acceleration(angle_, turn_1_s_);
            const Eigen::VectorXd w2 = turn_1_s_ + 0.5 * h * a1;
            const Eigen::VectorXd a2 = acceleration(angle_ + 0.5 * h * turn_1_s_, w2);
            const Eigen::VectorXd w3 = turn_1_s_ + 0.5 * h * a2;
            const Eigen::VectorXd a3 = acceleration(angle_ + 0.5 * h * w2, w3);
            const Eigen::VectorXd w4 = turn_1_s_ + h * a3;
            const Eigen::VectorXd a4 = acceleration(angle_ + h * w3, w4);
            angle_ += h / 6.0 * (turn_1_s_ + 2.0 * w2 + 2.0 * w3 + w4);
            turn_1_s_ += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
        time_s_ = time_s;
    }

    /// Row by row from the pin.
    [[nodiscard]] Vec2 position_m(std::size_t particle) const {
        Vec2 at;
        for (const int k : directions(particle))
            at = at + spacing_m_ * Vec2{std::cos(angle_[k]), std::sin(angle_[k])};
        return at;
    }

  private:
    /// The angles on the way from the pin to a particle.
    [[nodiscard]] std::vector<int> directions(std::size_t particle) const {
        std::vector<int> on_the_way;
        const int place = static_cast<int>(particle);
        for (int k = 0; k < place % size_; ++k) on_the_way.push_back(k);
        for (int k = 0; k < place / size_; ++k) on_the_way.push_back(size_ - 1 + k);
        return on_the_way;
    }

    /// By Lagrange's equations, for unit masses.
    [[nodiscard]] Eigen::VectorXd acceleration(const Eigen::VectorXd& angle,
                                               const Eigen::VectorXd& turn_1_s) const {
        Eigen::MatrixXd inertia = Eigen::MatrixXd::Zero(angle.size(), angle.size());
        Eigen::VectorXd force = Eigen::VectorXd::Zero(angle.size());
        for (std::size_t i = 0; i < static_cast<std::size_t>(size_ * size_); ++i) {
            const std::vector<int> way = directions(i);
            Vec2 pull{0.0, -9.81};
            for (const int k : way) {
                pull = pull +
                       spacing_m_ * turn_1_s[k] * turn_1_s[k] * Vec2{std::cos(angle[k]), std::sin(angle[k])};
            }
            for (const int k : way) {
                const Vec2 across = spacing_m_ * Vec2{-std::sin(angle[k]), std::cos(angle[k])};
                force[k] += dot(across, pull);
                for (const int l : way)
                    inertia(k, l) += spacing_m_ * spacing_m_ * std::cos(angle[k] - angle[l]);
            }
        }
        return inertia.ldlt().solve(force);
    }

    int size_;
    double spacing_m_;
    double time_s_ = 0.0;
    Eigen::VectorXd angle_;  ///< of the columns' gaps, then of the rows'
    Eigen::VectorXd turn_1_s_;
};

Scene grid_scene(int size, double spacing_m, double duration_s) {
    const std::string count = std::to_string(size);
    return parse_scene("schema = 1\n[world]\nduration = " + std::to_string(duration_s) +
                           "\n[[net]]\ngrid = { columns = " + count + ", rows = " + count + ", spacing = " +
                           std::to_string(spacing_m) + ", diagonals = false }\npinned = [[0, 0]]\n",
                       "net.toml");
}

double distance_m(const Rhombi& truth, const State& state) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        const Vec2 at = truth.position_m(i);
        largest_m = std::max(largest_m, std::hypot(state.x_m[i] - at.x, state.y_m[i] - at.y));
    }
    return largest_m;
}

TEST(BarsInLine, CellsPassThroughTheirLine) {
    const Scene scene = grid_scene(3, 0.3, 2.0);
    for (const int order : {2, 4, 8}) {
        test::SolverRun<Rattle> run(build_system({}, scene.nets), WorldDef{}, RattleDef{order, 1.0 / 1000.0});
        Rhombi truth(3, 0.3);
        double error_m = 0.0;
        for (int k = 1; k <= 40; ++k) {
            ASSERT_TRUE(run.go(0.05 * k)) << order << ' ' << k;
            truth.advance_to(0.05 * k);
            error_m = std::max(error_m, distance_m(truth, run.state()));
        }
        std::printf("order %d: %.1e m, strain %.1e, energy %.1e\n", order, error_m, run.strain(),
                    run.energy_error());
        EXPECT_LT(error_m, order == 2 ? 2e-4 : 1e-9);
        EXPECT_LT(run.strain(), 1e-14);
    }
}

TEST(BarsInLine, AutoEstimatesErrorsBeyondThem) {
    constexpr double kDurationSeconds = 2.0;
    for (const auto& [size, spacing_m] : {std::pair(3, 0.3), std::pair(4, 0.2), std::pair(6, 0.1)}) {
        // Half a minute, most of it for the truth.
        if (size == 6 && std::getenv("CORDA_TEST_LONG") == nullptr) continue;
        Film film(grid_scene(size, spacing_m, kDurationSeconds));
        const BodyPlan& plan = film.plan().bodies.front();
        EXPECT_EQ(plan.horizon_s, std::nullopt) << size;
        Rhombi truth(size, spacing_m);
        double error_m = 0.0;
        for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
            truth.advance_to(film.time_s(k));
            error_m = std::max(error_m, distance_m(truth, film.state(k)));
        }
        // 3.0e-08 of 8.9e-08, 2.8e-08 of 8.4e-08 m
        std::printf("%d x %d: error %.1e of %.1e m\n", size, size, error_m, plan.error_estimate_m.value());
        EXPECT_LE(error_m, plan.error_estimate_m.value()) << size;
    }
}

/// A diamond with its lower corner at this height.
Scene diamond_scene(const std::string& solver, const std::string& low) {
    return parse_scene("schema = 1\n[world]\nduration = 2\n[solver]\n" + solver +
                           "\n[[net]]\npoints = [[0, 0], [0.7, -0.7], [0, " + low +
                           "], [-0.7, -0.7]]\n"
                           "bars = [[0, 1], [1, 2], [2, 3], [3, 0]]\npinned = [0]\n",
                       "diamond.toml");
}

TEST(BarsInLine, ARunThatFindsNoWayLeapsAndSaysSo) {
    const Scene scene = diamond_scene("method = 'rattle'\norder = 2\nstep = 0.05", "-1.4");
    Simulation run(build_system({}, scene.nets), scene.world, RattleDef{2, 0.05});
    for (int k = 1; k <= 27; ++k) ASSERT_EQ(run.advance_to(k / 60.0), Status::kOk);
    EXPECT_EQ(run.diagnostics().branched_s, std::nullopt);
    for (int k = 28; k <= 120; ++k) ASSERT_EQ(run.advance_to(k / 60.0), Status::kOk);
    EXPECT_EQ(run.diagnostics().branched_s, 28.0 / 60.0);
    EXPECT_LT(run.diagnostics().largest.strain, 1e-14);               // 2.2e-15
    EXPECT_LT(run.diagnostics().largest.energy_error.value(), 1e-2);  // 3.0e-3
}

}  // namespace
}  // namespace corda::sim
