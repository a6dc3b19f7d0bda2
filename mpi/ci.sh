#!/usr/bin/env bash
# Builds and tests the crate where MPI is installed, and says so where it is not: `bash mpi/ci.sh`, from anywhere; `--all` with the catalogue too.
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

# Without the catalogue, which takes longer to compile than all else: what is tested are two systems of an example. That the program with all of
# them can be resolved is asked for. Nor with Parquet, which has nothing to do with ranks.
features=(--no-default-features --locked)
if [ "${1:-}" = --all ]; then
    features+=(--features catalogue)
fi
cargo fmt --check
# what is compiled is compiled by Clippy, so that nothing is compiled twice
RUSTC_WORKSPACE_WRAPPER="$(rustc --print sysroot)/bin/clippy-driver"
export RUSTC_WORKSPACE_WRAPPER RUSTFLAGS="-D warnings"
cargo metadata --locked --format-version 1 >/dev/null
cargo test "${features[@]}"
echo "MPI: $SECONDS s"
