#!/usr/bin/env bash
# Builds and runs a benchmark. Results vary by about 10 % between runs: compare ratios of one run.
# Usage: tests/benchmark/run.sh video [--json] [SCENE] [--size WxH,...] [--preset NAME,...] [--encodings] ...
#        tests/benchmark/run.sh sim [--json] [GOOGLE BENCHMARK OPTIONS]
#        tests/benchmark/run.sh draw [--json] [GOOGLE BENCHMARK OPTIONS]
#        tests/benchmark/run.sh sweep [--json] [--samples N]
#        tests/benchmark/run.sh long [PERIODS]
#        tests/benchmark/run.sh study [CHAPTER ...] [--scene SCENE] [--quick] [-o FOLDER]
#        tests/benchmark/run.sh startup [--json] [--repeats N] [--beside PROGRAM]
#   video  renders beside x264 alone: time, stages and memory; with --encodings, presets and codecs
#   sim    the cost of each method against the number of particles; long ropes by auto, with error and memory
#   sweep  clips of a sweep with all labels: whole, and by stages
#   draw   frames of examples/swing.toml in several styles
#   long   energy and phase of a pendulum after 10 000 or PERIODS periods; a million take minutes
#   study  the chapters of tests/benchmark/README.md: study.py
#   startup  short commands: milliseconds of each, optionally in turns with another build of the program
# BUILD_DIR is a build folder of the preset ci or release with tests; build/ci by default.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=${BUILD_DIR:-$root/build/ci}
kind=${1:-}
shift || true
case "$kind" in
    video) programs=(video) ;;
    sim) programs=(relaxation rattle exact nets long_ropes) ;;
    draw) programs=(pipeline) ;;
    long) programs=(long_runs) ;;
    study) programs=(study) ;;
    startup | sweep) programs=() ;;
    *) sed -n '2,17s/^# \?//p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac
cd "$root"
[[ -f "$build/build.ninja" ]] || cmake --preset ci >/dev/null
cmake --build "$build" --target corda "${programs[@]/#/benchmark_}" >&2

if [[ "$kind" == sweep ]]; then
    cmake --build "$build" --target corda_python >&2
    PYTHONPATH=$build/python exec /usr/bin/python3 tests/benchmark/sweep.py "$@"
fi
if [[ "$kind" == startup ]]; then exec python3 tests/benchmark/startup.py "$build/corda" examples "$@"; fi
if [[ "$kind" == long ]]; then exec "$build/tests/benchmark_long_runs" "$@"; fi
if [[ "$kind" == study ]]; then exec python3 tests/benchmark/study.py --program "$build/tests/benchmark_study" "$@"; fi
if [[ "$kind" == video ]]; then exec "$build/tests/benchmark_video" "$@"; fi
json=()
options=()
for option in "$@"; do
    if [[ "$option" == --json ]]; then json=(--benchmark_format=json); else options+=("$option"); fi
done
for program in "${programs[@]}"; do
    "$build/tests/benchmark_$program" "${json[@]}" "${options[@]}"
done | if [[ ${#json[@]} -gt 0 ]]; then
    # The documents of the programs as one.
    python3 -c '
import json, sys
text, decoder, rows = sys.stdin.read(), json.JSONDecoder(), []
while text.strip():
    document, end = decoder.raw_decode(text.lstrip())
    text = text.lstrip()[end:]
    rows += document["benchmarks"]
json.dump({"schema": 1, "benchmarks": rows}, sys.stdout, indent=1)
print()'
else
    cat
fi
