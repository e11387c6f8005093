#!/usr/bin/env bash
# Fails if a source file has more than 500 lines (split it), or README.md more than 200 (move reference to the page next to
# its code).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
status=0
lines=$(wc -l <README.md)
[[ $lines -le 200 ]] || { echo "README.md: $lines lines"; status=1; }
find src shaders examples tests \( -name '*.cpp' -o -name '*.hpp' -o -name '*.vert' -o -name '*.frag' \) -exec wc -l {} + |
    awk '$2 != "total" && $1 > 500 { print $2 ": " $1 " lines"; bad = 1 } END { exit bad }' || status=1
exit $status
