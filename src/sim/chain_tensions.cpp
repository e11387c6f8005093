#include "corda/sim/chain_tensions.hpp"

namespace corda::sim {

void solve_tensions(const TensionMatrix& matrix, const double* right, double* __restrict pivot,
                    double* __restrict weight, double* tension) {
    const std::size_t count = matrix.count;
    const double* const inverse_mass = matrix.inverse_mass;
    const double* const cosine = matrix.cosine;
    const double* const sine = matrix.sine;
    InverseMassFraction beyond{inverse_mass[count - 1]};
    double load = right[count - 1];  // of the row, times q
    for (std::size_t i = count - 1; i > 0; --i) {
        const double before = inverse_mass[i - 1];
        const double divisor = beyond.divisor(before);
        pivot[i] = divisor;
        weight[i] = beyond.q;
        tension[i] = load;
        load = right[i - 1] * divisor + cosine[i - 1] * load;
        const double scale = beyond.pass(before, sine[i - 1] * sine[i - 1], divisor);
        if (scale != 1.0) load *= scale;
    }
    tension[0] = load / beyond.divisor(matrix.first_inverse_mass);
    for (std::size_t i = 1; i < count; ++i) {
        const double inverse = 1.0 / pivot[i];
        tension[i] *= inverse;
        weight[i] *= cosine[i - 1] * inverse;
    }
    for (std::size_t i = 1; i < count; ++i) tension[i] += weight[i] * tension[i - 1];
}

}  // namespace corda::sim
