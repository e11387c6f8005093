#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/view/plot_panel.hpp"

namespace corda::figures {

using view::CurvePoint;

/// Keeps few points of a long curve, with all its extremes: of each block of rows of equal length, the first,
/// the last, and those with the extremes of x and y. Memory does not grow with the number of rows.
///
/// A path is not a function of time: if blocks are long, lines between its extremes would cross the area that
/// it goes around. Then only the first row of each block is kept, as a dot, and the extremes of all rows.
class Thinner {
  public:
    enum class Kind { kOverTime, kPath };

    /// Largest number of points of a curve.
    static constexpr std::int64_t kMaxPoints = 2000;

    /// `rows`: how many will be added at most. Up to kMaxPoints all stay.
    explicit Thinner(std::int64_t rows, Kind kind = Kind::kOverTime);

    /// A point that is not finite breaks the curve if no other of its block is left.
    void add(const CurvePoint& point);
    /// The remaining points, in the order in which they were added.
    [[nodiscard]] std::vector<CurvePoint> points() const;
    /// Whether lines between the points are the curve; otherwise it is dots.
    [[nodiscard]] bool is_joined() const { return !is_sparse_; }

  private:
    /// The rows of a block that stay, each the first one of its kind.
    struct Block {
        std::int64_t rows = 0;
        bool is_empty = true;
        CurvePoint first, last, left, right, low, high;

        void include(const CurvePoint& point);
    };
    void end_block(std::vector<CurvePoint>& points) const;

    bool is_sparse_;
    std::int64_t block_rows_;
    Block block_;
    Block all_;
    std::vector<CurvePoint> points_;
};

}  // namespace corda::figures
