#!/usr/bin/env bash
# Makes Corda a part of an outside project by add_subdirectory(): it adds its library, and nothing else to the project's
# build, tests, installed files and packages; no package of its program or its tests is looked for.
# Usage: subproject.sh BUILD_FOLDER EXAMPLES_FOLDER
# With CORDA_TEST_LONG=1 the whole library is built, and a program of the project uses it.
set -euo pipefail
build=$1
examples=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "subproject.sh: $1" >&2; cat "$work/log" >&2; exit 1; }
# Without what only the program and the tests need.
absent=(-DCMAKE_DISABLE_FIND_PACKAGE_{CLI11,GTest,benchmark,pybind11,Python,Python3}=ON)
cat >"$work/pkg-config" <<'END'
#!/bin/sh
case "$*" in *microhttpd*) exit 1 ;; esac
exec pkg-config "$@"
END
chmod +x "$work/pkg-config"
configure() {  # configure BUILD_FOLDER OPTIONS...
    cmake -G Ninja -S "$here/subproject" -B "$1" -DCORDA_SOURCE="$examples/.." -DPKG_CONFIG_EXECUTABLE="$work/pkg-config" "${absent[@]}" \
        "${@:2}" >"$work/log" 2>&1 || fail "the project cannot be configured"
    ctest --test-dir "$1" -N | grep -q 'Total Tests: 0' || fail "the project has tests"
    cmake --install "$1" --prefix "$1/prefix" >"$work/log" 2>&1 || fail "nothing can be installed"
    [[ "$(cd "$1/prefix" && find . -type f)" == ./share/consumer/CMakeLists.txt ]] || fail "other files are installed"
}

configure "$work/plain"
[[ ! -e "$work/plain/CPackConfig.cmake" ]] || fail "the project has packages"
configure "$work/cpack" -DCONSUMER_CPACK=ON
cpack --config "$work/cpack/CPackConfig.cmake" -B "$work/packages" >"$work/log" 2>&1 || fail "cpack"
[[ "$(cd "$work/packages" && ls -- *.*)" == consumer-7.1-Linux.tar.gz ]] || fail "the packages are $(ls "$work/packages")"
tar -tf "$work/packages/consumer-7.1-Linux.tar.gz" | grep -q '/share/consumer/CMakeLists.txt$' || fail "the package lacks its file"
! tar -tf "$work/packages/consumer-7.1-Linux.tar.gz" | grep -q corda || fail "the package has files of Corda"

# It compiles as the project builds, without C++20 and without optimisation.
target=corda_core_objects
[[ -z "${CORDA_TEST_LONG:-}" ]] || target=app
configure "$work/plain" -DCMAKE_CXX_STANDARD=17 -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=40
cmake --build "$work/plain" --target "$target" >"$work/log" 2>&1 || fail "$target does not build"
[[ -n "${CORDA_TEST_LONG:-}" ]] || exit 0
"$build/corda" still "$examples/swing.toml" --size 320x180 --duration 0.5 --frame 10 -o "$work/still.png" -q
"$work/plain/app" "$examples/swing.toml" "$work/still.png" "$work/out.mp4"
