#!/usr/bin/env bash
# Installs the build to an empty prefix and uses it from an outside project, by CMake and by pkg-config: the consumer's
# frame equals the installed program's still, byte for byte.
# Usage: consumer.sh BUILD_FOLDER EXAMPLES_FOLDER
set -euo pipefail
build=$1
examples=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -G Ninja -S "$here/consumer" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Debug >/dev/null
cmake --build "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
export LD_LIBRARY_PATH="$work/prefix/lib:$work/prefix/lib/$(gcc -print-multiarch 2>/dev/null)${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
"$work/prefix/bin/corda" still "$examples/swing.toml" --size 320x180 --duration 0.5 --frame 10 -o "$work/still.png" -q
"$work/build/consumer" "$examples/swing.toml" "$work/still.png" "$work/out.mp4"
ffprobe -v error "$work/out.mp4"

pc=$(dirname "$(find "$work/prefix" -name corda.pc)")
flags=$(PKG_CONFIG_PATH="$pc" pkg-config --cflags --libs corda)
# shellcheck disable=SC2086
g++ -std=c++20 "$here/consumer/main.cpp" -o "$work/by_pkg_config" $flags
"$work/by_pkg_config" "$examples/swing.toml" "$work/still.png" "$work/out2.mp4"
cmp "$work/out.mp4" "$work/out2.mp4"
