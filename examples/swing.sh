#!/usr/bin/env bash
# Installs missing packages, builds Corda and renders the main example to swing.mp4 in the current folder.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

"$root/src/cmake/setup.sh" build
preset=$root/build/release
[[ -f "$preset/build.ninja" ]] || (cd "$root" && cmake --preset release >/dev/null)
cmake --build "$preset"

corda=$preset/corda
# Keep a video that is newer than the program and the scene.
if [[ -f swing.mp4 && swing.mp4 -nt "$corda" && swing.mp4 -nt "$root/examples/swing.toml" ]]; then
    echo "swing.mp4 is up to date"
    exit 0
fi
"$corda" render "$root/examples/swing.toml" -o swing.mp4 --force
