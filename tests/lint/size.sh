#!/usr/bin/env bash
# Fails if a source file has more than 500 lines: split it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
find src shaders examples tests \( -name '*.cpp' -o -name '*.hpp' -o -name '*.vert' -o -name '*.frag' \) -exec wc -l {} + |
    awk '$2 != "total" && $1 > 500 { print $2 ": " $1 " lines"; bad = 1 } END { exit bad }'
