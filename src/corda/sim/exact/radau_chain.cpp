#include "corda/sim/exact/radau_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

using namespace radau;

/// Share of the tolerance that one step may use. Errors add up: 40 of them in 4 s of a swing of 1000 links.
constexpr double kShareOfAnImplicitStep = 0.002;
/// Shares of the length below which estimates are rounding alone.
constexpr double kMinShareOfAnImplicitStep = 1e-14;
constexpr double kMinCorrection = 1e-14;
/// Share of a step's tolerance that Newton's method may leave.
constexpr double kShareOfNewton = 0.03;
/// Share of the length by which a link's angle counts in Newton's method: links that are not solved well turn
/// to and fro without displacing much, until the motion is lost. At a share of 0 to 0.01 swings of 10 000
/// links are lost at tolerances of 1e-2 and 1e-3.
constexpr double kShareOfAngle = 0.1;
constexpr int kMaxIterations = 7;
/// Errors in parts of the tolerance that are taken for small ones.
constexpr double kMinError = 1e-9;
constexpr double kMinLastError = 1e-2;
/// A link that turns farther in one step is not followed: half the range of cosine_sine_of_small().
constexpr double kMaxTurn = 0.5 * kSmallAngle;
/// Cost of an iteration per link, in updates of count_work().
constexpr std::uint64_t kUpdatesPerIteration = 1;

/// Turns joints from those of the step's start to those of a stage, times the inverse mass.
CORDA_AVX2_CLONES void turn_joints(Index links, const double* __restrict joint_c,
                                   const double* __restrict joint_s, const double* __restrict inverse_mass,
                                   const double* __restrict turn, double* __restrict wc,
                                   double* __restrict ws) {
    for (Index j = 1; j < links; ++j) {
        double c;
        double s;
        cosine_sine_of_small(turn[j + 1] - turn[j], c, s);
        wc[j] = inverse_mass[j] * (joint_c[j] * c - joint_s[j] * s);
        ws[j] = inverse_mass[j] * (joint_s[j] * c + joint_c[j] * s);
    }
}

/// Turns directions by small angles.
CORDA_AVX2_CLONES void turn_links(Index links, const double* __restrict turn, const double* __restrict c,
                                  const double* __restrict s, double* __restrict to_c,
                                  double* __restrict to_s) {
    for (Index i = 0; i < links; ++i) {
        double turn_c;
        double turn_s;
        cosine_sine_of_small(turn[i], turn_c, turn_s);
        const double x = c[i] * turn_c - s[i] * turn_s;
        const double y = s[i] * turn_c + c[i] * turn_s;
        // The inverse length, because the length differs from 1 by rounding alone.
        const double shrink = 1.5 - 0.5 * (x * x + y * y);
        to_c[i] = x * shrink;
        to_s[i] = y * shrink;
    }
}

/// Input and output of residuals().
struct Residuals {
    Index links;
    double step_s;
    double drag_1_s;
    const double *length_m, *inverse_mass, *omega;
    const double *turn[3], *tension[3], *wc[3], *ws[3];
    double *across, *along;
    Complex *complex_across, *complex_along;
};

/// Residuals of (4) and (3) at the stages, with opposite signs, in the eigenvectors of B.
CORDA_AVX2_CLONES void residuals(const Residuals& r) {
    const double per_step = 1.0 / r.step_s;
    for (Index i = 1; i <= r.links; ++i) {
        double speed[3];
        double across[3];
        double along[3];
        for (int k = 0; k < 3; ++k)
            speed[k] = per_step * slope_at(k, r.turn[0][i], r.turn[1][i], r.turn[2][i]);
        const double before = r.omega[i];
        for (int k = 0; k < 3; ++k) {
            const double slope =
                per_step * slope_at(k, speed[0] - before, speed[1] - before, speed[2] - before);
            const double next = r.tension[k][i + 1];
            const double last = r.tension[k][i - 1];
            across[k] =
                r.ws[k][i] * next - r.ws[k][i - 1] * last - r.length_m[i] * (slope + r.drag_1_s * speed[k]);
            along[k] = (r.inverse_mass[i - 1] + r.inverse_mass[i]) * r.tension[k][i] - r.wc[k][i] * next -
                       r.wc[k][i - 1] * last - r.length_m[i] * (speed[k] * speed[k]);
        }
        const auto combine = [](const double* x, int row) {
            return kTo[row][0] * x[0] + kTo[row][1] * x[1] + kTo[row][2] * x[2];
        };
        r.across[i] = combine(across, 0);
        r.along[i] = combine(along, 0);
        r.complex_across[i] = {combine(across, 1), combine(across, 2)};
        r.complex_along[i] = {combine(along, 1), combine(along, 2)};
    }
}

