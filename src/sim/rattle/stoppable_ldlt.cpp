#include "corda/sim/rattle/stoppable_ldlt.hpp"

namespace corda::sim {
namespace {

/// Products that take as long as one update of a StopCheck.
constexpr std::uint64_t kProductsPerUpdate = 64;

}  // namespace

int StoppableLdlt::scatter(const Eigen::SparseMatrix<double>& upper, int k) {
    int top = static_cast<int>(upper.cols());
    row_[k] = 0.0;
    visited_by_[k] = k;
    for (Eigen::SparseMatrix<double>::InnerIterator it(upper, k); it; ++it) {
        int i = static_cast<int>(it.index());
        if (i > k) continue;
        row_[i] += it.value();
        int length = 0;
        for (; visited_by_[i] != k; i = m_parent[i]) {
            pattern_[length++] = i;
            visited_by_[i] = k;
        }
        while (length > 0) pattern_[--top] = pattern_[--length];
    }
    return top;
}

bool StoppableLdlt::factorize(const Eigen::SparseMatrix<double>& lower, StopCheck& stop) {
    const int size = static_cast<int>(lower.cols());
    Eigen::SparseMatrix<double> upper(size, size);
    upper.selfadjointView<Eigen::Upper>() = lower.selfadjointView<Eigen::Lower>().twistedBy(m_P);
    row_.resize(size);
    pattern_.resize(size);
    visited_by_.resize(size);
    m_diag.resize(size);
    m_info = Eigen::NumericalIssue;
    const int* const begin = m_matrix.outerIndexPtr();
    int* const index = m_matrix.innerIndexPtr();
    double* const value = m_matrix.valuePtr();
    double* const row = row_.data();
    for (int k = 0; k < size; ++k) {
        int top = scatter(upper, k);
        m_nonZerosPerCol[k] = 0;
        std::uint64_t products = 0;
        double pivot = row[k];
        row[k] = 0.0;
        for (; top < size; ++top) {
            const int i = pattern_[top];
            const double entry = row[i];
            row[i] = 0.0;
            const double factor = entry / m_diag[i];
            const int end = begin[i] + m_nonZerosPerCol[i];
            for (int p = begin[i]; p < end; ++p) row[index[p]] -= value[p] * entry;
            pivot -= factor * entry;
            index[end] = k;
            value[end] = factor;
            products += static_cast<std::uint64_t>(++m_nonZerosPerCol[i]);
        }
        m_diag[k] = pivot;
        if (pivot == 0.0) return false;
        stop.spend(1 + products / kProductsPerUpdate);
    }
    m_info = Eigen::Success;
    m_factorizationIsOk = true;
    return true;
}

}  // namespace corda::sim
