#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace corda::sweep {

/// Philox4x32-10, a counter-based generator: 128 random bits as a function of a counter and a key (Salmon,
/// Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11, 2011).
[[nodiscard]] std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                                  std::array<std::uint32_t, 2> key);

/// The random numbers of one quantity of one sample. They are a function of the arguments alone, so that
/// samples can be made in any order, and a further quantity does not change the others.
class Random {
  public:
    /// `quantity` counts by a hash of 32 bits: of n quantities, two have the same numbers with the
    /// probability n^2 / 2^33, 1e-8 for ten. `component`: of a vector quantity, 0 .. 2^16 - 1.
    Random(std::uint64_t seed, std::int64_t sample, std::string_view quantity, std::size_t component = 0);

    /// The next number, uniform in 0 <= u < 1, a multiple of 2^-53.
    [[nodiscard]] double uniform();
    /// A number from the standard normal distribution, by Marsaglia's polar method.
    [[nodiscard]] double normal();

  private:
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
};

// Functions of arithmetic and square roots alone, which have the same bits on every CPU; those of the C
// library differ with it.

/// The natural logarithm of a positive normal number, to 3 units in the last place.
[[nodiscard]] double log_of(double value);
/// `base` to a power 0 <= exponent < 1 that is a multiple of 2^-53, to 40 units in the last place. `base`: a
/// positive normal number.
[[nodiscard]] double power_of(double base, double exponent);
/// The angle of the vector (x, y) from the x axis in rad, -pi .. pi, to 6 units in the last place; 0 for the
/// zero vector. Requires that the square of its length neither overflows nor underflows.
[[nodiscard]] double angle_of(double x, double y);

}  // namespace corda::sweep
