#!/usr/bin/env bash
# Fails if clang-tidy finds fault with the library, the program or the examples.
# Usage: tidy.sh BUILD_FOLDER
# In a unity build (preset ci) several files are one translation unit, and the system's headers, which cost the most, are
# examined once for all of them. Each version has other checks, so that of Debian 12 decides; with another, the test is
# skipped (exit 77).
set -euo pipefail
build=${1:?usage: tidy.sh BUILD_FOLDER}
[[ "$(clang-tidy --version)" == *' version 14.'* ]] || { echo "not checked: this clang-tidy is not version 14, which decides"; exit 77; }
sed -nE 's#^ *"file": "(.*/(src|examples)/.*)",?$#\1#p' "$build/compile_commands.json" | sort -u |
    xargs -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
