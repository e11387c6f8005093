#include "corda/sim/sparse_ldlt.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <limits>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"

namespace corda::sim {
namespace {

constexpr std::uint32_t kNoColumn = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kColumnsAtATime = 4;

/// Subtracts columns[c][r] factor[c] from to[r], from the first of up to kColumnsAtATime columns to the last
/// one, for all r < rows.
CORDA_AVX2_CLONES void subtract_columns(const double* const* columns, const double* factor,
                                        std::uint32_t count, std::size_t rows, double* __restrict to) {
    if (count < kColumnsAtATime) {
        for (std::uint32_t c = 0; c < count; ++c) {
            const double* const column = columns[c];
            const double times = factor[c];
            for (std::size_t r = 0; r < rows; ++r) to[r] -= column[r] * times;
        }
        return;
    }
    const double* const a = columns[0];
    const double* const b = columns[1];
    const double* const c = columns[2];
    const double* const d = columns[3];
    const double times_a = factor[0];
    const double times_b = factor[1];
    const double times_c = factor[2];
    const double times_d = factor[3];
    for (std::size_t r = 0; r < rows; ++r)
        to[r] = (((to[r] - a[r] * times_a) - b[r] * times_b) - c[r] * times_c) - d[r] * times_d;
}

std::uint32_t narrow(std::size_t k) {
    return static_cast<std::uint32_t>(k);
}

}  // namespace

void SparseLdlt::analyse(const Eigen::SparseMatrix<double>& lower) {
    order(lower);
    find_columns();
    find_runs();
    const std::size_t size = place_.size();
    filled_.assign(size, 0);
    row_.assign(size, 0.0);
    pivot_.assign(size, 0.0);
    value_.assign(begin_.back(), 0.0);
    gathered_.assign(size, 0.0);
    solution_.assign(size, 0.0);
}

void SparseLdlt::order(const Eigen::SparseMatrix<double>& lower) {
    const auto size = static_cast<std::size_t>(lower.cols());
    const Eigen::SparseMatrix<double> full = lower.selfadjointView<Eigen::Lower>();
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> row_at;
    Eigen::AMDOrdering<int>()(full, row_at);
    place_.resize(size);
    for (std::size_t k = 0; k < size; ++k)
        place_[static_cast<std::size_t>(row_at.indices()[static_cast<Eigen::Index>(k)])] = narrow(k);
    const auto for_each_entry = [&](const auto& use) {
        std::uint32_t entry = 0;
        for (Eigen::Index column = 0; column < lower.cols(); ++column) {
            for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it, ++entry) {
                const std::uint32_t a = place_[static_cast<std::size_t>(it.row())];
                const std::uint32_t b = place_[static_cast<std::size_t>(column)];
                use(std::max(a, b), std::min(a, b), entry);
            }
        }
    };
    source_begin_.assign(size + 1, 0);
    for_each_entry([&](std::uint32_t row, std::uint32_t, std::uint32_t) { ++source_begin_[row + 1]; });
    for (std::size_t k = 0; k < size; ++k) source_begin_[k + 1] += source_begin_[k];
    source_.resize(source_begin_.back());
    std::vector<std::uint32_t> next(source_begin_.begin(), source_begin_.end() - 1);
    for_each_entry([&](std::uint32_t row, std::uint32_t column, std::uint32_t entry) {
        source_[next[row]++] = {column, entry};
    });
}

void SparseLdlt::find_columns() {
    const std::size_t size = place_.size();
    parent_.assign(size, kNoColumn);
    begin_.assign(size + 1, 0);
    std::vector<std::uint32_t> visited_by(size, kNoColumn);
    for (std::uint32_t k = 0; k < size; ++k) {
        visited_by[k] = k;
        for (std::uint32_t s = source_begin_[k]; s < source_begin_[k + 1]; ++s) {
            for (std::uint32_t i = source_[s].column; visited_by[i] != k; i = parent_[i]) {
                if (parent_[i] == kNoColumn) parent_[i] = k;
                visited_by[i] = k;
                ++begin_[i + 1];
            }
        }
    }
    for (std::size_t k = 0; k < size; ++k) begin_[k + 1] += begin_[k];
}

