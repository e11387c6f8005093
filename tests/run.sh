#!/usr/bin/env bash
# Installs missing packages, builds Corda with warnings as errors and runs every test with ctest.
# Usage: tests/run.sh [--preset ci|asan|tsan|debug] [--long | --units] [-- CTEST ARGUMENTS]
#   --preset tsan  only the tests of threads, under ThreadSanitizer
#   --long   the long form of the slow suites, the tests that need large packages, tests/platforms.sh and
#            tests/cluster/slurm.sh
#   --units  only the tests of unit and fuzz
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=ci
target=all
while [[ $# -gt 0 ]]; do
    case "$1" in
        --preset) preset=${2:?--preset needs a name}; shift 2 ;;
        --long) export CORDA_TEST_LONG=1; shift ;;
        --units) target=unit_tests; shift ;;
        --) shift; break ;;
        *) echo "run.sh: unknown argument $1; see the head of this file" >&2; exit 2 ;;
    esac
done

[[ "$preset" == tsan ]] && target=thread_tests

"$root/tests/lint/rooms.sh"
tests=$preset
packages=test
if [[ -n "${CORDA_TEST_LONG:-}" && "$preset" == ci ]]; then
    tests=long
    packages=long
fi
"$root/src/cmake/setup.sh" "$packages"
cd "$root"
[[ -f "build/$preset/build.ninja" ]] || cmake --preset "$preset" >/dev/null
cmake --build "build/$preset" --target "$target"
[[ "$target" != unit_tests ]] || set -- -L 'unit|fuzz' -E fuzz.random_scenes "$@"
ctest --preset "$tests" "$@"
if [[ "$tests" == ci && $# -eq 0 ]]; then
    echo "run.sh: tests/run.sh --long also runs:$(ctest --preset long -N -L long | sed -n 's/^ *Test .*: / /p' | tr -d '\n')"
elif [[ "$tests" == long && $# -eq 0 ]]; then
    tests/cluster/slurm.sh build/ci
    tests/platforms.sh
fi
