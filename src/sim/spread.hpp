#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::sim {

/// What a state must have for a quantity to be read from it.
[[nodiscard]] StateFields readings_for(Quantity quantity);

/// A quantity of bar `k` of a body; NaN if it is not known. The state has readings_for(quantity).
[[nodiscard]] double value_of(Quantity quantity, const System& system, const Body& body, std::size_t k,
                              const State& state);

/// How values are spread: their least and largest, and how many of them are larger than a bound. NaN does not
/// count.
class Spread {
  public:
    void add(double value);
    void add(const Spread& other);

    [[nodiscard]] bool empty() const { return count_ == 0; }
    [[nodiscard]] double least() const { return least_; }
    [[nodiscard]] double largest() const { return largest_; }
    /// The least bound that at most this share of the sizes of all values exceeds, to within 1/16.
    [[nodiscard]] double size_exceeded_by(double share) const;

  private:
    std::uint64_t count_ = 0;
    double least_ = std::numeric_limits<double>::infinity();
    double largest_ = -std::numeric_limits<double>::infinity();
    /// How many there are by the first 16 bits of their sizes: the exponent and a sixteenth of it.
    std::vector<std::uint64_t> counts_;
};

}  // namespace corda::sim