void SparseLdlt::find_runs() {
    const std::size_t size = place_.size();
    index_.resize(begin_.back());
    runs_.clear();
    run_begin_.assign(1, 0);
    std::vector<std::uint32_t> visited_by(size, kNoColumn);
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    std::vector<std::uint32_t> path;
    std::vector<std::uint32_t> pattern(size);
    const auto length = [this](std::uint32_t column) { return begin_[column + 1] - begin_[column]; };
    for (std::uint32_t k = 0; k < size; ++k) {
        std::size_t top = size;
        visited_by[k] = k;
        for (std::uint32_t s = source_begin_[k]; s < source_begin_[k + 1]; ++s) {
            for (std::uint32_t i = source_[s].column; visited_by[i] != k; i = parent_[i]) {
                path.push_back(i);
                visited_by[i] = k;
            }
            for (; !path.empty(); path.pop_back()) pattern[--top] = path.back();
        }
        for (std::size_t t = top; t < size; ++t) {
            const std::uint32_t i = pattern[t];
            index_[next[i]++] = k;
            const bool continues =
                t > top && pattern[t - 1] + 1 == i && parent_[i - 1] == i && length(i - 1) == length(i) + 1;
            if (continues)
                ++runs_.back().count;
            else
                runs_.push_back({i, 1});
        }
        run_begin_.push_back(narrow(runs_.size()));
    }
}

bool SparseLdlt::factorise(const double* entries) {
    constexpr std::uint64_t kProductsPerUpdate = 64;
    std::fill(filled_.begin(), filled_.end(), 0U);
    std::fill(row_.begin(), row_.end(), 0.0);
    for (std::size_t k = 0; k < place_.size(); ++k) {
        for (std::uint32_t s = source_begin_[k]; s < source_begin_[k + 1]; ++s)
            row_[source_[s].column] = entries[source_[s].entry];
        double diagonal = std::exchange(row_[k], 0.0);
        std::uint64_t products = 0;
        for (std::uint32_t t = run_begin_[k]; t < run_begin_[k + 1]; ++t)
            products += eliminate(runs_[t], diagonal);
        pivot_[k] = diagonal;
        if (diagonal == 0.0) return false;
        count_work(1 + products / kProductsPerUpdate);
    }
    return true;
}

std::uint64_t SparseLdlt::eliminate(const Run& run, double& diagonal) {
    const std::uint32_t last = run.first + run.count - 1;
    const std::uint32_t below = filled_[last];
    const std::uint32_t* const at = index_.data() + begin_[last];
    // A column's rows are the next ones of the run, then those that all have.
    double* const row = gathered_.data();
    for (std::uint32_t c = 0; c < run.count; ++c) row[c] = std::exchange(row_[run.first + c], 0.0);
    for (std::uint32_t r = 0; r < below; ++r) row[run.count + r] = row_[at[r]];
    for (std::uint32_t c = 0; c < run.count; c += kColumnsAtATime) {
        const std::uint32_t count = std::min(kColumnsAtATime, run.count - c);
        const double* columns[kColumnsAtATime];
        for (std::uint32_t d = 0; d < count; ++d) {
            const std::uint32_t i = run.first + c + d;
            double* const value = value_.data() + begin_[i];
            const double entry = row[c + d];
            for (std::uint32_t e = d + 1; e < count; ++e) row[c + e] -= value[e - d - 1] * entry;
            columns[d] = value + (count - 1 - d);
            const double quotient = entry / pivot_[i];
            diagonal -= quotient * entry;
            value[filled_[i]++] = quotient;
        }
        subtract_columns(columns, row + c, count, run.count + below - (c + count), row + c + count);
    }
    for (std::uint32_t r = 0; r < below; ++r) row_[at[r]] = row[run.count + r];
    return std::uint64_t{run.count} * (run.count + below);
}

void SparseLdlt::solve(double* x) {
    const std::size_t size = place_.size();
    double* const y = solution_.data();
    for (std::size_t i = 0; i < size; ++i) y[place_[i]] = x[i];
    for (std::size_t i = 0; i < size; ++i) {
        for (std::uint32_t p = begin_[i]; p < begin_[i + 1]; ++p) y[index_[p]] -= value_[p] * y[i];
    }
    for (std::size_t i = 0; i < size; ++i) y[i] *= 1.0 / pivot_[i];
    for (std::size_t i = size; i-- > 0;) {
        double rest = y[i];
        for (std::uint32_t p = begin_[i]; p < begin_[i + 1]; ++p) rest -= value_[p] * y[index_[p]];
        y[i] = rest;
    }
    for (std::size_t i = 0; i < size; ++i) x[i] = y[place_[i]];
}

}  // namespace corda::sim
