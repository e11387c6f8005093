# Prints each include between rooms that the table in src/README.md does not allow, as file:line, and fails.
# Usage: awk -f rooms.awk src/README.md src/corda/*/*.hpp ...
FNR == 1 { room = FILENAME; inside = sub(/^.*src\/corda\//, "", room) && sub(/\/.*/, "", room) }
!inside && /^\| `[a-z]+\/` \|/ {
    split($0, cells, "|")
    count = split(cells[4], allowed, /[^a-z]+/)
    for (k = 1; k <= count; ++k) arrows[substr(cells[2], 3, index(cells[2], "/") - 3), allowed[k]] = 1
}
inside && /^#include "corda\/[a-z]+\// {
    split($0, parts, "/")
    if (parts[2] != room && !((room, parts[2]) in arrows)) { print FILENAME ":" FNR ": " $0; failed = 1 }
}
END { exit failed }