/// The bodies of a system that implicit steps can move.
const std::vector<Body>& bodies_of(const System& system) {
    if (ImplicitPart::can_move(system, system.bodies.front())) return system.bodies;
    throw Refusal(
        Refusal::Reason::kImplicit,
        "implicit steps move open ropes of rigid links with one pin that neither resist bending nor "
        "are strings");
}

/// The polynomial through the values of the last step's stages at `time`, in parts of that step.
std::array<double, 3> weights_of_stages(double time, bool starts_at_0) {
    std::array<double, 3> weights{1.0, 1.0, 1.0};
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j)
            if (j != k) weights[k] *= (time - kTime[j]) / (kTime[k] - kTime[j]);
        if (starts_at_0) weights[k] *= time / kTime[k];
    }
    return weights;
}

}  // namespace

RadauChain::RadauChain(ChainDynamics& dynamics, const System& system, const Chain& chain, double tolerance)
    : links_(chain.link_count),
      first_link_(chain.first_link),
      link_stride_(dynamics.chains().link_count()),
      pull_m_s2_(dynamics.chains().forces.uniform_m_s2()),
      drag_1_s_(dynamics.chains().forces.drag_1_s()),
      control_(step_control(chain.inverse_timescale_1_s, tolerance)),
      tolerance_m_(std::max(kShareOfAnImplicitStep * tolerance, kMinShareOfAnImplicitStep) * chain.length_m),
      chain_length_m_(chain.length_m),
      step_s_(control_.first_s) {
    const auto resize = [this](Array& array) { array.assign(links_ + 2, 0.0); };
    for (Array* array : {&length_m_, &inverse_mass_1_kg_, &c_, &s_, &omega_, &slope_, &old_c_, &old_s_,
                         &old_omega_, &old_slope_, &turned_, &joint_c_, &joint_s_, &matrix_wc_, &matrix_ws_,
                         &matrix_tension_, &matrix_omega_, &across_, &along_})
        resize(*array);
    for (Stages* stages : {&turn_, &tension_, &old_turn_, &old_tension_, &wc_, &ws_})
        std::for_each(stages->begin(), stages->end(), resize);
    complex_across_.resize(links_ + 2);
    complex_along_.resize(links_ + 2);
    pivots_.resize(links_ + 2);
    complex_pivots_.resize(links_ + 2);
    const double* const y = dynamics.initial_state().data();
    std::vector<double> slope(dynamics.initial_state().size());
    std::vector<double> tension_n(system.bars.size());
    dynamics.derivative(y, slope.data());
    dynamics.tensions(y, tension_n);
    for (Index i = 1; i <= links_; ++i) {
        const Index link = first_link_ + i - 1;
        const Index particle = chain.particle(i - 1);
        length_m_[i] = dynamics.chains().length_m[link];
        inverse_mass_1_kg_[i] = dynamics.chains().inverse_mass_1_kg[link];
        c_[i] = y[link];
        s_[i] = y[link_stride_ + link];
        omega_[i] = y[2 * link_stride_ + link];
        slope_[i] = slope[2 * link_stride_ + link];
        for (Array& stage : old_tension_)
            stage[i] = tension_n[chain.runs_backwards ? particle : particle - 1];
    }
    for (Index j = 1; j < links_; ++j) {
        joint_c_[j] = c_[j] * c_[j + 1] + s_[j] * s_[j + 1];
        joint_s_[j] = c_[j] * s_[j + 1] - s_[j] * c_[j + 1];
    }
}

void RadauChain::predict() {
    if (last_step_s_ == 0.0) {
        for (Array& stage : turn_) std::fill(stage.begin(), stage.end(), 0.0);
        tension_ = old_tension_;
        return;
    }
    const double ratio = step_s_ / last_step_s_;
    for (Index k = 0; k < kStages; ++k) {
        const double time = 1.0 + ratio * kTime[k];
        std::array<double, 3> of_turn = weights_of_stages(time, true);
        of_turn[2] -= 1.0;
        const std::array<double, 3> of_tension = weights_of_stages(time, false);
        for (Index i = 1; i <= links_; ++i) {
            turn_[k][i] =
                of_turn[0] * old_turn_[0][i] + of_turn[1] * old_turn_[1][i] + of_turn[2] * old_turn_[2][i];
            tension_[k][i] = of_tension[0] * old_tension_[0][i] + of_tension[1] * old_tension_[1][i] +
                             of_tension[2] * old_tension_[2][i];
        }
    }
}

