// SUNDIALS on the equations of motion: CVODE in the angles of the links, by Adams' methods and by BDF, with
// the snap of a string found as a root; IDA on the positions, velocities and multipliers, the constraints
// kept on both levels (Gear, Gupta, Leimkuhler 1985), with a band solver.

#include <cvode/cvode.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>

#include "benchmark/peers/equations.hpp"

namespace corda::peers {
namespace {

constexpr long kMaxSteps = 5000;  ///< per frame

SUNContext context() {
    static SUNContext made = [] {
        SUNContext context = nullptr;
#if SUNDIALS_VERSION_MAJOR >= 7
        SUNContext_Create(SUN_COMM_NULL, &context);
        SUNContext_ClearErrHandlers(context);
#else
        SUNContext_Create(nullptr, &context);
#endif
        return context;
    }();
    return made;
}

/// Vector, matrix, and solvers of a run.
struct Parts {
    N_Vector y = nullptr;
    N_Vector slope = nullptr;
    SUNMatrix matrix = nullptr;
    SUNLinearSolver linear = nullptr;
    SUNNonlinearSolver nonlinear = nullptr;

    explicit Parts(std::size_t size)
        : y(N_VNew_Serial(static_cast<sunindextype>(size), context())), slope(N_VClone(y)) {}
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() {
        if (nonlinear != nullptr) SUNNonlinSolFree(nonlinear);
        if (linear != nullptr) SUNLinSolFree(linear);
        if (matrix != nullptr) SUNMatDestroy(matrix);
        N_VDestroy(slope);
        N_VDestroy(y);
    }
};

void check(int flag, const char* what) {
    if (flag < 0) throw Failure(what);
}

class CvodeRun : public Run {
  public:
    CvodeRun(const Problem& problem, int method, double tolerance)
        : problem_(problem), equations_(problem), parts_(problem.is_string ? 4 : equations_.size()) {
        double* const y = N_VGetArrayPointer(parts_.y);
        if (problem.is_string) {
            std::fill(y, y + 4, 0.0);
            y[0] = problem.system.x_m[1];
        } else {
            const std::vector<double> start = equations_.start();
            std::copy(start.begin(), start.end(), y);
        }
        start_solver(method, tolerance);
    }
    ~CvodeRun() override { CVodeFree(&solver_); }

    void advance(double time_s) override {
        double reached_s = 0.0;
        int flag = CV_SUCCESS;
        while ((flag = CVode(solver_, time_s, parts_.y, &reached_s, CV_NORMAL)) == CV_ROOT_RETURN)
            snap(reached_s);
        check(flag, "CVODE failed");
    }
    void read(State& state) override {
        const double* const y = N_VGetArrayPointer(parts_.y);
        if (!problem_.is_string) {
            equations_.read(y, state);
            return;
        }
        // In the fall x, y, vx, vy; then angle, angular velocity, and no more.
        const double c = std::cos(y[0]);
        const double s = std::sin(y[0]);
        state.x_m[1] = is_taut_ ? c : y[0];
        state.y_m[1] = is_taut_ ? s : y[1];
        state.vx_m_s[1] = is_taut_ ? -s * y[1] : y[2];
        state.vy_m_s[1] = is_taut_ ? c * y[1] : y[3];
    }

  private:
    static int slope(double /*t*/, N_Vector y, N_Vector dy, void* self) {
        auto& run = *static_cast<CvodeRun*>(self);
        const double* const from = N_VGetArrayPointer(y);
        double* const to = N_VGetArrayPointer(dy);
        if (!run.problem_.is_string) {
            run.equations_.slope(from, to);
            return 0;
        }
        to[0] = run.is_taut_ ? from[1] : from[2];
        to[1] = run.is_taut_ ? -run.problem_.gravity() * std::cos(from[0]) : from[3];
        to[2] = 0.0;
        to[3] = run.is_taut_ ? 0.0 : -run.problem_.gravity();
        return 0;
    }
    static int slack(double /*t*/, N_Vector y, double* root, void* self) {
        const double* const from = N_VGetArrayPointer(y);
        root[0] = static_cast<CvodeRun*>(self)->is_taut_ ? 1.0 : 1.0 - from[0] * from[0] - from[1] * from[1];
        return 0;
    }

