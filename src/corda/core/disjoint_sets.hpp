#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace corda {

/// The numbers 0 .. count - 1 in disjoint sets, each named by its smallest number, at first one for each
/// (R. E. Tarjan, Efficiency of a good but not linear set union algorithm, J. ACM 22, 1975).
class DisjointSets {
  public:
    explicit DisjointSets(std::uint32_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }

    /// The set of a number.
    [[nodiscard]] std::uint32_t of(std::uint32_t k) {
        while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
        return k;
    }

    /// Unites the sets of two numbers; false if they are one already.
    bool join(std::uint32_t k, std::uint32_t l) {
        k = of(k);
        l = of(l);
        parent_[std::max(k, l)] = std::min(k, l);
        return k != l;
    }

  private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace corda
