#!/usr/bin/env bash
# Builds the wheel, installs it as a user does, and tests it: `bash python/ci.sh`, from anywhere. `--all` tests it with every Python that is found.
set -euo pipefail
cd "$(dirname "$0")"

step() { printf '\n== python: %s (after %s s)\n' "$*" "$SECONDS"; }

python=${PYTHON:-python3}
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
    echo "no Python 3.10 or later: the package for Python is not tested" >&2
    exit 0
fi
work=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$work"' EXIT
fresh() { "$1" -m venv "$2" && "$2/bin/python" -m pip install --quiet --disable-pip-version-check "${@:3}"; }

step "a fresh environment"
fresh "$python" "$work/build" "maturin>=1.9.4,<2"
# while the wheel is compiled
fresh "$python" "$work/test" numpy scipy pandas matplotlib pytest mypy nbclient nbformat ipykernel jax >"$work/pip.log" 2>&1 &
installing=$!

step wheel
# by `.ci/run` it is compiled under Clippy, with its flags
CARGO_INCREMENTAL=0 "$work/build/bin/maturin" build --release --locked --interpreter "$python" --out "$work/dist"
wheel=$(echo "$work"/dist/*.whl)
case "$wheel" in
    *-cp310-abi3-*) ;;
    *) echo "not for the stable interface: $wheel" >&2 && exit 1 ;;
esac
if ! wait "$installing"; then
    cat "$work/pip.log" >&2
    exit 1
fi
"$work/test/bin/python" -m pip install --quiet --disable-pip-version-check "dask[distributed]" pyarrow >"$work/pip.log" 2>&1 ||
    echo "no Dask or pyarrow can be installed: ensembles are not tested on its workers, nor rows as Parquet"

installed() { # an environment's Python
    "$1" -m pip install --quiet --disable-pip-version-check --no-deps "$wheel"
}

tested() {
    # from elsewhere: what is imported is what was installed
    (cd "$work/tests" && COADJOINT_REPOSITORY="$OLDPWD/.." "$1" -m pytest --quiet -rs -p no:cacheprovider \
        --doctest-modules --ignore=reference.py --pyargs coadjoint .)
}

others() {
    (cd "$work/tests" && "$work/test/bin/python" -m mypy.stubtest coadjoint._native)
    "$work/test/bin/python" -m mypy coadjoint
    MPLBACKEND=agg "$work/test/bin/python" notebooks/run.py
}

step "tests, types and notebooks"
installed "$work/test/bin/python"
cp -r tests examples "$work/"
# tests are on one core
others >"$work/others.log" 2>&1 &
checking=$!
tested "$work/test/bin/python"
if ! wait "$checking"; then
    cat "$work/others.log" >&2
    exit 1
fi
grep -v WARNING "$work/others.log"

step "a system that is compiled ahead"
# what the wheel is made of is compiled already
(cd examples/compiled && CARGO_INCREMENTAL=0 CARGO_TARGET_DIR=../../target "$work/build/bin/maturin" build --release --locked \
    --interpreter "$python" --out "$work/compiled")
"$work/test/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps "$work"/compiled/*.whl
(cd "$work/tests" && "$work/test/bin/python" -m pytest --quiet -p no:cacheprovider test_compiled.py)

if [ "${1:-}" = --all ]; then
    for other in python3.10 python3.11 python3.12 python3.13 python3.14; do
        "$other" -c '' 2>/dev/null || continue
        step "tests with $other"
        fresh "$other" "$work/$other" numpy scipy pandas matplotlib pytest
        installed "$work/$other/bin/python"
        tested "$work/$other/bin/python"
    done
fi
step done
