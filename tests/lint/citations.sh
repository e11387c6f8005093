#!/usr/bin/env bash
# Fails if a comment, a message or a page cites something that is not in the repository: a reference number (R1, R2, ...),
# a section of a README, a file, or the target of a link; or if a page below src has an identifier in backticks that no
# source contains. How to cite: "R5", "section 5 of src/corda/sim/README.md", "tests/accuracy/data/swing40.txt", "section 5"
# within one page.
# Usage: citations.sh [ROOT]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "${1:-$here/../..}"
mapfile -t files < <(find README.md src tests examples shaders -type f -regextype egrep \
    -regex '.*\.(md|hpp|cpp|frag|vert|sh|toml|cmake|txt|in)' ! -path 'tests/lint/citations*' | sort)
mapfile -t pages < <(printf '%s\n' "${files[@]}" | grep '\.md$')
awk -f "$here/citations.awk" <(find . -mindepth 1 -path ./.git -prune -o -path ./build -prune -o -print | sed 's/^..//') \
    part=headings "${pages[@]}" part=citations "${files[@]}"
