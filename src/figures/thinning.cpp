#include "corda/figures/thinning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace corda::figures {
namespace {

constexpr std::int64_t kPointsPerBlock = 6;
/// Longer blocks may hold a whole turn of a path, at 60 rows per second and a turn in half a second.
constexpr std::int64_t kMaxRowsOfAPath = 24;

std::int64_t rows_per_block(std::int64_t rows, std::int64_t points_per_block) {
    if (rows <= Thinner::kMaxPoints) return 1;
    return (rows - 1) / ((Thinner::kMaxPoints - kPointsPerBlock) / points_per_block) + 1;
}

void sort_out(std::vector<CurvePoint>& points, std::size_t first) {
    const auto earlier = [](const CurvePoint& a, const CurvePoint& b) { return a.time_s < b.time_s; };
    const auto same = [](const CurvePoint& a, const CurvePoint& b) { return a.time_s == b.time_s; };
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, points.end(), earlier);
    points.erase(std::unique(begin, points.end(), same), points.end());
}

}  // namespace

Thinner::Thinner(std::int64_t rows, Kind kind)
    : is_sparse_(kind == Kind::kPath && rows_per_block(rows, kPointsPerBlock) > kMaxRowsOfAPath),
      block_rows_(rows_per_block(rows, is_sparse_ ? 1 : kPointsPerBlock)) {}

void Thinner::Block::include(const CurvePoint& point) {
    if (is_empty) first = left = right = low = high = point;
    is_empty = false;
    last = point;
    if (point.x < left.x) left = point;
    if (point.x > right.x) right = point;
    if (point.y < low.y) low = point;
    if (point.y > high.y) high = point;
}

void Thinner::add(const CurvePoint& point) {
    if (block_.rows++ == 0) block_.last.time_s = point.time_s;
    if (std::isfinite(point.x) && std::isfinite(point.y)) {
        block_.include(point);
        if (is_sparse_) all_.include(point);
    }
    if (block_.rows < block_rows_) return;
    end_block(points_);
    block_ = {};
}

void Thinner::end_block(std::vector<CurvePoint>& points) const {
    if (block_.rows == 0) return;
    const std::size_t before = points.size();
    if (block_.is_empty) {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        points.push_back({block_.last.time_s, kNone, kNone});
    } else if (is_sparse_) {
        points.push_back(block_.first);
    } else {
        points.insert(points.end(),
                      {block_.first, block_.left, block_.right, block_.low, block_.high, block_.last});
        sort_out(points, before);
    }
}

std::vector<CurvePoint> Thinner::points() const {
    std::vector<CurvePoint> all = points_;
    end_block(all);
    if (!all_.is_empty) {
        all.insert(all.end(), {all_.left, all_.right, all_.low, all_.high, all_.last});
        sort_out(all, 0);
    }
    return all;
}

}  // namespace corda::figures
