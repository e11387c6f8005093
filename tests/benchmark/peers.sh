#!/usr/bin/env bash
# Compares Corda with other libraries: time against error on six problems, in one run on one core.
# Usage: tests/benchmark/peers.sh [OUTPUT_FOLDER]
# Installs the libraries, all packages of Debian 12 and 13, builds the programs of tests/benchmark/peers in build/peers,
# runs them (10 minutes of CPU time) and writes the plots and tables of tests/benchmark/README.md and the rows of
# README.md. A library that has no package is left out and named. OUTPUT_FOLDER (build/peers/runs by default) gets the
# truth and runs.csv, all runs.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$root"
output=${1:-build/peers/runs}
src/cmake/setup.sh peers
cmake --preset ci -B build/peers -D CORDA_PEERS=ON | sed -n 's/^-- peers: //p' >&2
cmake --build build/peers --target all_peers >&2
programs=build/peers/tests/benchmark/peers
mkdir -p "$output"
"$programs/peers_truth" "$output" >&2
head=problem,peer,version,method,parameter,value,error,energy_error,ms_per_s,failure
echo "$head" >"$output/runs.csv"
for problem in swing chain payload net bending string; do
    for program in corda mujoco bullet bullet_soft box2d simbody ode chipmunk dart sundials odeint dop853 rods xpbd avbd; do
        [[ -x "$programs/peers_$program" ]] || continue
        echo "$problem: $program" >&2
        "$programs/peers_$program" "$output" "$problem" >>"$output/runs.csv" ||
            echo "$problem: $program failed" >&2
    done
    /usr/bin/python3 tests/benchmark/peers/report.py "$output" "$problem" >>"$output/runs.csv"
done
/usr/bin/python3 tests/benchmark/study.py peers --from "$output"