void RadauChain::find_residuals() {
    Residuals r{links_,
                step_s_,
                drag_1_s_,
                length_m_.data(),
                inverse_mass_1_kg_.data(),
                omega_.data(),
                {},
                {},
                {},
                {},
                across_.data(),
                along_.data(),
                complex_across_.data(),
                complex_along_.data()};
    for (Index k = 0; k < kStages; ++k) {
        turn_joints(links_, joint_c_.data(), joint_s_.data(), inverse_mass_1_kg_.data(), turn_[k].data(),
                    wc_[k].data(), ws_[k].data());
        r.turn[k] = turn_[k].data();
        r.tension[k] = tension_[k].data();
        r.wc[k] = wc_[k].data();
        r.ws[k] = ws_[k].data();
    }
    residuals(r);
    for (Index k = 0; k < kStages; ++k) {
        const Pull here = pull_of(pull_m_s2_, c_[1], s_[1], turn_[k][1]);
        across_[1] += kTo[0][k] * here.across;
        along_[1] -= kTo[0][k] * here.along;
        complex_across_[1] = complex_across_[1] + here.across * Complex{kTo[1][k], kTo[2][k]};
        complex_along_[1] = complex_along_[1] - here.along * Complex{kTo[1][k], kTo[2][k]};
    }
}

Matrix RadauChain::matrix() const {
    return {length_m_.data(),  inverse_mass_1_kg_.data(), matrix_wc_.data(),
            matrix_ws_.data(), matrix_tension_.data(),    matrix_omega_.data()};
}

void RadauChain::factorise() {
    constexpr Index kMiddle = 1;
    turn_joints(links_, joint_c_.data(), joint_s_.data(), inverse_mass_1_kg_.data(), turn_[kMiddle].data(),
                matrix_wc_.data(), matrix_ws_.data());
    matrix_tension_ = tension_[kMiddle];
    const double per_step = 1.0 / step_s_;
    for (Index i = 1; i <= links_; ++i) {
        matrix_omega_[i] = per_step * slope_at(kMiddle, turn_[0][i], turn_[1][i], turn_[2][i]);
    }
    const Matrix matrix = this->matrix();
    const double rate = kReal * per_step;
    const Complex pair = per_step * kPair;
    const double square = rate * rate + drag_1_s_ * rate;
    const Complex pair_square = pair * pair + drag_1_s_ * pair;
    Pull pull = pull_of(pull_m_s2_, c_[1], s_[1], turn_[kMiddle][1]);
    for (Index i = 1; i <= links_; ++i) {
        matrix.eliminate(i, pull, rate, square, pivots_.data());
        matrix.eliminate(i, pull, pair, pair_square, complex_pivots_.data());
        pull = {};
    }
}

void RadauChain::solve() {
    const Matrix matrix = this->matrix();
    for (Index i = 1; i <= links_; ++i) {
        matrix.forward(i, pivots_[i], across_.data(), along_.data());
        matrix.forward(i, complex_pivots_[i], complex_across_.data(), complex_along_.data());
    }
    for (Index i = links_; i > 0; --i) {
        backward(i, pivots_[i], across_.data(), along_.data());
        backward(i, complex_pivots_[i], complex_across_.data(), complex_along_.data());
    }
}

double RadauChain::displacement_m(const Array& angle) const {
    double x_m = 0.0;
    double y_m = 0.0;
    double largest_m2 = 0.0;
    for (Index i = 1; i <= links_; ++i) {
        const double moved_m = length_m_[i] * angle[i];
        x_m -= s_[i] * moved_m;
        y_m += c_[i] * moved_m;
        const double square_m2 = x_m * x_m + y_m * y_m;
        if (!(square_m2 <= largest_m2)) largest_m2 = square_m2;  // keeps a NaN
    }
    return std::sqrt(largest_m2);
}

double RadauChain::correct() {
    double farthest = 0.0;
    double sharpest = 0.0;
    for (Index i = 1; i <= links_; ++i) {
        const double across[] = {across_[i], complex_across_[i].re, complex_across_[i].im};
        const double along[] = {along_[i], complex_along_[i].re, complex_along_[i].im};
        for (Index k = 0; k < kStages; ++k) {
            turn_[k][i] += kFrom[k][0] * across[0] + kFrom[k][1] * across[1] + kFrom[k][2] * across[2];
            tension_[k][i] += kFrom[k][0] * along[0] + kFrom[k][1] * along[1] + kFrom[k][2] * along[2];
        }
        turned_[i] = kFrom[2][0] * across[0] + kFrom[2][1] * across[1];
        sharpest = std::max(sharpest, std::abs(turned_[i]));
        const double turn = std::abs(turn_[2][i]);
        if (!(turn <= farthest)) farthest = turn;
    }
    return farthest <= kMaxTurn
               ? std::max(displacement_m(turned_), kShareOfAngle * chain_length_m_ * sharpest)
               : std::numeric_limits<double>::infinity();
}

