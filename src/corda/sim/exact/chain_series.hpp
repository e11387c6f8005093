#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/exact.hpp"

namespace corda::sim {

inline constexpr std::size_t kMaxSeriesOrder = 20;

/// Links of a block, on which a ChainSeries works together.
inline constexpr std::size_t kSeriesLanes = 4;

/// Coefficients of a power series in time.
using Series = std::array<double, kMaxSeriesOrder + 1>;

/// The memory of a ChainSeries. Links are kept in blocks of kSeriesLanes; the last block is padded with
/// zeros. A joint has the index of the link before it. Arrays with one entry per link have some room at both
/// ends. Layout: section 6 of src/corda/sim/exact/README.md.
struct SeriesArrays {
    /// A block has a row of coefficients for each of these series.
    enum Row : std::size_t {
        kCosine,       ///< W C of a joint
        kSine,         ///< W S of a joint
        kTension,      ///< T of a link
        kNextTension,  ///< T of the next link
        kOmega,        ///< angular velocity w of a link
        kOpening,      ///< w of the next link less w of the link
        kRows
    };
    /// A uniform acceleration and its coefficients 1 .. `changes`.
    struct Pull {
        Vec2 first;
        std::size_t changes = 0;
        std::array<Vec2, kMaxSeriesOrder + 1> term{};
    };
    /// Of a link.
    struct Direction {
        Series c{};
        Series s{};
    };
    struct alignas(kSeriesLanes * sizeof(double)) Lanes {
        std::array<double, kSeriesLanes> lane{};
    };

    std::size_t order = 0;  ///< of the series of w
    std::size_t links = 0;
    std::size_t blocks = 0;
    std::size_t meeting = 0;  ///< link at which the eliminations from both ends meet; the first of a block
    double drag_1_s = 0.0;
    double first_inverse_mass_1_kg = 0.0;  ///< of the particle at the chain's start
    Pull start_pull_m_s2;                  ///< the uniform acceleration if the start is pinned, else 0
    Pull end_pull_m_s2;                    ///< the same if the end is pinned
    Pull fall_m_s2;                        ///< the same if the start is not pinned
    double unit_s = 1.0;                   ///< unit of time: coefficient k belongs to (t / unit_s)^k

    Direction first_link{};
    Direction last_link{};
    Series vx{}, vy{}, x{}, y{};  ///< velocity and place of the centre of mass of a free chain

    std::vector<Lanes> rows;  ///< kRows series of order + 1 coefficients per block
    std::vector<Lanes> flat;  ///< holds the arrays from here on
    double* length_m = nullptr;
    double* inverse_length_1_m = nullptr;
    double* inverse_mass_1_kg = nullptr;  ///< of the particle at a link's far end
    double* c = nullptr;                  ///< at t = 0, as are s and omega
    double* s = nullptr;
    double* omega = nullptr;
    double* inverse_pivot = nullptr;
    double* weight = nullptr;  ///< of a joint: factor by which a link's row or tension enters its neighbour's
    double* load = nullptr;    ///< right-hand sides of the tensions
    double* across_next = nullptr;   ///< known part of the pull of a link across the next one
    double* across_after = nullptr;  ///< known part of the pull of the next link across a link
    double* tension = nullptr;
    double* scratch = nullptr;

    [[nodiscard]] double* row(std::size_t block, Row which, std::size_t k) {
        return rows[(block * kRows + which) * (order + 1) + k].lane.data();
    }
};

/// True if this CPU has AVX2, for which a series is compiled too: four links per instruction, and the same
/// bits.
[[nodiscard]] bool has_wide_series();

/// The motion of one of some chains as a power series in time: sections 3 to 8 of
/// src/corda/sim/exact/README.md. The tridiagonal matrix of the tensions is the same for all coefficients and
/// is factorised once per step, from both ends.
///
/// Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer
/// 1993, I.8 (recursive computation of coefficients); A. Jorba, M. Zou, Experimental Mathematics 14 (2005)
/// 99-117 (steps from the last coefficients).
class ChainSeries {
  public:
    /// `order`: of the series of w, 4 .. kMaxSeriesOrder (a ChainPart takes 12 and more). `chain`: one of
    /// `chains`.
    ChainSeries(const Chains& chains, const Chain& chain, std::size_t order,
                bool is_wide = has_wide_series());
    // Pointers lead into the arrays' own memory: it can be moved, but a copy would not be independent.
    ChainSeries(const ChainSeries&) = delete;
    ChainSeries& operator=(const ChainSeries&) = delete;
    ChainSeries(ChainSeries&&) = default;
    ChainSeries& operator=(ChainSeries&&) = delete;
    ~ChainSeries() = default;

    /// Expands the motion that starts at `time_s` from the chain's part of the state `y`. `unit_s` (> 0):
    /// about the time for which the series is needed, so that no coefficient overflows.
    void expand(const double* y, double unit_s, double time_s = 0.0);

    /// The time after which the last terms exceed `tolerance` of the angular velocity and the inverse of the
    /// chain's time scale together; infinite if the terms are zero, 0 if a coefficient is not finite.
    [[nodiscard]] double longest_step_s(double tolerance);

    /// Writes to `y` the chain's part of the state `time_s` after the expanded state.
    void evaluate(double time_s, double* y);

  private:
    struct Code;  ///< the functions of a width
    static const Code& code_of(bool is_wide);
    /// The value of a series at the time `t` in units of unit_s.
    [[nodiscard]] double sum(const Series& series, double t) const;

    const Code* code_;
    const Forces* start_forces_;  ///< seen from the chain's start
    const Forces* end_forces_;
    std::size_t first_link_;
    std::size_t link_stride_;  ///< number of links of all chains: distance of c, s and w in a state
    std::size_t first_extra_;
    bool starts_pinned_;
    bool ends_pinned_;
    double inverse_timescale_1_s_;
    double length_m_;
    SeriesArrays arrays_;
};

/// A rope of rigid links, integrated by Taylor series in time. Pins cut it into chains, each of which takes
/// steps of its own.
///
/// The length of a step follows from the last terms of its series, and the series is the motion at all times
/// within the step. Steps depend on the start alone, never on the requested times, so the bits are always the
/// same.
class ChainPart final : public Exact {
  public:
    /// Requires one body, a chain. Throws what make_chains() throws.
    ChainPart(const System& system, const Forces& forces, double tolerance);

    [[nodiscard]] std::uint64_t steps() const override;

  private:
    struct Mover {
        const Chain& chain;
        ChainSeries series;
        StepControl control;
        double start_s = 0.0;  ///< of the step that the series is for
        double end_s = 0.0;
        std::uint64_t steps = 0;
    };

    [[nodiscard]] Dynamics& dynamics() const override { return dynamics_; }
    Status reach(double time_s, State& state) override;
    Status step(Mover& mover);
    /// The length of a step of a chain between two pins that does not end near a line of all its links.
    [[nodiscard]] double past_line(Mover& mover, double step_s);

    mutable ChainDynamics dynamics_;  ///< only its scratch memory changes
    std::vector<double> state_;       ///< each chain at the end of its last step
    std::vector<double> ahead_;       ///< scratch of past_line()
    std::vector<Mover> movers_;
};

}  // namespace corda::sim
