#include "corda/sim/exact/dop853.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "corda/core/cancel.hpp"

/// The coefficients of DOP853 as printed in E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
/// Differential Equations I, 2nd ed., Springer 1993, appendix (30 digits; the order conditions hold to
/// 1e-28).
namespace corda::sim::dop853 {

/// Where the slope of each stage is stored. Stage 13 is f at the end of the step; 14 to 16 are for the
/// interpolation. They take the places of stages 2 to 5, which are no longer needed by then.
enum Slot : std::size_t {
    k1,
    k2,
    k3,
    k4,
    k5,
    k6,
    k7,
    k8,
    k9,
    k10,
    k11,
    k12,
    kSlots,
    k13 = k2,
    k14 = k3,
    k15 = k4,
    k16 = k5
};

/// A sum of `Count` slopes with these weights.
template <std::size_t Count>
struct Row {
    std::array<Slot, Count> slots;
    std::array<double, Count> weights;

    /// Their sum: the time of a stage, in parts of the step.
    [[nodiscard]] constexpr double time() const {
        double sum = 0.0;
        for (const double weight : weights) sum += weight;
        return sum;
    }
};

// The argument of stage n is y + h times row n.
inline constexpr Row<1> kStageRow2{{k1}, {5.26001519587677318785587544488e-2}};
inline constexpr Row<2> kStageRow3{{k1, k2},
                                   {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2}};
inline constexpr Row<2> kStageRow4{{k1, k3},
                                   {2.95875854768068491816892993775e-2, 8.87627564304205475450678981324e-2}};
inline constexpr Row<3> kStageRow5{{k1, k3, k4},
                                   {2.41365134159266685502369798665e-1, -8.84549479328286085344864962717e-1,
                                    9.24834003261792003115737966543e-1}};
inline constexpr Row<3> kStageRow6{{k1, k4, k5},
                                   {3.7037037037037037037037037037e-2, 1.70828608729473871279604482173e-1,
                                    1.25467687566822425016691814123e-1}};
inline constexpr Row<4> kStageRow7{
    {k1, k4, k5, k6},
    {3.7109375e-2, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -1.7578125e-2}};
inline constexpr Row<5> kStageRow8{{k1, k4, k5, k6, k7},
                                   {3.70920001185047927108779319836e-2, 1.70383925712239993810214054705e-1,
                                    1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2,
                                    8.27378916381402288758473766002e-3}};
inline constexpr Row<6> kStageRow9{{k1, k4, k5, k6, k7, k8},
                                   {6.24110958716075717114429577812e-1, -3.36089262944694129406857109825e0,
                                    -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e1,
                                    2.01540675504778934086186788979e1, -4.34898841810699588477366255144e1}};
inline constexpr Row<7> kStageRow10{{k1, k4, k5, k6, k7, k8, k9},
                                    {4.77662536438264365890433908527e-1, -2.48811461997166764192642586468e0,
                                     -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e1,
                                     1.52792336328824235832596922938e1, -3.32882109689848629194453265587e1,
                                     -2.03312017085086261358222928593e-2}};
inline constexpr Row<8> kStageRow11{{k1, k4, k5, k6, k7, k8, k9, k10},
                                    {-9.3714243008598732571704021658e-1, 5.18637242884406370830023853209e0,
                                     1.09143734899672957818500254654e0, -8.14978701074692612513997267357e0,
                                     -1.85200656599969598641566180701e1, 2.27394870993505042818970056734e1,
                                     2.49360555267965238987089396762e0, -3.0467644718982195003823669022e0}};
inline constexpr Row<9> kStageRow12{{k1, k4, k5, k6, k7, k8, k9, k10, k11},
                                    {2.27331014751653820792359768449e0, -1.05344954667372501984066689879e1,
                                     -2.00087205822486249909675718444e0, -1.79589318631187989172765950534e1,
                                     2.79488845294199600508499808837e1, -2.85899827713502369474065508674e0,
                                     -8.87285693353062954433549289258e0, 1.23605671757943030647266201528e1,
                                     6.43392746015763530355970484046e-1}};

// The same for the interpolation.
inline constexpr Row<8> kStageRow14{{k1, k7, k8, k9, k10, k11, k12, k13},
                                    {5.61675022830479523392909219681e-2, 2.53500210216624811088794765333e-1,
                                     -2.46239037470802489917441475441e-1, -1.24191423263816360469010140626e-1,
                                     1.5329179827876569731206322685e-1, 8.20105229563468988491666602057e-3,
                                     7.56789766054569976138603589584e-3, -8.298e-3}};
inline constexpr Row<8> kStageRow15{
    {k1, k6, k7, k8, k11, k12, k13, k14},
    {3.18346481635021405060768473261e-2, 2.83009096723667755288322961402e-2,
     5.35419883074385676223797384372e-2, -5.49237485713909884646569340306e-2,
     -1.08347328697249322858509316994e-4, 3.82571090835658412954920192323e-4,
     -3.40465008687404560802977114492e-4, 1.41312443674632500278074618366e-1}};
inline constexpr Row<8> kStageRow16{{k1, k6, k7, k8, k9, k13, k14, k15},
                                    {-4.28896301583791923408573538692e-1, -4.69762141536116384314449447206e0,
                                     7.68342119606259904184240953878e0, 4.06898981839711007970213554331e0,
                                     3.56727187455281109270669543021e-1, -1.39902416515901462129418009734e-3,
                                     2.9475147891527723389556272149e0, -9.15095847217987001081870187138e0}};
/// The result of order 8 is y + h times this.
inline constexpr Row<8> kResult{
    {k1, k6, k7, k8, k9, k10, k11, k12},
    {5.42937341165687622380535766363e-2, 4.45031289275240888144113950566, 1.89151789931450038304281599044,
     -5.8012039600105847814672114227, 3.1116436695781989440891606237e-1, -1.52160949662516078556178806805e-1,
     2.01365400804030348374776537501e-1, 4.47106157277725905176885569043e-2}};

/// Its difference from results of order 5 and 3.
inline constexpr Row<8> kError5{
    {k1, k6, k7, k8, k9, k10, k11, k12},
    {0.1312004499419488073250102996e-1, -0.1225156446376204440720569753e1, -0.4957589496572501915214079952,
     0.1664377182454986536961530415e1, -0.3503288487499736816886487290, 0.3341791187130174790297318841,
     0.8192320648511571246570742613e-1, -0.2235530786388629525884427845e-1}};
inline constexpr Row<8> kError3{
    {k1, k6, k7, k8, k9, k10, k11, k12},
    {-0.1898007540724076157147023289, 4.45031289275240888144113950566, 1.89151789931450038304281599044,
     -5.8012039600105847814672114227, -0.4226823213237919629324456792, -0.152160949662516078556178806805,
     0.201365400804030348374776537501, 0.02265179219836082581180620396}};

/// The upper four terms of the interpolation, see Dop853::interpolate.
inline constexpr Row<12> kDense4{
    {k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16},
    {-0.84289382761090128651353491142e1, 0.56671495351937776962531783590, -0.30689499459498916912797304727e1,
     0.23846676565120698287728149680e1, 0.21170345824450282767155149946e1, -0.87139158377797299206789907490,
     0.22404374302607882758541771650e1, 0.63157877876946881815570249290, -0.88990336451333310820698117400e-1,
     0.18148505520854727256656404962e2, -0.91946323924783554000451984436e1,
     -0.44360363875948939664310572000e1}};
inline constexpr Row<12> kDense5{{k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16},
                                 {0.10427508642579134603413151009e2, 0.24228349177525818288430175319e3,
                                  0.16520045171727028198505394887e3, -0.37454675472269020279518312152e3,
                                  -0.22113666853125306036270938578e2, 0.77334326684722638389603898808e1,
                                  -0.30674084731089398182061213626e2, -0.93321305264302278729567221706e1,
                                  0.15697238121770843886131091075e2, -0.31139403219565177677282850411e2,
                                  -0.93529243588444783865713862664e1, 0.35816841486394083752465898540e2}};
inline constexpr Row<12> kDense6{{k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16},
                                 {0.19985053242002433820987653617e2, -0.38703730874935176555105901742e3,
                                  -0.18917813819516756882830838328e3, 0.52780815920542364900561016686e3,
                                  -0.11573902539959630126141871134e2, 0.68812326946963000169666922661e1,
                                  -0.10006050966910838403183860980e1, 0.77771377980534432092869265740,
                                  -0.27782057523535084065932004339e1, -0.60196695231264120758267380846e2,
                                  0.84320405506677161018159903784e2, 0.11992291136182789328035130030e2}};
inline constexpr Row<12> kDense7{
    {k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16},
    {-0.25693933462703749003312586129e2, -0.15418974869023643374053993627e3,
     -0.23152937917604549567536039109e3, 0.35763911791061412378285349910e3, 0.93405324183624310003907691704e2,
     -0.37458323136451633156875139351e2, 0.10409964950896230045147246184e3, 0.29840293426660503123344363579e2,
     -0.43533456590011143754432175058e2, 0.96324553959188282948394950600e2,
     -0.39177261675615439165231486172e2, -0.14972683625798562581422125276e3}};

}  // namespace corda::sim::dop853

