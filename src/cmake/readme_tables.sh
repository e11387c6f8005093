#!/usr/bin/env bash
# Puts the tables of a study into README.md, between its two marks.
# Usage: corda study -o STUDY --chapter accuracy --chapter speed && src/cmake/readme_tables.sh STUDY
set -euo pipefail
study=${1:?usage: readme_tables.sh STUDY}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
[[ -f "$study/report.md" ]] || { echo "readme_tables.sh: $study/report.md is missing; run corda study -o $study" >&2; exit 2; }

# table TITLE: the first table of that title, with its title.
table() {
    awk -v title="**$1**" '
        $0 == title { found = 1; print; print ""; next }
        found && /^\|/ { rows = 1; gsub(/ +/, " "); if ($0 ~ /^\|[-:|]+$/) gsub(/-+/, "---"); print; next }
        found && rows { exit }' "$study/report.md"
}

tables=$(mktemp)
trap 'rm -f "$tables"' EXIT
for title in "Setting" "Fastest at each accuracy" "Accuracy against published numbers"; do
    table "$title" >>"$tables"
    echo >>"$tables"
done
grep -q '^|' "$tables" || { echo "readme_tables.sh: no table in $study/report.md" >&2; exit 1; }
awk -v tables="$tables" '
    /^<!-- begin of the study/ { print; print ""; while ((getline line < tables) > 0) print line; skip = 1; next }
    /^<!-- end of the study/ { skip = 0 }
    !skip { print }' "$root/README.md" >"$root/README.md.new"
mv "$root/README.md.new" "$root/README.md"
