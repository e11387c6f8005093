#!/usr/bin/env bash
# Draws the pictures of examples/README.md into examples/pictures, one per scene, and the animation of README.md. The
# program is the argument; by default that of examples/swing.sh.
# Usage: examples/gallery.sh [CORDA]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
corda=$(realpath "${1:-$root/build/release/corda}")
cd "$root/examples"

# A plain background keeps the files small. The rate is one that GIF can hold.
look=(--size 640x360 -q --force --set 'style.background="#121828"')
"$corda" render fifty_pendulums.toml --fps 25 --frames 140:215 "${look[@]}" --size 480x270 -o pictures/fifty_pendulums.gif
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
for method in relaxation rattle exact; do
    "$corda" still "methods/$method.toml" --frame 120 "${look[@]}" --size 212x240 -o "$scratch/$method.png"
done
ffmpeg -v error -y -i "$scratch/relaxation.png" -i "$scratch/rattle.png" -i "$scratch/exact.png" \
    -filter_complex hstack=3 pictures/methods.png

# Name, command and times of each picture, and its own options.
while read -r name command times more; do
    # shellcheck disable=SC2086
    "$corda" "$command" "$name.toml" --at "$times" "${look[@]}" --set overlay.time=false $more -o "pictures/$name.png"
done <<'END'
bars            still  2.0
bridge          still  0.6
bridge_lets_go  strobe 0.5,1.3,1.7,2.2
child           still  22
cloth           still  1.5
crane           still  5
cut             strobe 0,0.35,0.6,0.8,1.0,1.2
double_pendulum still  5.3
fifty_pendulums still  7.2 --set overlay.time=true
first           strobe 0,0.1,0.2,0.3,0.4,0.5,0.6
folded_chain    still  0.58
gusts           still  1.6
hammock         still  0.6
kapitza         still  1.1
materials       still  0.6
pendulum_wave   still  4
period          still  6
portrait        still  2.4 --size 360x640 --set overlay.time=true
relaxation      still  2.5
start           strobe 0,0.2,0.3,0.4,0.5
string          still  0.42
swing           strobe 0,0.3,0.6,0.9,1.2,1.5,1.75
three_ropes     still  0.9
throw           strobe 0,0.6,1.2,2,3,4,4.9
trapeze         strobe 0,1
whip            strobe 0,0.3,0.45,0.6,0.75,0.9
whip_crack      still  0.62 --set overlay.time=true
wrecking_ball   strobe 0,0.9,1.4,1.8,2.2,2.7,3.5
END
