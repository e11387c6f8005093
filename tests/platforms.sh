#!/usr/bin/env bash
# Builds Corda for other platforms, and fails unless golden pictures, positions, GIF and raw video have the same bytes
# there as here; in Debian 13 a sweep, too, and for AArch64 all videos and figures. Files of libraries that differ
# between releases must decode here: videos, and an SVG figure, whose pixels may differ by one level. Run as root, which makes new systems in TMPDIR.
# Usage: tests/platforms.sh [debian13|arm64]   (both without an argument)
#   debian13   in a new Debian 13; with CORDA_TEST_LONG=1 with every test that runs there, by tests/run.sh
#   arm64      for AArch64, cross-built with this machine's release, and run by qemu-user
# It needs build/ci, which tests/run.sh builds, and packages that it installs.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/tests/support/new_system.sh"
[[ $# -le 1 && "${1:-arm64}" =~ ^(debian13|arm64)$ ]] || { echo "platforms.sh: unknown argument $1; see the head of this file" >&2; exit 2; }
[[ "$(id -u)" -eq 0 ]] || { echo "platforms.sh: making a system takes root" >&2; exit 1; }
[[ -x "$root/build/ci/corda" ]] || { echo "platforms.sh: build/ci/corda is not there; run tests/run.sh" >&2; exit 1; }
work=$(mktemp -d --tmpdir corda-platforms.XXXXXX)
trap 'rm -rf --one-file-system "$work"' EXIT
cd "$root"

# say TEXT: reports a finished step with the time so far.
say() { printf 'platforms: %s (%d s)\n' "$1" "$SECONDS"; }

# make_outputs FOLDER COMMAND...: writes outputs of the program that the command runs. `same` must have the same bytes on
# every platform, and `sound` must be valid.
make_outputs() {
    local to=$1 scene method
    shift
    mkdir -p "$to"/{same/csv,same/png,sound}
    "$@" golden tests/golden/scenes --dir tests/golden/stills --set world.duration=1.0 -q
    "$@" golden tests/golden/pinned --dir tests/golden/pinned --set world.duration=1.0 -q
    for scene in tests/golden/scenes/*.toml; do
        "$@" simulate "$scene" --set world.duration=0.5 -o "$to/same/csv/$(basename "$scene" .toml).csv" -q
    done
    for method in exact rattle relaxation; do
        "$@" simulate examples/first.toml --set "solver.method=$method" --duration 2 -o "$to/same/csv/first_$method.csv" -q
    done
    local film=(examples/swing.toml --size 320x180 --duration 0.4 --fps 25 -q)
    "$@" render "${film[@]}" -o "$to/same/swing.gif"
    "$@" render "${film[@]}" -o "$to/same/png/%02d.png"
    "$@" render "${film[@]}" -o - >"$to/same/swing.y4m"
    "$@" still "${film[@]}" --frame 3 -o "$to/still.svg"
    for codec in libx264 libx265 libsvtav1 libaom-av1; do "$@" render "${film[@]}" --codec "$codec" -o "$to/sound/$codec.mp4"; done
    for codec in libvpx-vp9 libsvtav1; do "$@" render "${film[@]}" --codec "$codec" -o "$to/sound/$codec.webm"; done
    "$@" render "${film[@]}" --set style.background=transparent -o "$to/sound/clear.webm"
    "$@" render "${film[@]}" -o "$to/sound/swing.mov"
    "$@" render "${film[@]}" -o "$to/sound/swing.mkv"
    "$@" render "${film[@]}" --set style.background=transparent -o "$to/sound/clear.mkv"
}

# make_sweep FOLDER BUILD: makes a sweep, which has the same bytes in both releases.
make_sweep() { PYTHONPATH=$2/python /usr/bin/python3 -m corda sweep - -o "$1/sweep" -q <tests/golden/sweep.toml; }

# check_outputs FOLDER NAME: fails unless they agree with those of this machine.
check_outputs() {
    local file
    diff -rq "$work/here/same" "$1/same" || { echo "platforms: $2 makes other bytes" >&2; return 1; }
    for file in "$work/here" "$1"; do rsvg-convert "$file/still.svg" -o "$file.png"; done
    quietly "$work/log" build/ci/corda compare "$work/here.png" "$1.png" --max 1
    for file in "$1"/sound/*; do quietly "$work/log" ffmpeg -v error -xerror -i "$file" -f null -; done
    say "$2: goldens and $(find "$1/same" -type f | wc -l) files with the same bytes, $(find "$1/sound" -type f | wc -l) sound videos"
}

on_debian13() {
    local system=$work/trixie
    new_system trixie "$system"
    say "debian13: new system"
    mkdir "$system/corda"
    tar --exclude=./build --exclude=./.git --exclude=./shared -cf - . | tar -xf - -C "$system/corda"
    in_system() { enter "$system" bash -ec "cd /corda; $1"; }
    quietly "$work/log" in_system src/cmake/setup.sh
    say "debian13: packages"
    quietly "$work/log" in_system 'cmake --preset release && cmake --build build/release --target corda corda_python'
    say "debian13: built"
    in_system "$(declare -f make_outputs make_sweep)
        make_outputs /made build/release/corda
        make_sweep /made build/release" >/dev/null
    check_outputs "$system/made" debian13
    diff -rq "$work/here/sweep" "$system/made/sweep"
    say "debian13: a sweep with the same bytes"
    [[ -z "${CORDA_TEST_LONG:-}" ]] || in_system "CORDA_TEST_LONG= tests/run.sh -- -LE browser"
}

on_arm64() {
    local system=$work/arm64 release packages
    release=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
    packages=$(src/cmake/setup.sh list | grep -E '^(lib|fonts|nlohmann|python3-dev|pybind)' | paste -sd,)
    new_system "$release" "$system" --variant=extract --architectures=arm64 --include="libc6-dev,libopengl0,$packages" \
        --hook-dir=/usr/share/mmdebstrap/hooks/merged-usr
    say "arm64: new system"
    cat >"$work/arm64.cmake" <<END
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT $system)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} $system)
set(ENV{PKG_CONFIG_LIBDIR} $system/usr/lib/aarch64-linux-gnu/pkgconfig:$system/usr/share/pkgconfig)
END
    quietly "$work/log" cmake --preset release -B "$work/build" --toolchain "$work/arm64.cmake" -DCORDA_WARNINGS_AS_ERRORS=ON \
        "-DPython_INCLUDE_DIR=$(echo "$system"/usr/include/python3.*)"
    quietly "$work/log" cmake --build "$work/build" --target corda
    say "arm64: built"
    make_outputs "$work/made" qemu-aarch64-static -L "$system" "$work/build/corda" >/dev/null
    check_outputs "$work/made" arm64
    diff -rq --exclude=sweep "$work/here" "$work/made"
    say "arm64: all videos with the same bytes"
}

src/cmake/setup.sh platforms
make_outputs "$work/here" build/ci/corda >/dev/null
make_sweep "$work/here" build/ci >/dev/null
platforms=("$@")
[[ $# -gt 0 ]] || platforms=(debian13 arm64)
for platform in "${platforms[@]}"; do "on_$platform"; done