namespace corda::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Step control as in the book (II.4): a step aims at an error below the tolerance, and changes by no more
// than these factors at a time.
constexpr double kSafety = 0.9;
constexpr double kMaxGrowth = 6.0;
constexpr double kMaxShrink = 1.0 / 3.0;
constexpr double kShrinkOfNotFinite = 0.1;

/// Components are worked on in blocks of this size, so that errors need no array of their own.
constexpr std::size_t kBlock = 64;

template <std::size_t Count>
struct Terms {
    std::array<const double*, Count> slope;
    std::array<double, Count> weight;
};

/// The terms of step * row.
template <std::size_t Count>
Terms<Count> terms(const dop853::Row<Count>& row, double step_s,
                   const std::array<std::vector<double>, dop853::kSlots>& slope) {
    Terms<Count> result{};
    for (std::size_t j = 0; j < Count; ++j) {
        result.slope[j] = slope[row.slots[j]].data();
        result.weight[j] = step_s * row.weights[j];
    }
    return result;
}

/// Their sum in component i, from left to right.
template <std::size_t Count>
[[gnu::always_inline]] inline double sum(const Terms<Count>& terms, std::size_t i) {
    return [&]<std::size_t... J>(std::index_sequence<J...>) {
        return (... + (terms.weight[J] * terms.slope[J][i]));
    }
    (std::make_index_sequence<Count>());
}

