#!/usr/bin/env bash
# Builds and tests the crate where MPI is installed, and says so where it is not: `bash mpi/ci.sh`, from anywhere.
set -euo pipefail
cd "$(dirname "$0")"
export CARGO_INCREMENTAL=0

missing=()
command -v "${MPICC:-mpicc}" >/dev/null 2>&1 || missing+=(mpicc)
command -v mpirun >/dev/null 2>&1 || missing+=(mpirun)
compgen -G "${LIBCLANG_PATH:-/usr/lib/llvm-*/lib}/libclang*.so*" >/dev/null ||
    ldconfig -p 2>/dev/null | grep -q libclang || missing+=(libclang)
if [ "${#missing[@]}" -gt 0 ]; then
    echo "${missing[*]} missing (on Debian: libopenmpi-dev openmpi-bin libclang-dev): ensembles on MPI are not tested" >&2
    exit 0
fi

# without the catalogue, which takes minutes to compile: what is tested here are two systems of an example
features=(--no-default-features --features parquet --locked)
cargo fmt --check
# what is compiled is compiled by Clippy, so that nothing is compiled twice
RUSTC_WORKSPACE_WRAPPER="$(rustc --print sysroot)/bin/clippy-driver"
export RUSTC_WORKSPACE_WRAPPER RUSTFLAGS="-D warnings"
cargo test --release "${features[@]}"
echo "MPI: $SECONDS s"
