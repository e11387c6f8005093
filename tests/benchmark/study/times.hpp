#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace corda::study {

/// How long the repeats of something took.
class Times {
  public:
    void add(double time) { times_.insert(std::ranges::upper_bound(times_, time), time); }

    [[nodiscard]] bool empty() const { return times_.empty(); }
    /// The middle one, or the mean of the two in the middle; 0 of none.
    [[nodiscard]] double median() const {
        if (empty()) return 0.0;
        const std::size_t half = times_.size() / 2;
        return times_.size() % 2 == 1 ? times_[half] : 0.5 * (times_[half - 1] + times_[half]);
    }
    [[nodiscard]] double least() const { return empty() ? 0.0 : times_.front(); }
    [[nodiscard]] double largest() const { return empty() ? 0.0 : times_.back(); }

    /// In another unit.
    [[nodiscard]] Times times(double factor) const {
        Times scaled;
        for (const double time : times_) scaled.add(factor * time);
        return scaled;
    }

  private:
    std::vector<double> times_;  ///< ascending
};

}  // namespace corda::study