template <std::size_t Count>
void add(const Terms<Count> terms, std::size_t size, const double* from, double* __restrict out) {
    for (std::size_t i = 0; i < size; ++i) out[i] = from[i] + sum(terms, i);
}

}  // namespace

Dop853::Dop853(Ode& ode, std::vector<double> start, std::vector<ErrorScale> scales,
               const StepControl& control)
    : ode_(ode),
      scales_(std::move(scales)),
      control_(control),
      next_step_s_(std::min(control.first_s, control.largest_s)),
      y_(std::move(start)),
      old_y_(y_),
      stage_(y_) {
    assert(control.tolerance > 0.0);
    static_assert(kSlots == dop853::kSlots);
    for (std::vector<double>& slope : slope_) slope.assign(y_.size(), 0.0);
    ode_.derivative(y_.data(), slope_[dop853::k13].data());
}

Status Dop853::advance_to(double time_s) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    while (time_s_ < time_s) {
        if (step() == Status::kDiverged) return Status::kDiverged;
    }
    return Status::kOk;
}

template <std::size_t Count>
void Dop853::evaluate(const dop853::Row<Count>& row, double start_s, double step_s,
                      const std::vector<double>& from, std::vector<double>& scratch, std::size_t slot) {
    ode_.set_time(start_s + row.time() * step_s);
    add(terms(row, step_s, slope_), from.size(), from.data(), scratch.data());
    ode_.derivative(scratch.data(), slope_[slot].data());
}

Status Dop853::step() {
    std::swap(slope_[dop853::k1], slope_[dop853::k13]);
    double largest_growth = kMaxGrowth;
    const double key_s = ode_.next_key_s(time_s_);
    while (accepted_ + rejected_ < StepControl::kMaxSteps) {
        // Time and step agree to the last bit, so that no rounding of times adds up.
        const double wanted_s = StepControl::step_before_key(next_step_s_, key_s - time_s_);
        const double end_s = wanted_s == key_s - time_s_ ? key_s : time_s_ + wanted_s;
        const double step_s = end_s - time_s_;
        if (control_.is_too_short(step_s, time_s_)) return Status::kDiverged;
        count_work(1 + y_.size());
        evaluate_stages(step_s);
        const double step_error = error(step_s);
        const double factor = step_error < kInfinity
                                  ? std::clamp(kSafety / eighth_root(step_error), kMaxShrink, largest_growth)
                                  : kShrinkOfNotFinite;
        next_step_s_ = std::min(step_s * factor, control_.largest_s);
        if (step_error <= 1.0) {
            accept(end_s);
            return Status::kOk;
        }
        // A length that was just too long is not tried again at once.
        largest_growth = 1.0;
        ++rejected_;
    }
    return Status::kDiverged;
}

void Dop853::evaluate_stages(double step_s) {
    using namespace dop853;
    evaluate(kStageRow2, time_s_, step_s, y_, stage_, k2);
    evaluate(kStageRow3, time_s_, step_s, y_, stage_, k3);
    evaluate(kStageRow4, time_s_, step_s, y_, stage_, k4);
    evaluate(kStageRow5, time_s_, step_s, y_, stage_, k5);
    evaluate(kStageRow6, time_s_, step_s, y_, stage_, k6);
    evaluate(kStageRow7, time_s_, step_s, y_, stage_, k7);
    evaluate(kStageRow8, time_s_, step_s, y_, stage_, k8);
    evaluate(kStageRow9, time_s_, step_s, y_, stage_, k9);
    evaluate(kStageRow10, time_s_, step_s, y_, stage_, k10);
    evaluate(kStageRow11, time_s_, step_s, y_, stage_, k11);
    evaluate(kStageRow12, time_s_, step_s, y_, stage_, k12);
    add(terms(kResult, step_s, slope_), y_.size(), y_.data(), stage_.data());
}

