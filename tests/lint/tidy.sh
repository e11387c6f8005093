#!/usr/bin/env bash
# Fails where clang-tidy has something to say about the library, the program or the examples.
# Usage: tidy.sh BUILD_FOLDER
set -euo pipefail
build=${1:?usage: tidy.sh BUILD_FOLDER}
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
find src examples -name '*.cpp' -print0 | xargs -0 -n 4 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
