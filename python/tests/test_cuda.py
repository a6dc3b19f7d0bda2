"""Ensembles on CUDA, as far as that can be tested without a device: CuPy is stood for by a C compiler, which takes the same text, with the
same arguments in the same order, and runs one thread after the other."""

import ctypes
import re
import shutil
import subprocess
import sys
import types

import numpy as np
import pytest

import coadjoint as co
from coadjoint import _cuda

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


@pytest.fixture(autouse=True)
def fresh():
    _cuda.kernel.cache_clear()
    yield
    _cuda.kernel.cache_clear()


def test_without_cupy_it_is_said(top, y0, monkeypatch):
    monkeypatch.setitem(sys.modules, "cupy", None)
    with pytest.raises(RuntimeError, match="needs CuPy"):
        top.ensemble(y0, n=4, t_span=1, step=0.1, device="cuda")


class Kernel:
    def __init__(self, function):
        self.function, self.calls = function, []

    def __call__(self, grid, block, arguments):
        self.calls.append((grid, block))
        given = []
        for one in arguments:
            if isinstance(one, np.ndarray):
                given.append(ctypes.c_void_p(one.ctypes.data))
            else:
                kinds = {"float64": ctypes.c_double, "uint64": ctypes.c_ulong, "int32": ctypes.c_int}
                given.append(kinds[one.dtype.name](one.item()))
        self.function(grid[0] * block[0], *given)


@pytest.fixture()
def cupy(monkeypatch, tmp_path):
    if COMPILER is None:
        pytest.skip("no C compiler")
    kernels = []

    class RawModule:
        def __init__(self, code, options, backend):
            assert options == ("--fmad=false", "--std=c++14") and backend == "nvrtc"
            code = code.replace('extern "C" __global__', "")
            code = re.sub(r"(#define \w+_MEMBER ).*", r"\1 the_thread", code, count=1)
            self.code = "#include <math.h>\n#include <string.h>\n#include <stddef.h>\n#include <stdint.h>\n#include <float.h>\nstatic unsigned long the_thread;\n" + code

        def get_function(self, name):
            arguments = re.search(rf"void {name}\(([^)]*)\)", self.code)[1]
            names = [re.search(r"(\w+)$", one.strip())[1] for one in arguments.split(",")]
            code = self.code + (
                f"\nvoid all_threads(unsigned long threads, {arguments}) {{\n"
                f"for (the_thread = 0; the_thread < threads; the_thread++) {name}({', '.join(names)});\n}}\n"
            )
            file, library = tmp_path / f"{len(kernels)}.c", tmp_path / f"{len(kernels)}.so"
            file.write_text(code)
            subprocess.run(
                [COMPILER, "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-w", "-o", library, file, "-lm"], check=True
            )
            kernels.append(Kernel(ctypes.CDLL(str(library)).all_threads))
            return kernels[-1]

    module = types.ModuleType("cupy")
    module.RawModule, module.asarray, module.asnumpy, module.zeros = RawModule, np.asarray, np.asarray, np.zeros
    monkeypatch.setitem(sys.modules, "cupy", module)
    return kernels


def test_members_are_those_of_the_processor(top, cupy):
    rng = np.random.default_rng(3)
    states = {"momentum": rng.normal(size=(300, 3)), "gamma": [0.0, 0.6, 0.8]}
    weights = {"weight": rng.uniform(0.5, 2, size=300)}
    for scheme, order in (("cayley", None), ("cayley", 4), ("exponential", None)):
        keys = dict(t_span=1, step=0.01, scheme=scheme, order=order, every=30)
        there = top.ensemble(states, weights, device="cuda", **keys)
        here = top.ensemble(states, weights, **keys)
        assert there.y.flat.shape == here.y.flat.shape == (5, 300, 10)
        assert there.t == pytest.approx(here.t) and not there.failed
        assert np.abs(there.y.flat - here.y.flat).max() < 1e-12
        assert (there.y.flat[-1] != there.y.flat[0]).any()
    assert cupy[0].calls == [((3,), (128,))]


def test_controls_and_failures(cart, cupy):
    pushes = np.array([[1.0], [2.0], [-3.0]])
    sol = cart.ensemble([[0.0, 0.0]] * 3, controls=pushes, t_span=2, step=0.01, device="cuda")
    assert np.abs(sol.end.momentum - 2 * pushes).max() < 1e-12
    with pytest.raises(ValueError, match="held"):
        cart.ensemble([0.0, 0.0], controls=lambda t, y: 0, t_span=1, step=0.1, device="cuda")
    pole = co.System(group="R1", potential="position.x.sqrt()", inertia="mass: float")(mass=1)
    sol = pole.ensemble([[1.0, 0.0], [500.0, 0.0]], t_span=5, step=0.05, scheme="exponential", device="cuda")
    assert [one.member for one in sol.failed] == [0] and np.isfinite(sol.y.flat).all()
