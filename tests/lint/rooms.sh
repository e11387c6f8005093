#!/usr/bin/env bash
# Fails if a file of src/corda includes a room that the table in src/README.md does not allow, or if the check misses one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mapfile -t files < <(find src/corda -name '*.hpp' -o -name '*.cpp')
awk -f src/cmake/rooms.awk src/README.md "${files[@]}"

wrong=$(mktemp -d)
trap 'rm -rf "$wrong"' EXIT
mkdir -p "$wrong/src/corda/sim/exact"
printf '#include "corda/core/text.hpp"\n#include "corda/view/font.hpp"\n' >"$wrong/src/corda/sim/exact/a.cpp"
found=$(awk -f src/cmake/rooms.awk src/README.md "$wrong/src/corda/sim/exact/a.cpp") && { echo "a wrong include passed"; exit 1; }
[[ $found == "$wrong/src/corda/sim/exact/a.cpp:2: #include \"corda/view/font.hpp\"" ]]
