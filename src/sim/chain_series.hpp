#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "corda/sim/chain_dynamics.hpp"

namespace corda::sim {

/// The highest order of a ChainSeries.
inline constexpr std::size_t kLargestSeriesOrder = 32;

/// Links that a ChainSeries works on together.
inline constexpr std::size_t kSeriesLanes = 4;

/// Coefficients of a power series in time.
using Series = std::array<double, kLargestSeriesOrder + 1>;

/// What a ChainSeries works with. Links are kept in blocks of kSeriesLanes; what is left of the last block is
/// zero. A joint has the index of the link before it. Arrays of one entry a link have some room at both ends.
struct SeriesArrays {
    /// Series that a block has a row of coefficients for.
    enum Row : std::size_t {
        kCosine,       ///< W C of a joint
        kSine,         ///< W S
        kTension,      ///< T of the link before it
        kNextTension,  ///< of the link after it
        kRate,         ///< w of a link
        kTurn,         ///< w of the link after a joint less w of the one before
        kRows
    };
    struct alignas(kSeriesLanes * sizeof(double)) Lanes {
        std::array<double, kSeriesLanes> lane{};
    };

    std::size_t order = 0;  ///< of the rates
    std::size_t links = 0;
    std::size_t blocks = 0;
    std::size_t meeting = 0;  ///< the link at which the eliminations from both ends meet; first of a block
    double drag_1_s = 0.0;
    double first_inverse_mass_1_kg = 0.0;  ///< of the particle at the chain's start
    Vec2 start_pull_m_s2;                  ///< gravity where the start is pinned
    Vec2 end_pull_m_s2;                    ///< where the end is
    Vec2 fall_m_s2;                        ///< where the start is not
    double unit_s = 1.0;                   ///< coefficient k is of (t / unit_s)^k

    // Directions of the first and the last link; velocity and place of the first particle where not pinned.
    Series first_c, first_s, last_c, last_s, vx, vy, x, y;

    std::vector<Lanes> rows;  ///< kRows series of order + 1 coefficients a block
    std::vector<Lanes> flat;  ///< holds the arrays from here on
    double* length_m = nullptr;
    double* inverse_length_1_m = nullptr;
    double* inverse_mass_1_kg = nullptr;  ///< of the particle at a link's far end
    double* c = nullptr;                  ///< at t = 0, as s and rate
    double* s = nullptr;
    double* rate = nullptr;
    double* inverse_pivot = nullptr;
    double* weight = nullptr;       ///< of a joint: the share of a link's row, or tension, in its neighbour's
    double* load = nullptr;         ///< right-hand sides of the tensions
    double* across_next = nullptr;  ///< pull across the next link from a link's joint
    double* across_after = nullptr;  ///< and across the link itself
    double* tension = nullptr;
    double* last_slope = nullptr;  ///< of the rates, 1/s^2, at the start of the last step of order 1
    double* scratch = nullptr;

    [[nodiscard]] double* row(std::size_t block, Row which, std::size_t k) {
        return rows[(block * kRows + which) * (order + 1) + k].lane.data();
    }
};

/// Code that works on a series. All give the same bits: each does the same correctly rounded operations on
/// each link in the same order.
enum class SeriesKernel {
    kBaseline,  ///< every CPU
    kAvx2,      ///< four links an instruction
};

/// The kernels that this CPU can run, the fastest last.
[[nodiscard]] std::span<const SeriesKernel> series_kernels();

/// The motion of one chain of a ChainDynamics as a power series in time.
///
/// Products of series are sums of products of their coefficients, so the equations of ChainDynamics give the
/// coefficients one after the other. With v_i = w_{i+1} - w_i, at the joints of two links,
///
///   C_i' = -v_i S_i,   S_i' = v_i C_i,
///
/// and the tensions' coefficient k obeys the tridiagonal system of C_i(0), whatever k is: it is factorised
/// once. No direction but those of the links next to a pin enters. The elimination runs from both ends to the
/// middle, so two sums that have to wait for their last term run side by side. An order costs about 3
/// products and sums a link and order below it.
///
/// Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer
/// 1993, I.8 (recursive computation of coefficients); A. Jorba, M. Zou, A software package for the numerical
/// integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005) 99-117
/// (steps from the last coefficients).
///
/// A series of order 1 that is corrected at the start of every step is the velocity Verlet method in the
/// angles: of order 2 with one solution for the tensions a step, stable to 2 over the largest frequency.
/// Source: E. Hairer, C. Lubich, G. Wanner, Geometric numerical integration illustrated by the
/// Stormer-Verlet method, Acta Numerica 12 (2003) 399-450, 1.4.
class ChainSeries {
  public:
    /// `order`: of the rates' series, 1 or 4 .. kLargestSeriesOrder. `chain` is one of `dynamics`.
    ChainSeries(const ChainDynamics& dynamics, const ChainDynamics::Chain& chain, std::size_t order,
                SeriesKernel kernel = series_kernels().back());

    [[nodiscard]] std::size_t order() const { return arrays_.order; }

    /// Expands the motion that goes on from the chain's part of the state `y`. `unit_s`: about the time that
    /// the series is wanted for, so that no coefficient leaves the range of numbers; > 0.
    void expand(const double* y, double unit_s);

    /// For order 1 and a chain that starts at a pin and ends free: after the expansion at the end of a step
    /// of `last_s`, 0 for the first, gives the rates their slope of both ends in place of that of the first.
    /// Returns by how much at the most, 1/s; not finite where a slope is not.
    double correct(double last_s);

    /// For order 1: bound on the square of the largest frequency of small oscillations about the state that
    /// was expanded, 1/s^2.
    [[nodiscard]] double square_frequency_1_s2();

    /// For orders from 4: the time from there at which the last terms reach `tolerance` of a rate, 1/s, and
    /// the chain's own rate together; infinite where they are zero, 0 where a coefficient is not finite.
    [[nodiscard]] double reach_s(double tolerance);

    /// Writes the chain's part of the state at `time_s` after the one that was expanded to `y`.
    void evaluate(double time_s, double* y);

    /// The same without the rates and velocities, which positions do not need.
    void evaluate_places(double time_s, double* y);

  private:
    struct Code;  ///< a kernel's functions
    static const Code& code_of(SeriesKernel kernel);
    /// The value of a series at `t` in units.
    [[nodiscard]] double sum(const Series& series, double t) const;

    const Code* code_;
    std::size_t first_link_;
    std::size_t link_stride_;  ///< links of all chains: between c, s and w in a state
    std::size_t first_extra_;
    bool starts_pinned_;
    double rate_1_s_;
    double length_m_;
    SeriesArrays arrays_;
};

}  // namespace corda::sim
