#!/usr/bin/env bash
# Fails if a source is not as .clang-format has it (fix with: clang-format -i $(git ls-files '*.cpp' '*.hpp')), or has
# scraps of a string literal on lines of their own, which clang-format leaves behind when a text changes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
find src examples tests \( -name '*.cpp' -o -name '*.hpp' \) -print0 | xargs -0 clang-format --dry-run -Werror
scraps=$(find src examples tests \( -name '*.cpp' -o -name '*.hpp' \) -exec awk '
    { line = $0; gsub(/^ +/, "", line) }
    FNR > 2 && before ~ /"$/ && scrap ~ /^"[^"\\]*"$/ && length(scrap) < 25 && line ~ /^"/ { print FILENAME ":" FNR - 1 ": " scrap }
    { before = scrap; scrap = line }' {} +)
if [[ -n $scraps ]]; then
    printf '%s\njoin these with the lines around them\n' "$scraps"
    exit 1
fi
