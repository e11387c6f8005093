#!/usr/bin/env bash
# Builds the Debian packages and uses their contents: the program draws an example, the manual and the completions exist,
# and Python imports the module and draws the same frame.
# Usage: debian.sh BUILD_FOLDER EXAMPLES_FOLDER
# With CORDA_TEST_LONG=1 (as root) they are installed, used and removed in a new system of this machine's release, where an
# outside project builds against the library, too.
set -euo pipefail
build=$1
examples=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT

cpack --config "$build/CPackConfig.cmake" -B "$work/packages" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
ls "$work/packages"/corda_*.deb "$work/packages"/libcorda-dev_*.deb >/dev/null

use() {  # use COMMAND...: uses the program in the system that the command enters
    "$@" corda render /usr/share/doc/corda/examples/first.toml --duration 0.2 --size 320x180 -o /tmp/first.mp4 -q
    "$@" corda still /usr/share/doc/corda/examples/first.toml --size 320x180 --frame 3 -o /tmp/still.png -q
}

if [[ -z "${CORDA_TEST_LONG:-}" ]]; then
    for package in "$work/packages"/*.deb; do dpkg-deb -x "$package" "$work/root"; done
    scene=$work/root/usr/share/doc/corda/examples/first.toml
    "$work/root/usr/bin/corda" still "$scene" --size 320x180 --frame 3 -o "$work/still.png" -q >/dev/null
    "$build/corda" still "$examples/first.toml" --size 320x180 --frame 3 -o "$work/expected.png" -q >/dev/null
    cmp "$work/still.png" "$work/expected.png"
    PYTHONPATH="$work/root/usr/lib/python3/dist-packages" /usr/bin/python3 -c "
import corda
film = corda.Film('$scene', size=(320, 180))
assert corda.compare(film.frame(3), '$work/still.png').equal
assert corda.Sweep('$(dirname "$scene")/sweep/clips.toml')[7]['frames'].shape == (60, 64, 64, 4)"
    cp -r "$here/pytest" "$work/pytest"
    (   # an outside project
        cd "$work/pytest"
        export PATH="$work/root/usr/bin:/usr/bin:/bin" PYTHONPATH="$work/root/usr/lib/python3/dist-packages"
        corda golden scenes --dir ref --update -q >/dev/null
        corda still scenes/swing.toml --size 320x180 --at 0.5 -o kept.png -q >/dev/null
        python3 -m pytest -q -p no:cacheprovider
    )
    mandoc -T lint -W error "$work/root/usr/share/man/man1/corda.1"
    bash -n "$work/root/usr/share/bash-completion/completions/corda"
    for package in "$work/packages"/*.deb; do
        name=$(dpkg-deb -f "$package" Package)
        [[ -s "$work/root/usr/share/doc/$name/copyright" ]] || { echo "$name has no copyright file"; exit 1; }
        for library in libavcodec libavformat; do
            loaded=$(dpkg-deb -f "$package" Depends | grep -oE "$library([0-9]+|-dev)") && dpkg-query -W "$loaded" >/dev/null ||
                { echo "$name does not depend on an installed $library"; exit 1; }
        done
    done
    exit 0
fi

source "$here/../support/new_system.sh"
new_system "$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)" "$work/system"
mkdir "$work/system/packages"
cp "$work/packages"/*.deb "$work/system/packages"
cp -r "$here/consumer" "$work/system/consumer"
in_system() { enter "$work/system" "$@"; }
in_system apt-get update -q >/dev/null
in_system sh -c 'apt-get install -y -q --no-install-recommends /packages/corda_*.deb' >"$work/log" 2>&1 || { tail "$work/log"; exit 1; }
use in_system
in_system sh -c 'apt-get install -y -q --no-install-recommends /packages/libcorda-dev_*.deb g++ cmake make' >"$work/log" 2>&1 ||
    { tail "$work/log"; exit 1; }
in_system sh -c 'cmake -S /consumer -B /tmp/consumer >/dev/null && cmake --build /tmp/consumer' >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
in_system sh -c 'corda still /usr/share/doc/corda/examples/swing.toml --size 320x180 --duration 0.5 --frame 10 -o /tmp/swing.png -q'
in_system /tmp/consumer/consumer /usr/share/doc/corda/examples/swing.toml /tmp/swing.png /tmp/out.mp4
in_system sh -c 'apt-get install -y -q --no-install-recommends /packages/python3-corda_*.deb' >"$work/log" 2>&1 || { tail "$work/log"; exit 1; }
in_system python3 -c "
import corda
scene = '/usr/share/doc/corda/examples/first.toml'
assert corda.compare(corda.Film(scene, size=(320, 180)).frame(3), '/tmp/still.png').equal
assert corda.Film(scene, size=(320, 180), duration=1).save('/tmp/film.mp4') == 60"
in_system apt-get purge -y -q corda libcorda-dev python3-corda >"$work/log" 2>&1 || { tail "$work/log"; exit 1; }
left=$(chroot "$work/system" find /usr -name '*corda*' -not -path '*__pycache__*')
[[ -z "$left" ]] || { echo "left after the packages were removed: $left"; exit 1; }