bool RadauChain::solve_stages() {
    predict();
    factorise();
    const double enough_m = std::max(kShareOfNewton * tolerance_m_, kMinCorrection * chain_length_m_);
    double last_m = 0.0;
    for (iterations_ = 1; iterations_ <= kMaxIterations; ++iterations_) {
        count_work(1 + kUpdatesPerIteration * links_);
        find_residuals();
        solve();
        const double correction_m = correct();
        if (correction_m <= enough_m) return true;
        if (!std::isfinite(correction_m)) return false;
        if (iterations_ > 1) {
            const double rate = correction_m / last_m;
            if (!(rate < 1.0)) return false;
            double left_m = correction_m * rate / (1.0 - rate);
            if (left_m <= enough_m) return true;
            for (int k = iterations_; k < kMaxIterations; ++k) left_m *= rate;
            if (left_m > enough_m) return false;
        }
        last_m = correction_m;
    }
    return false;
}

double RadauChain::error_m() {
    const Matrix matrix = this->matrix();
    const double rate = kReal / step_s_;
    for (Index i = 1; i <= links_; ++i) {
        double turn = step_s_ * omega_[i];
        double speed = step_s_ * slope_[i];
        for (Index k = 0; k < kStages; ++k) {
            const double omega = slope_at(k, turn_[0][i], turn_[1][i], turn_[2][i]) / step_s_;
            turn += kErrorWeights[k] * turn_[k][i];
            speed += kErrorWeights[k] * (omega - omega_[i]);
        }
        turn /= kReal;
        speed /= kReal;
        across_[i] = length_m_[i] * rate * ((rate + drag_1_s_) * turn + speed);
        along_[i] = 2.0 * length_m_[i] * matrix_omega_[i] * rate * turn;
    }
    for (Index i = 1; i <= links_; ++i) matrix.forward(i, pivots_[i], across_.data(), along_.data());
    for (Index i = links_; i > 0; --i) backward(i, pivots_[i], across_.data(), along_.data());
    return displacement_m(across_);
}

double RadauChain::buckling_1_s() const {
    constexpr Index kEnd = 2;
    double fastest = 0.0;
    for (Index i = 1; i <= links_; ++i) {
        const double pull_n = wc_[kEnd][i - 1] * tension_[kEnd][i - 1] + wc_[kEnd][i] * tension_[kEnd][i + 1];
        fastest = std::max(fastest, -2.0 * pull_n / length_m_[i]);
    }
    return std::sqrt(fastest);
}

void RadauChain::accept() {
    std::swap(old_c_, c_);
    std::swap(old_s_, s_);
    turned_ = turn_[2];
    turn_links(links_ + 2, turned_.data(), old_c_.data(), old_s_.data(), c_.data(), s_.data());
    for (Index i = 1; i <= links_; ++i) {
        double omega[kStages];
        for (Index k = 0; k < kStages; ++k)
            omega[k] = slope_at(k, turn_[0][i], turn_[1][i], turn_[2][i]) / step_s_;
        old_omega_[i] = omega_[i];
        old_slope_[i] = slope_[i];
        slope_[i] = slope_at(2, omega[0] - omega_[i], omega[1] - omega_[i], omega[2] - omega_[i]) / step_s_;
        omega_[i] = omega[2];
    }
    for (Index j = 1; j < links_; ++j) {
        joint_c_[j] = c_[j] * c_[j + 1] + s_[j] * s_[j + 1];
        joint_s_[j] = c_[j] * s_[j + 1] - s_[j] * c_[j + 1];
    }
    std::swap(old_turn_, turn_);
    std::swap(old_tension_, tension_);
    start_s_ = end_s_;
    end_s_ += step_s_;
    last_step_s_ = step_s_;
    ++steps_;
}