double Dop853::error(double step_s) const {
    const Terms<8> terms5 = terms(dop853::kError5, step_s, slope_);
    const Terms<8> terms3 = terms(dop853::kError3, step_s, slope_);
    double largest5 = 0.0;
    double largest3 = 0.0;
    bool is_finite = true;
    std::array<double, kBlock> parts5{};
    std::array<double, kBlock> parts3{};
    for (const ErrorScale& scale : scales_) {
        for (std::size_t first = scale.first; first < scale.first + scale.count; first += kBlock) {
            const std::size_t count = std::min(kBlock, scale.first + scale.count - first);
            for (std::size_t k = 0; k < count; ++k) {
                const std::size_t i = first + k;
                const double size = std::max(std::abs(y_[i]), std::abs(stage_[i]));
                const double unit = 1.0 / (scale.absolute + scale.relative * size);
                parts5[k] = std::abs(sum(terms5, i)) * unit;
                parts3[k] = std::abs(sum(terms3, i)) * unit;
            }
            for (std::size_t k = 0; k < count; ++k) {
                is_finite = is_finite && parts5[k] < kInfinity;  // false for NaN
                largest5 = std::max(largest5, parts5[k]);
                largest3 = std::max(largest3, parts3[k]);
            }
        }
    }
    if (!is_finite) return kInfinity;
    const double square5 = largest5 * largest5;
    if (square5 == 0.0) return 0.0;  // or the square underflows: a string comes to rest, and 0 / 0 follows
    // The book's combination (II.10), of order 8 if both estimates behave according to their orders.
    const double both = square5 / std::sqrt(square5 + 0.01 * largest3 * largest3);
    return both / control_.tolerance;
}

void Dop853::accept(double end_s) {
    ode_.set_time(end_s);
    ode_.project(stage_.data());
    std::swap(old_y_, y_);
    std::swap(y_, stage_);
    ode_.derivative(y_.data(), slope_[dop853::k13].data());
    old_time_s_ = time_s_;
    time_s_ = end_s;
    can_interpolate_ = false;
    ++accepted_;
}

void Dop853::prepare_interpolation() {
    using namespace dop853;
    const double step_s = time_s_ - old_time_s_;
    evaluate(kStageRow14, old_time_s_, step_s, old_y_, stage_, k14);
    evaluate(kStageRow15, old_time_s_, step_s, old_y_, stage_, k15);
    evaluate(kStageRow16, old_time_s_, step_s, old_y_, stage_, k16);
    can_interpolate_ = true;
}

void Dop853::interpolate(double time_s, double* y) {
    assert(old_time_s_ <= time_s && time_s <= time_s_);
    if (time_s == time_s_) {
        std::copy(y_.begin(), y_.end(), y);
        return;
    }
    if (!can_interpolate_) prepare_interpolation();
    using namespace dop853;
    // The book's nested form, with p = t (1 - t):
    //   y0 + t (d + (1-t) (b + t (e + (1-t) (r4 + t (r5 + (1-t) (r6 + t r7)))))),
    //   d = y1 - y0, b = h k1 - d, e = d - h k13 - b, r_n = h * (row kDense n),
    // computed as one sum over the slopes.
    const double step_s = time_s_ - old_time_s_;
    const double t = (time_s - old_time_s_) / step_s;
    const double p = t * (1.0 - t);
    const std::array<double, 4> share = {p * p, t * p * p, p * p * p, t * p * p * p};
    constexpr std::array<Slot, 12> kUsed = {k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16};
    dop853::Row<12> row{kUsed, {}};
    for (std::size_t j = 0; j < kUsed.size(); ++j) {
        row.weights[j] = share[0] * kDense4.weights[j] + share[1] * kDense5.weights[j] +
                         share[2] * kDense6.weights[j] + share[3] * kDense7.weights[j];
    }
    row.weights[0] += p - t * p;
    row.weights[8] -= t * p;
    const double moved = t - p + 2.0 * t * p;
    const Terms<12> weighted = terms(row, step_s, slope_);
    for (std::size_t i = 0; i < y_.size(); ++i) {
        y[i] = old_y_[i] + (moved * (y_[i] - old_y_[i]) + sum(weighted, i));
    }
}

}  // namespace corda::sim
