#!/usr/bin/env bash
# Copies the plot and the tables of a study to src/study/README.md, each table between its two marks.
# Usage: corda study -o STUDY --chapter accuracy --chapter speed && src/cmake/readme_tables.sh STUDY
set -euo pipefail
study=${1:?usage: readme_tables.sh STUDY}
page=$(cd "$(dirname "${BASH_SOURCE[0]}")/../study" && pwd)/README.md
[[ -f "$study/report.md" ]] || { echo "readme_tables.sh: $study/report.md is missing; run corda study -o $study" >&2; exit 2; }

# table TITLE: the first table whose title begins so, without the padding of its cells.
table() {
    awk -v title="**$1" '
        index($0, title) == 1 { found = 1 }
        found && /^\|/ { rows = 1; gsub(/ +/, " "); if ($0 ~ /^\|[-:|]+$/) gsub(/-+/, "---"); print; next }
        found && rows { exit }' "$study/report.md"
}

for title in "Setting" "Fastest at each accuracy" "Accuracy against published numbers"; do
    rows=$(table "$title")
    [[ -n $rows ]] || { echo "readme_tables.sh: $study/report.md has no table \"$title\"" >&2; exit 1; }
    awk -v title="$title" '
        BEGIN { while ((getline line < "/dev/stdin") > 0) rows = rows line "\n" }
        $0 == "<!-- begin of " title " -->" { print; print "\n" rows; skip = 1; next }
        $0 == "<!-- end of " title " -->" { skip = 0 }
        !skip { print }' "$page" <<<"$rows" >"$page.new"
    mv "$page.new" "$page"
done
cp "$study/speed_report_swing.png" "$(dirname "$page")/speed.png"
