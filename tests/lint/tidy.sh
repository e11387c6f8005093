#!/usr/bin/env bash
# Fails if clang-tidy reports a problem in the library, the program or the examples.
# Usage: tidy.sh BUILD_FOLDER
# In a unity build (preset ci) several files are one translation unit, so the system headers, which take most of the time,
# are examined once for all of them. Versions differ in their checks, so that of Debian 12 decides; with another version,
# the test is skipped (exit 77).
set -euo pipefail
build=${1:?usage: tidy.sh BUILD_FOLDER}
[[ "$(clang-tidy --version)" == *' version 14.'* ]] || { echo "not checked: this clang-tidy is not version 14, which decides"; exit 77; }
sed -nE 's#^ *"file": "(.*/(src|examples)/.*)",?$#\1#p' "$build/compile_commands.json" | sort -u |
    xargs -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
