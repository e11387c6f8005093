// The truth of every problem: the equations of motion in long double, by extrapolation of order 16. Runs by
// two tolerances must agree with each other, and with R5 and R11. Usage: peers_truth FOLDER

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "benchmark/peers/equations.hpp"
#include "benchmark/study/reference/numbers.hpp"

namespace corda::peers {
namespace {

using Real = long double;
using Vector = std::vector<Real>;

/// Gragg's method: the modified midpoint rule by 2, 4, ..., 16 substeps, extrapolated to none.
class Extrapolation {
  public:
    Extrapolation(Equations<Real>& equations, Vector start, Real tolerance)
        : equations_(equations), tolerance_(tolerance), y(std::move(start)) {
        table_.assign(kColumns, Vector(y.size()));
        for (Vector* values : {&before_, &now_, &slope_}) values->assign(y.size(), 0);
    }

    void advance(Real duration_s) {
        Real left_s = duration_s;
        while (left_s > 0) {
            const Real h = std::min(step_s_, left_s);
            const Real error = extrapolate(h) / tolerance_;
            if (error <= 1) {
                y = table_[0];
                left_s = h < left_s ? left_s - h : 0;
            }
            const Real factor = 0.8L * std::pow(std::max(error, Real(1e-20L)), -1.0L / (2 * kColumns - 1));
            step_s_ = std::isfinite(factor) ? h * std::clamp(factor, Real(0.2L), Real(2)) : h / 4;
        }
    }

  private:
    static constexpr std::size_t kColumns = 8;

    /// Leaves the end of a step in table_[0]. The largest difference from that of one column less.
    Real extrapolate(Real h) {
        Real error = 0;
        for (std::size_t j = 0; j < kColumns; ++j) {
            midpoint(h, 2 * static_cast<int>(j + 1), table_[j]);
            for (std::size_t k = j; k-- > 0;) {
                const Real ratio = static_cast<Real>(j + 1) / static_cast<Real>(k + 1);
                const Real weight = 1 / (ratio * ratio - 1);
                for (std::size_t i = 0; i < y.size(); ++i) {
                    const Real change = weight * (table_[k + 1][i] - table_[k][i]);
                    table_[k][i] = table_[k + 1][i] + change;
                    if (j + 1 == kColumns && k == 0)
                        error = std::max(error, std::abs(change) / (1 + std::abs(y[i])));
                    if (std::isnan(change)) return HUGE_VALL;
                }
            }
        }
        return error;
    }

    void midpoint(Real h, int substeps, Vector& end) {
        const Real part = h / substeps;
        before_ = y;
        equations_.slope(y.data(), slope_.data());
        for (std::size_t i = 0; i < y.size(); ++i) now_[i] = y[i] + part * slope_[i];
        for (int k = 1; k < substeps; ++k) {
            equations_.slope(now_.data(), slope_.data());
            for (std::size_t i = 0; i < y.size(); ++i) before_[i] += 2 * part * slope_[i];
            std::swap(before_, now_);
        }
        equations_.slope(now_.data(), slope_.data());
        for (std::size_t i = 0; i < y.size(); ++i) end[i] = (before_[i] + now_[i] + part * slope_[i]) / 2;
    }

    Equations<Real>& equations_;
    Real tolerance_;
    Real step_s_ = 1e-3L;
    std::vector<Vector> table_;
    Vector before_, now_, slope_;

  public:
    Vector y;
};

constexpr Real kFps = 60;

std::vector<State> smooth_motion(const Problem& problem, Real tolerance) {
    Equations<Real> equations(problem);
    Extrapolation run(equations, equations.start(), tolerance);
    std::vector<State> frames(static_cast<std::size_t>(problem.frames), start_of(problem));
    for (State& state : frames) {
        run.advance(1 / kFps);
        equations.read(run.y.data(), state);
    }
    return frames;
}

/// R9: a free fall from (0.6, 0) to (0.6, -0.8), where the velocity along the string is lost, and a pendulum.
std::vector<State> string_motion(const Problem& problem, Real tolerance) {
    Equations<Real> equations(problem);
    const Real gravity = equations.gravity();
    const Real snap_s = std::sqrt(Real(16) / 10 / gravity);
    Extrapolation run(equations, {std::atan2(Real(-8), Real(6)), -Real(6) / 10 * gravity * snap_s},
                      tolerance);
    std::vector<State> frames(static_cast<std::size_t>(problem.frames), start_of(problem));
    Real time_s = snap_s;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const Real next_s = static_cast<Real>(k + 1) / kFps;
        if (next_s < snap_s) {
            frames[k].y_m[1] = static_cast<double>(-gravity * next_s * next_s / 2);
            frames[k].vy_m_s[1] = static_cast<double>(-gravity * next_s);
            continue;
        }
        run.advance(next_s - time_s);
        time_s = next_s;
        equations.read(run.y.data(), frames[k]);
    }
    return frames;
}

double largest_difference(const std::vector<State>& a, const std::vector<State>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        for (std::size_t i = 0; i < a[k].x_m.size(); ++i) {
            largest = std::max(largest, std::abs(a[k].x_m[i] - b[k].x_m[i]));
            largest = std::max(largest, std::abs(a[k].y_m[i] - b[k].y_m[i]));
        }
    }
    return largest;
}

/// Largest distance over L from the published places of the tip: R5 and R11. R9 has no such numbers.
double from_published(const Problem& problem, const std::vector<State>& frames) {
    double largest = 0.0;
    const auto compare = [&](double time_s, Vec2 tip_m) {
        const auto k = static_cast<std::size_t>(std::lround(time_s * Problem::kFps)) - 1;
        if (k >= frames.size()) return;
        const Vec2 apart = Vec2{frames[k].x_m.back(), frames[k].y_m.back()} - tip_m;
        largest = std::max(largest, sim::length(apart.x, apart.y) / problem.length_m);
    };
    if (problem.id == "swing") {
        for (const reference::PublishedTip& row : reference::kReportTips) compare(row.time_s, row.tip_m);
    }
    if (problem.id == "chain" || problem.id == "payload") {
        for (const reference::ReleasedChain& row : reference::kReleasedChains) {
            if (row.links == 10 && row.angle_deg == 90.0 && row.tip_mass_kg == problem.system.mass_kg.back())
                compare(row.time_s, row.tip_m);
        }
    }
    return largest;
}

void write(const std::string& path, std::vector<State>& frames) {
    std::ofstream file(path, std::ios::binary);
    for (State& state : frames) {
        for (const std::vector<double>* values : {&state.x_m, &state.y_m, &state.vx_m_s, &state.vy_m_s}) {
            file.write(reinterpret_cast<const char*>(values->data()),
                       static_cast<std::streamsize>(values->size() * sizeof(double)));
        }
    }
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
        return 2;
    }
    bool agree = true;
    for (const Problem& problem : problems()) {
        const auto motion = problem.is_string ? string_motion : smooth_motion;
        std::vector<corda::State> frames = motion(problem, 1e-15L);
        const double apart = largest_difference(frames, motion(problem, 1e-13L)) / problem.length_m;
        const double published = from_published(problem, frames);
        std::printf("%s: two runs differ by %.1e L, and from R5 or R11 by %.1e L\n", problem.id.c_str(),
                    apart, published);
        agree = agree && apart < 1e-12 && published < 1e-12;
        write(truth_path(argv[1], problem), frames);
    }
    return agree ? 0 : 1;
}
