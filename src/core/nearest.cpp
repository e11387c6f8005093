#include "corda/core/nearest.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "corda/core/text.hpp"

namespace corda {
namespace {

constexpr std::size_t kMaxWord = 64;  // longer than any candidate; bounds the work on hostile input
constexpr std::size_t kMinPrefix = 3;

/// Whether a word is the beginning of a candidate, or a candidate of which it has half and more.
bool is_prefix(std::string_view word, std::string_view candidate) {
    if (std::min(word.size(), candidate.size()) < kMinPrefix) return false;
    return candidate.starts_with(word) ||
           (word.starts_with(candidate) && 2 * candidate.size() >= word.size());
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before_last(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before_last.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            const bool swapped =
                i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
    }
    return row[b.size()];
}

std::optional<std::string_view> nearest(std::string_view word, std::span<const std::string_view> candidates) {
    if (word.empty() || word.size() > kMaxWord) return std::nullopt;
    std::optional<std::string_view> closest;
    std::size_t smallest = std::numeric_limits<std::size_t>::max();
    for (const std::string_view candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        const std::size_t close = std::max<std::size_t>(1, std::min(word.size(), candidate.size()) / 3);
        if (distance < smallest && (distance <= close || is_prefix(word, candidate))) {
            smallest = distance;
            closest = candidate;
        }
    }
    return closest;
}

}  // namespace corda