    void start_solver(int method, double tolerance) {
        solver_ = CVodeCreate(method, context());
        CVodeInit(solver_, slope, 0.0, parts_.y);
        CVodeSetUserData(solver_, this);
        CVodeSStolerances(solver_, tolerance, tolerance);
        CVodeSetMaxNumSteps(solver_, kMaxSteps);
        if (problem_.is_string) CVodeRootInit(solver_, 1, slack);
#if SUNDIALS_VERSION_MAJOR < 7
        CVodeSetErrHandlerFn(solver_, [](int, const char*, const char*, char*, void*){}, nullptr);
#endif
        if (method == CV_ADAMS) {
            parts_.nonlinear = SUNNonlinSol_FixedPoint(parts_.y, 0, context());
            CVodeSetNonlinearSolver(solver_, parts_.nonlinear);
        } else {
            const auto size = static_cast<sunindextype>(N_VGetLength(parts_.y));
            parts_.matrix = SUNDenseMatrix(size, size, context());
            parts_.linear = SUNLinSol_Dense(parts_.y, parts_.matrix, context());
            CVodeSetLinearSolver(solver_, parts_.linear, parts_.matrix);
        }
    }

    void snap(double time_s) {
        double* const y = N_VGetArrayPointer(parts_.y);
        const double along = y[0] * y[3] - y[1] * y[2];
        y[0] = std::atan2(y[1], y[0]);
        y[1] = along;
        y[2] = y[3] = 0.0;
        is_taut_ = true;
        check(CVodeReInit(solver_, time_s, parts_.y), "CVODE failed");
    }

    const Problem& problem_;
    Equations<double> equations_;
    Parts parts_;
    void* solver_ = nullptr;
    bool is_taut_ = false;
};

/// Unknowns of a link: x, y, vx, vy of its far particle, its tension over its length, and the multiplier of
/// its velocity.
class IdaRun : public Run {
  public:
    IdaRun(const Problem& problem, double tolerance)
        : problem_(problem),
          links_(problem.count() - 1),
          parts_(kUnknowns * links_),
          id_(N_VClone(parts_.y)) {
        start_values();
        solver_ = IDACreate(context());
        IDAInit(solver_, residual, 0.0, parts_.y, parts_.slope);
        IDASetUserData(solver_, this);
        // The multipliers, which follow from the rest, are not held to the tolerance.
        N_Vector tolerances = N_VClone(parts_.y);
        for (std::size_t i = 0; i < kUnknowns * links_; ++i)
            N_VGetArrayPointer(tolerances)[i] = N_VGetArrayPointer(id_)[i] > 0.0 ? tolerance : kLoose;
        IDASVtolerances(solver_, tolerance, tolerances);
        N_VDestroy(tolerances);
        IDASetMaxNumSteps(solver_, kMaxSteps);
        IDASetId(solver_, id_);
        IDASetSuppressAlg(solver_, 1);
#if SUNDIALS_VERSION_MAJOR < 7
        IDASetErrHandlerFn(solver_, [](int, const char*, const char*, char*, void*){}, nullptr);
#endif
        const auto size = static_cast<sunindextype>(kUnknowns * links_);
        constexpr sunindextype kBand = 2 * kUnknowns - 1;
        parts_.matrix = SUNBandMatrix(size, kBand, kBand, context());
        parts_.linear = SUNLinSol_Band(parts_.y, parts_.matrix, context());
        IDASetLinearSolver(solver_, parts_.linear, parts_.matrix);
    }
    ~IdaRun() override {
        IDAFree(&solver_);
        N_VDestroy(id_);
    }
    void advance(double time_s) override {
        double reached_s = 0.0;
        check(IDASolve(solver_, time_s, &reached_s, parts_.y, parts_.slope, IDA_NORMAL), "IDA failed");
    }
    void read(State& state) override {
        const double* const y = N_VGetArrayPointer(parts_.y);
        for (std::size_t i = 0; i < links_; ++i) {
            state.x_m[i + 1] = y[kUnknowns * i];
            state.y_m[i + 1] = y[kUnknowns * i + 1];
            state.vx_m_s[i + 1] = y[kUnknowns * i + 2];
            state.vy_m_s[i + 1] = y[kUnknowns * i + 3];
        }
    }

