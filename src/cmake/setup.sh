#!/usr/bin/env bash
# Installs the Debian 12 or 13 packages that Corda needs; does nothing if all are installed.
# Usage: setup.sh [build|test|long|platforms|cluster|peers|list]
#   test        adds the packages of the tests
#   long        adds these and the large packages that few tests use: tests/run.sh --long
#   platforms   adds the packages that build and run AArch64 programs here
#   cluster     adds the packages that run a Slurm cluster here
#   peers       adds the libraries that tests/benchmark/peers.sh compares Corda with
#   list        prints the packages of build, one per line, and installs nothing
set -euo pipefail

packages=(
    build-essential         # g++ 12 or 14: the compiler
    cmake                   # the build
    ninja-build             # runs the build on all cores
    file                    # used by cpack to examine programs
    pkg-config              # finds the libraries that ship no CMake package
    libepoxy-dev            # loads EGL and OpenGL functions on any driver
    libegl-dev              # the EGL headers that epoxy includes
    libegl-mesa0            # EGL without a screen, even without a GPU
    libgl1-mesa-dri         # llvmpipe: OpenGL on the CPU
    libavcodec-dev          # the encoders and the decoders that check their output
    libavformat-dev         # muxers and demuxers of MP4, WebM, Matroska, GIF
    libavutil-dev           # frames and error texts of the two above
    libx264-dev             # H.264 with hints on unchanged macroblocks, which libavcodec cannot pass on
    zlib1g-dev              # long scenes in pictures and videos
    libeigen3-dev           # sparse factorisation for nets of bars
    libcairo2-dev           # stills as PDF and SVG
    libfreetype-dev         # glyphs of text in pictures
    fonts-dejavu-core       # their font, which becomes part of the program
    libpng-dev              # stills and golden images, with their sRGB, pHYs and text chunks
    libcli11-dev            # the command line
    libtomlplusplus-dev     # scene files, with line and column of every value
    nlohmann-json3-dev      # the --json output
    libfmt-dev              # formatted text
    libmicrohttpd-dev       # the page of `watch`
    python3-dev             # the Python module
    pybind11-dev            # its C++ half
    python3-numpy           # its arrays, at run time
)
if [[ "${1:-build}" == list ]]; then
    printf '%s\n' "${packages[@]}"
    exit 0
fi
if [[ "${1:-build}" != build ]]; then
    packages+=(
        libgtest-dev        # the tests
        libgmock-dev        # its matchers
        libbenchmark-dev    # measured speed
        clang-format        # the style check
        clang               # the tests under the sanitizers, by a second compiler
        libclang-rt-dev     # its sanitizers
        ffmpeg              # a second opinion on the videos: ffprobe
        libxml2-utils       # checks that pages and SVG are well formed: xmllint
        librsvg2-bin        # a second opinion on SVG: rsvg-convert
        poppler-utils       # a second opinion on PDF: pdftoppm
        python3-pytest      # the tests of the Python module
        python3-pytest-xdist  # user tests in several processes that draw
        python3-jsonschema  # a second opinion on the JSON Schema of scenes
        python3-matplotlib  # plots, reports and sweeps of the module, and the study
        mandoc              # checks the manual page
        zsh                 # checks its completion
        fish                # the same
        chromium            # shows pages with scripts, and plays videos
    )
fi
if [[ "${1:-build}" == long ]]; then
    packages+=(
        clang-tidy          # the static checks
        python3-torch       # a DataLoader whose workers make samples: examples/sweep
        python3-pandas      # reads the table of a sweep: examples/sweep
        jupyter-nbconvert   # runs the example notebook
        python3-ipykernel   # the kernel of the notebook
        valgrind            # memory that an encoder reads and nothing wrote
        parallel            # runs the tasks of a sweep or a film: examples/cluster
        python3-distributed # the same on Dask
        mmdebstrap          # new Debian systems to build and install in
    )
fi
if [[ "${1:-build}" == platforms ]]; then
    packages+=(
        mmdebstrap          # new Debian systems to build in
        crossbuild-essential-arm64  # the compiler for AArch64
        qemu-user-static    # runs its programs
    )
fi
if [[ "${1:-build}" == cluster ]]; then
    packages+=(
        slurm-wlm           # its controller and nodes
        munge               # by which they trust each other
        iproute2            # a network of their own: ip
    )
fi
if [[ "${1:-build}" == peers ]]; then
    packages+=(
        libmujoco-dev       # MuJoCo
        libbullet-dev       # Bullet, in double precision too
        libbox2d-dev        # Box2D
        libsimbody-dev      # Simbody
        libode-dev          # ODE
        libchipmunk-dev     # Chipmunk
        libdart-dev         # DART
        libsundials-dev     # CVODE and IDA
        libboost-dev        # Boost.odeint
    )
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ "$status" == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ "$(id -u)" -ne 0 ]]; then
    command -v sudo >/dev/null || { echo "setup.sh: run as root or install sudo; missing: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
fi
echo "Installing ${#missing[@]} Debian packages: ${missing[*]}" >&2
"${as_root[@]}" apt-get update -q >&2
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" >&2
