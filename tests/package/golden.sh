#!/usr/bin/env bash
# Installs the build to an empty prefix and uses its golden tests from an outside project: corda_add_golden_tests and the
# matcher of GoogleTest, without pictures, with matching pictures, and with a failure of each.
# Usage: golden.sh BUILD_FOLDER
set -euo pipefail
build=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "golden.sh: $1" >&2; cat "$work/log" >&2; exit 1; }
# check TEST passes|fails
check() {
    local result=passes
    ctest --test-dir "$work/build" -R "^$1\$" --output-on-failure >"$work/log" 2>&1 || result=fails
    [[ $result == "$2" ]] || fail "$1 $result, not $2"
}

cmake --install "$build" --prefix "$work/prefix" >/dev/null
export LD_LIBRARY_PATH="$work/prefix/lib:$work/prefix/lib/$(gcc -print-multiarch 2>/dev/null)${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
cp -r "$here/golden" "$work/project"
cmake -G Ninja -S "$work/project" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Debug >/dev/null
cmake --build "$work/build" >"$work/log" 2>&1 || fail "the project does not build"
grep -q "CORDA_PROGRAM:.*=$work/prefix/bin/corda" "$work/build/CMakeCache.txt" || fail "another corda is used"

# Nothing is kept yet.
check ref.swing fails
check ref.stale passes
check frames fails
grep -q "there is no golden picture" "$work/log" || fail "the matcher does not say what is missing"

cmake --build "$work/build" --target update_ref >"$work/log" 2>&1 || fail "update_ref"
CORDA_UPDATE_GOLDENS=1 check frames passes
check ref.swing passes
check frames passes
! ls "$work"/build/ref.swing.new/*.png >/dev/null 2>&1 || fail "a passed test left pictures"

# A later change of the scene.
sed -i 's/length = 1.0/length = 1.1/' "$work/project/scenes/swing.toml"
check ref.swing fails
grep -q "hang.length is 1.1 and was 1" "$work/log" || fail "the suite does not say why"
xmllint --noout "$work/build/ref.swing.xml" || fail "JUnit's XML"
[[ -s $work/build/ref.swing.html ]] || fail "there is no page"
"$work/prefix/bin/corda" golden "$work/project/scenes" --dir "$work/project/ref" --accept "$work/build/ref.swing.new" >"$work/log" ||
    fail "the new pictures are not accepted"
check ref.swing passes
CORDA_GOLDEN_ARTIFACTS="$work/artifacts" check frames fails
grep -q "see $work/artifacts/swing_0030.new.png and $work/artifacts/swing_0030.difference.png" "$work/log" ||
    fail "the matcher does not say where the pictures are"
"$work/prefix/bin/corda" compare "$work/artifacts/swing_0030.new.png" "$work/project/frames/swing_0030.png" >"$work/log" &&
    fail "the new picture is the golden one"
[[ -s $work/artifacts/swing_0030.difference.png ]] || fail "there is no difference picture"

# A scene that gets its table later, in a folder, and a picture that no scene asks for.
mkdir "$work/project/scenes/deep"
grep -v golden "$work/project/scenes/swing.toml" | grep -v '^at' >"$work/project/scenes/deep/later.toml"
cmake --build "$work/build" >"$work/log" 2>&1 || fail "the project does not build"
! ctest --test-dir "$work/build" -N | grep -q later || fail "a scene without pictures has a test"
printf '[golden]\nat = [0.1]\n' >>"$work/project/scenes/deep/later.toml"
cmake --build "$work/build" >"$work/log" 2>&1 || fail "the project does not build"
check ref.deep/later fails
mv "$work/project/scenes/swing.toml" "$work"
check ref.stale fails
mv "$work/swing.toml" "$work/project/scenes"
check ref.stale passes

# Shards.
sed -i 's/GOLDEN ref)/GOLDEN ref SHARDS 2)/' "$work/project/CMakeLists.txt"
cmake --build "$work/build" --target update_ref >"$work/log" 2>&1 || fail "update_ref"
check ref.0 passes
check ref.1 passes
