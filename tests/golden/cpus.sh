#!/usr/bin/env bash
# Fails unless golden pictures and positions are the same on older CPUs and with other vector widths of the driver: the C
# library without AVX and FMA, llvmpipe with other instructions and widths, and any driver replaced by llvmpipe.
# Usage: cpus.sh PROGRAM
# PROGRAM is corda. First, each variable is shown to have an effect, because a misspelt one would check nothing. Vectors of
# 512 bits are not tested, because llvmpipe crashes with them.
set -euo pipefail
corda=${1:?usage: cpus.sh PROGRAM}
cd "$(dirname "${BASH_SOURCE[0]}")"
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
loader=(/lib64/ld-linux-x86-64.so.2 --list-diagnostics)  # an AArch64 has none of these CPUs

# The rounding of the sine of this angle depends on whether the CPU has FMA.
printf 'schema = 1\n[[rope]]\nhang = { links = 5, length = 1.0, angle_deg = 44.1276 }\n' >"$work/angle.toml"

# positions COMMAND...: prints positions that the program computes when run by the command.
positions() {
    for scene in "$work/angle.toml" scenes/{bars,ring,pendulums,slack,two_pins}.toml; do
        "$@" "$corda" simulate "$scene" --set world.duration=0.5 -o - -q
    done
}

# check SETTING...: fails unless goldens and positions are unchanged with these variables. Without the shader cache, from
# which llvmpipe (Mesa 22.3) would take shaders that were compiled with other variables.
check() {
    local suite
    for suite in "scenes --dir stills" "pinned --dir pinned"; do
        # shellcheck disable=SC2086
        env MESA_SHADER_CACHE_DISABLE=1 "$@" "$corda" golden $suite --set world.duration=1.0 -q >"$work/goldens" ||
            { echo "with $*:"; cat "$work/goldens"; exit 1; }
    done
    positions env "$@" | cmp - "$work/positions" || { echo "with $*: other positions"; exit 1; }
}

# bits SETTING...: prints the width of llvmpipe's vectors.
bits() { env "$@" "$corda" doctor | grep -oE '[0-9]+ bits' | head -1; }

positions >"$work/positions"
if [[ "$(uname -m)" == x86_64 ]]; then
    without=GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA
    active() { "$@" "${loader[@]}" | grep dl_hwcaps_subdirs_active; }
    if grep -qw avx2 /proc/cpuinfo && [[ "$(active env)" == "$(active env $without)" ]]; then
        echo "$without changes nothing in this C library"
        exit 1
    fi
    check $without
    for caps in sse2 sse4.1 avx; do check GALLIUM_OVERRIDE_CPU_CAPS=$caps; done
fi
for width in 128 256; do
    [[ "$(bits LP_NATIVE_VECTOR_WIDTH=$width)" == "$width bits" ]] ||
        { echo "LP_NATIVE_VECTOR_WIDTH=$width gives $(bits LP_NATIVE_VECTOR_WIDTH=$width)"; exit 1; }
    check LP_NATIVE_VECTOR_WIDTH=$width
done
check LIBGL_ALWAYS_SOFTWARE=1
