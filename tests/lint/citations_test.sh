#!/usr/bin/env bash
# Fails unless citations.sh accepts a small repository whose citations all resolve, and refuses each bad one.
set -euo pipefail
lint=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/citations.sh
root=$(mktemp -d)
trap 'rm -r "$root"' EXIT
mkdir -p "$root"/{src/corda/sim,tests,examples,shaders}
printf '# Corda\n\nSee [R1](src/corda/sim/README.md#r1-pendulum) and src/corda/sim/a.hpp.\n' >"$root/README.md"
printf '## 5. Hard cases\n\nIn section 5, R1, [up](../../../README.md).\n\n### R1 Pendulum\n' >"$root/src/corda/sim/README.md"

# expect RESULT TEXT: fails unless the lint has this result for a source with this text.
expect() {
    printf '%b\n' "$2" >"$root/src/corda/sim/a.hpp"
    local said=accepted
    "$lint" "$root" >"$root/said" || said=refused
    [[ $said == "$1" ]] && return
    echo "citations.sh $said: $2"
    cat "$root/said"
    exit 1
}

expect accepted '// R1, section 5 of src/corda/sim/README.md, src/corda/sim/*.hpp, sim/a.hpp, RFC 4180 section 2'
expect accepted '// Hard cases: section 5 of\n// src/corda/sim/README.md'
expect refused '// R2'
expect refused '// section 6 of src/corda/sim/README.md'
expect refused '// sections 5 to 6 of src/corda/sim/README.md'
expect refused '// sections 5 and 6 of src/corda/sim/README.md'
expect refused '// section 6 of\n/// src/corda/sim/README.md'
expect refused '// section 5'
expect refused '// section 5 of src/corda/render/README.md'
expect refused '// src/corda/sim/b.hpp'
expect refused '// tests/data/swing.txt'
expect refused '// see sim/b.hpp'
expect refused '// PHYSICS R1'
printf '`Chain`, `Chain::length_m()`, `length_m[i]`, `core/`, `p = 2`\n' >"$root/src/corda/sim/c.md"
expect accepted 'struct Chain { double length_m; };'
expect refused 'struct Chain { double length; };'
expect refused 'struct Rope { double length_m; };'
printf '`Chain::reach_s`\n' >"$root/src/corda/sim/c.md"
expect refused 'struct Chain { double length_m; };'
rm "$root/src/corda/sim/c.md"
expect accepted ''
for link in 'b.md' 'README.md#r2' '../README.md'; do
    printf '[x](%s)\n' "$link" >"$root/src/corda/sim/c.md"
    expect refused ''
done
