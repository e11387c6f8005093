#include "corda/sim/sparse_ldlt.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <limits>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/four.hpp"

namespace corda::sim {
namespace {

using Block = SparseLdlt::Block;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kColumnsAtATime = 4;
/// A block takes one more column if at most this share of its entries are zeros then.
constexpr double kMaxZeros = 0.3;

std::uint32_t narrow(std::size_t k) {
    return static_cast<std::uint32_t>(k);
}

/// Calls use(row, column, number) for each entry of a lower triangle after a permutation, row >= column.
template <class Use>
void for_each_entry(const Eigen::SparseMatrix<double>& lower, const std::vector<std::uint32_t>& place,
                    const Use& use) {
    std::uint32_t entry = 0;
    for (Eigen::Index column = 0; column < lower.cols(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it, ++entry) {
            const std::uint32_t a = place[static_cast<std::size_t>(it.row())];
            const std::uint32_t b = place[static_cast<std::size_t>(column)];
            use(std::max(a, b), std::min(a, b), entry);
        }
    }
}

/// For each column of L the next one that it changes: its first row below the diagonal (J. Liu, SIAM Journal
/// on Matrix Analysis and Applications 11 (1990) 134). kNone: none.
std::vector<std::uint32_t> elimination_tree(const std::vector<std::vector<std::uint32_t>>& columns_of_row) {
    std::vector<std::uint32_t> parent(columns_of_row.size(), kNone);
    std::vector<std::uint32_t> ancestor = parent;
    for (std::uint32_t row = 0; row < parent.size(); ++row) {
        for (std::uint32_t column : columns_of_row[row]) {
            while (column < row) {
                const std::uint32_t up = std::exchange(ancestor[column], row);
                if (up == kNone) parent[column] = row;
                column = up;
            }
        }
    }
    return parent;
}

/// Places in an order in which each column follows all those of its subtree.
std::vector<std::uint32_t> postorder(const std::vector<std::uint32_t>& parent) {
    std::vector<std::vector<std::uint32_t>> children(parent.size());
    std::vector<std::uint32_t> to_do;
    for (std::uint32_t k = 0; k < parent.size(); ++k)
        (parent[k] == kNone ? to_do : children[parent[k]]).push_back(k);
    std::vector<std::uint32_t> place(parent.size());
    std::uint32_t next = narrow(parent.size());
    while (!to_do.empty()) {  // from the last place on
        const std::uint32_t k = to_do.back();
        to_do.pop_back();
        place[k] = --next;
        to_do.insert(to_do.end(), children[k].begin(), children[k].end());
    }
    return place;
}

/// The columns of a block, and what they change in those of the rows below.
struct Front {
    const Block& block;
    double* value;
    double* update;
    double* pivot;
    double* inverse_pivot;
};

/// Subtracts from each of kTargets columns kColumns columns, one after the other, each times a factor, in
/// whole Fours of rows.
template <std::uint32_t kColumns, std::uint32_t kTargets>
CORDA_INLINE void subtract(const double* from, std::size_t stride, const double (*factor)[kTargets],
                           std::size_t begin, std::size_t end, double* to, std::size_t to_stride) {
    for (std::size_t r = begin; r < end; r += kFour) {
        Four rest[kTargets];
        for (std::uint32_t t = 0; t < kTargets; ++t) rest[t] = any_four(to + t * to_stride + r).value;
        for (std::uint32_t c = 0; c < kColumns; ++c) {
            const Four column = any_four(from + c * stride + r).value;
            for (std::uint32_t t = 0; t < kTargets; ++t) rest[t] -= column * factor[c][t];
        }
        for (std::uint32_t t = 0; t < kTargets; ++t) any_four(to + t * to_stride + r).value = rest[t];
    }
}

/// Subtracts kColumns columns, from which those before have been subtracted, from kTargets later ones. The
/// diagonal of the first of these is in row `row`.
template <std::uint32_t kColumns, std::uint32_t kTargets>
CORDA_INLINE void eliminate_from(const Front& front, std::uint32_t first, std::uint32_t row) {
    const auto& [block, value, update, pivot, inverse_pivot] = front;
    const double* const from = value + first * block.stride;
    double factor[kColumns][kTargets];
    for (std::uint32_t c = 0; c < kColumns; ++c)
        for (std::uint32_t t = 0; t < kTargets; ++t)
            factor[c][t] = from[c * block.stride + row + t] * inverse_pivot[first + c];
    // Whole Fours reach above the diagonal, where entries do not matter.
    if (row < block.columns) {
        subtract<kColumns, kTargets>(from, block.stride, factor, down_to_four(row), block.stride,
                                     value + row * block.stride, block.stride);
    } else {
        const std::uint32_t k = row - block.columns;
        subtract<kColumns, kTargets>(from + block.columns, block.stride, factor, down_to_four(k),
                                     block.update_stride, update + k * block.update_stride,
                                     block.update_stride);
    }
}

template <std::uint32_t kColumns>
CORDA_INLINE void eliminate_columns(const Front& front, std::uint32_t first) {
    const auto& [block, value, update, pivot, inverse_pivot] = front;
    for (std::uint32_t c = first; c < first + kColumns; ++c) {
        pivot[c] = value[c * block.stride + c];
        inverse_pivot[c] = 1.0 / pivot[c];
        for (std::uint32_t later = c + 1; later < first + kColumns; ++later)
            eliminate_from<1, 1>(front, c, later);
    }
    std::uint32_t row = first + kColumns;
    for (; row < block.columns; ++row) eliminate_from<kColumns, 1>(front, first, row);
    for (; row + 1 < block.columns + block.below; row += 2) eliminate_from<kColumns, 2>(front, first, row);
    if (row < block.columns + block.below) eliminate_from<kColumns, 1>(front, first, row);
}

/// Eliminates up to kColumnsAtATime columns of a block from those that follow.
CORDA_AVX2_CLONES void eliminate(const Front& front, std::uint32_t first) {
    const std::uint32_t columns = front.block.columns - first;
    if (columns >= kColumnsAtATime) eliminate_columns<kColumnsAtATime>(front, first);
    if (columns == 3) eliminate_columns<3>(front, first);
    if (columns == 2) eliminate_columns<2>(front, first);
    if (columns == 1) eliminate_columns<1>(front, first);
}

/// Divides the columns of a block by their pivots: below the diagonal, they are those of L then.
CORDA_AVX2_CLONES void divide_by_pivots(const Front& front) {
    const std::size_t stride = front.block.stride;
    for (std::uint32_t c = 0; c < front.block.columns; ++c) {
        double* const column = front.value + c * stride;
        const double inverse = front.inverse_pivot[c];
        for (std::size_t r = down_to_four(c); r < stride; r += kFour) any_four(column + r).value *= inverse;
    }
}

/// Solves for the columns of a block, from the first to the last, and subtracts them from the rows below.
CORDA_AVX2_CLONES void solve_lower(const Block& block, const double* value, const std::uint32_t* row,
                                   double* y) {
    double* const own = y + block.first;
    for (std::uint32_t c = 0; c < block.columns; ++c) {
        const double* const column = value + c * block.stride;
        for (std::uint32_t r = c + 1; r < block.columns; ++r) own[r] -= column[r] * own[c];
    }
    value += block.columns;
    for (std::size_t r = 0; r < block.below; r += kFour) {
        Four sum{};
        for (std::uint32_t c = 0; c < block.columns; ++c)
            sum += any_four(value + c * block.stride + r).value * own[c];
        for (std::size_t lane = 0; lane < kFour; ++lane) y[row[r + lane]] -= sum[lane];
    }
}

/// Subtracts from kColumns of a block's own rows what they get from the rows below.
template <std::uint32_t kColumns>
CORDA_INLINE void subtract_below(const Block& block, const double* value, const std::uint32_t* row,
                                 std::uint32_t first, double* y) {
    const double* const from = value + first * block.stride + block.columns;
    Four sum[kColumns] = {};
    for (std::size_t r = 0; r < block.below; r += kFour) {
        const Four below{y[row[r]], y[row[r + 1]], y[row[r + 2]], y[row[r + 3]]};
        for (std::uint32_t c = 0; c < kColumns; ++c)
            sum[c] += any_four(from + c * block.stride + r).value * below;
    }
    for (std::uint32_t c = 0; c < kColumns; ++c)
        y[block.first + first + c] -= (sum[c][0] + sum[c][1]) + (sum[c][2] + sum[c][3]);
}

/// Solves for the columns of a block, from the last to the first, given the rows below.
CORDA_AVX2_CLONES void solve_upper(const Block& block, const double* value, const std::uint32_t* row,
                                   double* y) {
    std::uint32_t c = 0;
    for (; c + kColumnsAtATime <= block.columns; c += kColumnsAtATime)
        subtract_below<kColumnsAtATime>(block, value, row, c, y);
    for (; c < block.columns; ++c) subtract_below<1>(block, value, row, c, y);
    double* const own = y + block.first;
    while (c-- > 0) {
        const double* const column = value + c * block.stride;
        for (std::uint32_t r = c + 1; r < block.columns; ++r) own[c] -= column[r] * own[r];
    }
}

}  // namespace

void SparseLdlt::analyse(const Eigen::SparseMatrix<double>& lower) {
    order(lower);
    find_blocks(lower);
    find_parents();
    find_memory();
    find_sources(lower);
}

void SparseLdlt::order(const Eigen::SparseMatrix<double>& lower) {
    const auto size = static_cast<std::size_t>(lower.cols());
    const Eigen::SparseMatrix<double> full = lower.selfadjointView<Eigen::Lower>();
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> row_at;
    Eigen::AMDOrdering<int>()(full, row_at);
    place_.resize(size);
    for (std::size_t k = 0; k < size; ++k)
        place_[static_cast<std::size_t>(row_at.indices()[static_cast<Eigen::Index>(k)])] = narrow(k);
    std::vector<std::vector<std::uint32_t>> columns_of_row(size);
    for_each_entry(lower, place_, [&](std::uint32_t row, std::uint32_t column, std::uint32_t) {
        columns_of_row[row].push_back(column);
    });
    const std::vector<std::uint32_t> post = postorder(elimination_tree(columns_of_row));
    for (std::uint32_t& place : place_) place = post[place];
}

void SparseLdlt::find_blocks(const Eigen::SparseMatrix<double>& lower) {
    const std::size_t size = place_.size();
    // Rows below each column: those of the matrix, and those of the columns whose parent it is.
    std::vector<std::vector<std::uint32_t>> rows(size);
    for_each_entry(lower, place_, [&](std::uint32_t row, std::uint32_t column, std::uint32_t) {
        if (row != column) rows[column].push_back(row);
    });
    blocks_.clear();
    row_.clear();
    block_of_.resize(size);
    std::size_t zeros = 0;  // in the last block
    for (std::uint32_t k = 0; k < size; ++k) {
        std::vector<std::uint32_t>& own = rows[k];
        std::ranges::sort(own);
        own.erase(std::unique(own.begin(), own.end()), own.end());
        const bool follows = k > 0 && !rows[k - 1].empty() && rows[k - 1].front() == k;
        const std::size_t before = follows ? blocks_.back().columns : 0;
        const std::size_t more = follows ? before * (own.size() + 1 - rows[k - 1].size()) : 0;
        const std::size_t all = (before + 1) * own.size() + (before + 1) * (before + 2) / 2;
        zeros += more;
        if (!follows || static_cast<double>(zeros) > kMaxZeros * static_cast<double>(all)) {
            zeros = 0;
            blocks_.push_back({.first = k, .begin = narrow(row_.size())});
        }
        Block& block = blocks_.back();
        ++block.columns;
        block.below = narrow(own.size());
        block_of_[k] = narrow(blocks_.size() - 1);
        row_.resize(block.begin);
        row_.insert(row_.end(), own.begin(), own.end());
        row_.resize(block.begin + up_to_four(own.size()), k);
        if (k > 0) rows[k - 1] = {};
        if (!own.empty()) {
            std::vector<std::uint32_t>& parent = rows[own.front()];
            parent.insert(parent.end(), own.begin() + 1, own.end());
        }
    }
}

void SparseLdlt::find_parents() {
    for (Block& block : blocks_) block.child = block.next = kNone;
    to_.assign(row_.size(), 0);
    std::vector<std::uint32_t> number(place_.size());
    for (std::uint32_t b = narrow(blocks_.size()); b-- > 0;) {
        Block& block = blocks_[b];
        if (block.below == 0) continue;
        Block& parent = blocks_[block_of_[row_[block.begin]]];
        block.stack = 1 - parent.stack;
        block.next = std::exchange(parent.child, b);
        for (std::uint32_t r = 0; r < parent.columns; ++r) number[parent.first + r] = r;
        for (std::uint32_t r = 0; r < parent.below; ++r) number[row_[parent.begin + r]] = parent.columns + r;
        for (std::uint32_t r = block.begin; r < block.begin + block.below; ++r) to_[r] = number[row_[r]];
    }
}

void SparseLdlt::find_memory() {
    std::size_t values = 0;
    std::array<std::size_t, 2> top{};
    std::array<std::size_t, 2> size{};
    for (Block& block : blocks_) {
        block.update_stride = up_to_four(block.below);
        block.stride = up_to_four(block.columns + block.update_stride);
        block.value = values;
        values += block.stride * block.columns;
        block.update = top[block.stack];
        top[block.stack] += block.update_stride * block.below;
        size[block.stack] = std::max(size[block.stack], top[block.stack]);
        if (block.child != kNone) top[1 - block.stack] = blocks_[block.child].update;
    }
    value_.assign(values, 0.0);
    for (const std::size_t i : {0, 1}) stack_[i].assign(size[i], 0.0);
    pivot_.assign(place_.size(), 0.0);
    inverse_pivot_.assign(place_.size(), 0.0);
    solution_.assign(place_.size(), 0.0);
}

void SparseLdlt::find_sources(const Eigen::SparseMatrix<double>& lower) {
    source_.clear();
    for_each_entry(lower, place_, [&](std::uint32_t row, std::uint32_t column, std::uint32_t entry) {
        const Block& block = blocks_[block_of_[column]];
        std::size_t at = row - block.first;
        if (at >= block.columns) {
            const std::uint32_t* const below = row_.data() + block.begin;
            at = block.columns +
                 static_cast<std::size_t>(std::lower_bound(below, below + block.below, row) - below);
        }
        source_.push_back({entry, block.value + (column - block.first) * block.stride + at});
    });
}

bool SparseLdlt::factorise(const double* entries) {
    constexpr std::uint64_t kProductsPerUpdate = 128;
    std::fill(value_.begin(), value_.end(), 0.0);
    for (const auto& [entry, value] : source_) value_[value] = entries[entry];
    for (const Block& block : blocks_) {
        add_updates(block);
        double* const pivot = pivot_.data() + block.first;
        const Front front{block, value_.data() + block.value, stack_[block.stack].data() + block.update,
                          pivot, inverse_pivot_.data() + block.first};
        for (std::uint32_t c = 0; c < block.columns; c += kColumnsAtATime) {
            eliminate(front, c);
            const std::uint64_t rows = block.columns - c + block.below;
            count_work(1 + kColumnsAtATime * rows * rows / 2 / kProductsPerUpdate);
        }
        divide_by_pivots(front);
        if (std::find(pivot, pivot + block.columns, 0.0) != pivot + block.columns) return false;
    }
    return true;
}

void SparseLdlt::add_updates(const Block& block) {
    double* const update = stack_[block.stack].data() + block.update;
    std::fill_n(update, block.update_stride * block.below, 0.0);
    for (std::uint32_t b = block.child; b != kNone; b = blocks_[b].next) {
        const Block& child = blocks_[b];
        const std::uint32_t* const to = to_.data() + child.begin;
        const double* from = stack_[child.stack].data() + child.update;
        for (std::uint32_t c = 0; c < child.below; ++c, from += child.update_stride) {
            const bool own = to[c] < block.columns;
            const std::uint32_t first_row = own ? 0 : block.columns;
            double* const column = own ? value_.data() + block.value + to[c] * block.stride
                                       : update + (to[c] - first_row) * block.update_stride;
            for (std::uint32_t r = c; r < child.below; ++r) column[to[r] - first_row] += from[r];
        }
    }
}

void SparseLdlt::solve(double* x) {
    const std::size_t size = place_.size();
    double* const y = solution_.data();
    for (std::size_t i = 0; i < size; ++i) y[place_[i]] = x[i];
    for (const Block& block : blocks_)
        solve_lower(block, value_.data() + block.value, row_.data() + block.begin, y);
    for (std::size_t i = 0; i < size; ++i) y[i] *= inverse_pivot_[i];
    for (std::size_t b = blocks_.size(); b-- > 0;)
        solve_upper(blocks_[b], value_.data() + blocks_[b].value, row_.data() + blocks_[b].begin, y);
    for (std::size_t i = 0; i < size; ++i) x[i] = y[place_[i]];
}

}  // namespace corda::sim
