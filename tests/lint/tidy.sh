#!/usr/bin/env bash
# Fails if clang-tidy finds fault with the library, the program or the examples.
# Usage: tidy.sh BUILD_FOLDER
# In a unity build (preset ci) several files are one translation unit, and the system's headers, which cost the most, are
# examined once for all of them.
set -euo pipefail
build=${1:?usage: tidy.sh BUILD_FOLDER}
sed -nE 's#^ *"file": "(.*/(src|examples)/.*)",?$#\1#p' "$build/compile_commands.json" | sort -u |
    xargs -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