  private:
    static constexpr std::size_t kUnknowns = 6;
    static constexpr double kLoose = 1e3;

    /// At rest, with the tensions of the start.
    void start_values() {
        double* const y = N_VGetArrayPointer(parts_.y);
        double* const slope = N_VGetArrayPointer(parts_.slope);
        double* const id = N_VGetArrayPointer(id_);
        std::fill(y, y + kUnknowns * links_, 0.0);
        std::fill(slope, slope + kUnknowns * links_, 0.0);
        const double angle = problem_.start_angle();
        double below_kg = 0.0;
        for (std::size_t i = links_; i-- > 0;) {
            double* const link = y + kUnknowns * i;
            link[0] = problem_.system.x_m[i + 1];
            link[1] = problem_.system.y_m[i + 1];
            below_kg += problem_.system.mass_kg[i + 1];
            const double pull = -std::sin(angle) * problem_.gravity();
            link[4] = below_kg * pull / problem_.link_m();
            slope[kUnknowns * i + 2] = -pull * std::cos(angle);
            slope[kUnknowns * i + 3] = -problem_.gravity() - pull * std::sin(angle);
            for (std::size_t k = 0; k < kUnknowns; ++k) id[kUnknowns * i + k] = k < 4 ? 1.0 : 0.0;
        }
    }

    static int residual(double /*t*/, N_Vector y_vector, N_Vector slope_vector, N_Vector result_vector,
                        void* self) {
        const auto& run = *static_cast<IdaRun*>(self);
        const double* const y = N_VGetArrayPointer(y_vector);
        const double* const slope = N_VGetArrayPointer(slope_vector);
        double* const result = N_VGetArrayPointer(result_vector);
        const double rest_m = run.problem_.link_m();
        for (std::size_t i = 0; i < run.links_; ++i) {
            const double* const at = y + kUnknowns * i;
            const double* const change = slope + kUnknowns * i;
            double* const out = result + kUnknowns * i;
            const double* const before = i == 0 ? kPin : at - kUnknowns;
            const double dx = at[0] - before[0];
            const double dy = at[1] - before[1];
            const double mass = run.problem_.system.mass_kg[i + 1];
            double pull_x = -at[4] * dx;
            double pull_y = -at[4] * dy;
            double shift_x = at[5] * dx;
            double shift_y = at[5] * dy;
            if (i + 1 < run.links_) {
                const double* const next = at + kUnknowns;
                pull_x += next[4] * (next[0] - at[0]);
                pull_y += next[4] * (next[1] - at[1]);
                shift_x -= next[5] * (next[0] - at[0]);
                shift_y -= next[5] * (next[1] - at[1]);
            }
            out[0] = change[0] - at[2] - shift_x;
            out[1] = change[1] - at[3] - shift_y;
            out[2] = mass * change[2] - pull_x;
            out[3] = mass * (change[3] + run.problem_.gravity()) - pull_y;
            out[4] = 0.5 * (dx * dx + dy * dy - rest_m * rest_m);
            out[5] = dx * (at[2] - before[2]) + dy * (at[3] - before[3]);
        }
        return 0;
    }

    static constexpr double kPin[kUnknowns] = {};

    const Problem& problem_;
    std::size_t links_;
    Parts parts_;
    N_Vector id_;
    void* solver_ = nullptr;
};

Series cvode(const char* name, int method) {
    return {name, "tolerance", powers_of_ten(2, 14),
            [method](const Problem& problem, double tolerance) {
                return std::make_unique<CvodeRun>(problem, method, tolerance);
            },
            [method](const Problem& problem) { return method == CV_ADAMS || !is_net(problem); }};
}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    const Series ida{
        "IDA", "tolerance", powers_of_ten(2, 12),
        [](const Problem& problem, double tolerance) { return std::make_unique<IdaRun>(problem, tolerance); },
        is_flexible_chain};
    return run_peer(argc, argv, "SUNDIALS", SUNDIALS_VERSION,
                    {cvode("CVODE Adams", CV_ADAMS), cvode("CVODE BDF", CV_BDF), ida});
}
