#!/usr/bin/env bash
# Fails if a source does not follow .clang-format (fix with: clang-format -i $(git ls-files '*.cpp' '*.hpp')), or has short
# pieces of a string literal on lines of their own, which clang-format leaves behind when a text changes.
# Versions of clang-format differ in details, so that of Debian 12 decides; with another version, only such pieces are
# looked for and the test is skipped (exit 77).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
status=0
if [[ "$(clang-format --version)" == *' version 14.'* ]]; then
    find src examples tests \( -name '*.cpp' -o -name '*.hpp' \) -print0 | xargs -0 clang-format --dry-run -Werror
else
    echo "the style was not checked: $(clang-format --version) is not version 14, which decides"
    status=77
fi
scraps=$(find src examples tests \( -name '*.cpp' -o -name '*.hpp' \) -exec awk '
    { line = $0; gsub(/^ +/, "", line) }
    FNR > 2 && before ~ /"$/ && scrap ~ /^"[^"\\]*"$/ && length(scrap) < 25 && line ~ /^"/ { print FILENAME ":" FNR - 1 ": " scrap }
    { before = scrap; scrap = line }' {} +)
if [[ -n $scraps ]]; then
    printf '%s\njoin these with the lines around them\n' "$scraps"
    exit 1
fi
exit $status
