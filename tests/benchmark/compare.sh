#!/usr/bin/env bash
# Compares the speed of this tree with that of another revision, as ratios of times in one run: below 1, this tree is
# faster.
# Usage: tests/benchmark/compare.sh REV [--repeats N] [--filter REGEX]
# Builds REV in a temporary worktree. Kernels are the Google Benchmark cases that both revisions have; video cases are
# renders of one scene by both programs. Both take turns, N times (5 by default), and the ratio is the median of those of each turn.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if [[ $# -lt 1 || $1 == -* ]]; then sed -n '2,6s/^# \?//p' "${BASH_SOURCE[0]}" >&2; exit 2; fi
cd "$root"
revision=$(git rev-parse --verify "$1^{commit}")
shift
scratch=$(mktemp -d)
trap 'git worktree remove --force "$scratch/tree" 2>/dev/null || true; rm -rf "$scratch"' EXIT
git worktree add --quiet --detach "$scratch/tree" "$revision"

# build TREE: its program and its benchmarks.
build() {
    cmake -S "$1" -B "$1/build/ci" --preset ci >/dev/null
    local targets
    targets=$(ninja -C "$1/build/ci" -t targets all | sed -n 's/^\(benchmark_[a-z]*\): phony$/\1/p')
    cmake --build "$1/build/ci" --target corda $targets >&2
}
(cd "$root" && build "$root")
(cd "$scratch/tree" && build "$scratch/tree")
exec python3 "$root/tests/benchmark/compare.py" "$root/build/ci" "$scratch/tree/build/ci" "$@"