double RadauChain::next_factor() {
    constexpr double kCaution = 0.9;
    constexpr double kMinFactor = 0.125;
    constexpr double kMaxFactor = 8.0;
    constexpr double kEnough = 1.2;  // a change that is worth another matrix
    if (!solve_stages()) return -0.5;
    const double buckling = step_s_ * buckling_1_s();
    if (buckling > 1.0) return -std::max(kMinFactor, kCaution / buckling);
    const double error = std::max(error_m() / tolerance_m_, kMinError);
    const double safety = kCaution * (2 * kMaxIterations + 1) / (2 * kMaxIterations + iterations_);
    double factor = safety / std::sqrt(std::sqrt(error));
    if (!(error <= 1.0)) return -std::max(kMinFactor, factor);
    // Gustafsson's predictive controller.
    if (last_step_s_ > 0.0)
        factor *= std::min(1.0, step_s_ / last_step_s_ * std::sqrt(std::sqrt(last_error_ / error)));
    last_error_ = std::max(error, kMinLastError);
    factor = std::clamp(factor, kMinFactor, kMaxFactor);
    if (buckling > 0.0) factor = std::min(factor, 1.0 / buckling);
    return factor > 1.0 && factor < kEnough ? 1.0 : factor;
}

Status RadauChain::step() {
    double most = std::numeric_limits<double>::infinity();  // no growth after a rejected step
    for (;;) {
        if (!(step_s_ > control_.smallest_s) || steps_ == StepControl::kMaxSteps) return Status::kDiverged;
        // Time and step agree to the last bit, so that no rounding of times adds up.
        step_s_ = (end_s_ + step_s_) - end_s_;
        const double factor = next_factor();
        if (factor > 0.0) {
            accept();
            step_s_ = std::min(std::min(factor, most) * last_step_s_, control_.largest_s);
            return Status::kOk;
        }
        step_s_ *= -factor;
        most = 1.0;
        ++rejected_;
    }
}

void RadauChain::interpolate(double time_s, double* y) const {
    const double h = last_step_s_;
    const double x = (time_s - start_s_) / h;
    double* const c = y + first_link_;
    double* const omega = c + 2 * link_stride_;
    std::vector<double> turn(links_);
    for (Index i = 0; i < links_; ++i) {
        // Hermite's polynomial of degree 5.
        const double end = turned_[i + 1];
        const double d0 = h * old_omega_[i + 1];
        const double d1 = h * omega_[i + 1];
        const double e0 = h * h * old_slope_[i + 1];
        const double e1 = h * h * slope_[i + 1];
        const double p3 = 10.0 * end - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1;
        const double p4 = -15.0 * end + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1;
        const double p5 = 6.0 * end - 3.0 * (d0 + d1) + 0.5 * (e1 - e0);
        turn[i] = x * (d0 + x * (0.5 * e0 + x * (p3 + x * (p4 + x * p5))));
        omega[i] = (d0 + x * (e0 + x * (3.0 * p3 + x * (4.0 * p4 + x * (5.0 * p5))))) / h;
    }
    turn_links(links_, turn.data(), &old_c_[1], &old_s_[1], c, c + link_stride_);
}

bool ImplicitPart::can_move(const System& system, const Body& body) {
    if (!body.is_chain || body.material.is_string || body.material.compliance_1_n > 0.0) return false;
    const auto is_of_body = [&](std::size_t particle) {
        return body.first_particle <= particle && particle < body.first_particle + body.particle_count;
    };
    std::size_t pins = 0;
    for (std::size_t i = 0; i < system.particle_count(); ++i)
        if (is_of_body(i) && system.is_pinned(i)) ++pins;
    return pins == 1 &&
           std::ranges::none_of(system.bends, [&](const Bend& bend) { return is_of_body(bend.a); });
}

ImplicitPart::ImplicitPart(const System& system, const Forces& forces, const ExactDef& def)
    : Exact(system, forces, def), dynamics_(system, bodies_of(system), forces) {
    output_ = dynamics_.initial_state();
    for (const Chain& chain : dynamics_.chains().list)
        chains_.emplace_back(dynamics_, system, chain, def.tolerance);
}

Status ImplicitPart::reach(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    for (RadauChain& chain : chains_) {
        while (chain.end_s() < time_s) {
            if (chain.step() == Status::kDiverged) return Status::kDiverged;
        }
        if (chain.steps() > 0) chain.interpolate(time_s, output_.data());
    }
    dynamics_.positions(output_.data(), state);
    return Status::kOk;
}

std::uint64_t ImplicitPart::steps() const {
    return std::accumulate(chains_.begin(), chains_.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const RadauChain& chain) { return sum + chain.steps(); });
}

std::uint64_t ImplicitPart::rejected_steps() const {
    return std::accumulate(
        chains_.begin(), chains_.end(), std::uint64_t{0},
        [](std::uint64_t sum, const RadauChain& chain) { return sum + chain.rejected_steps(); });
}

}  // namespace corda::sim
