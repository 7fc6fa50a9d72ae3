#!/usr/bin/env bash
# Measures the GPU of this machine: benches/gpu.sh [arguments of `jointsweep bench-gpu`]. Needs a Vulkan driver and the
# release binary, which is built where there is none.
set -euo pipefail
cd "$(dirname "$0")/.."
[ -x target/release/jointsweep ] || JOINTSWEEP_COMMIT="$(git rev-parse --short HEAD)" cargo build --release
exec target/release/jointsweep bench-gpu "$@"
