"""Ensembles on a graphics processor: the generated kernel, compiled by NVRTC through CuPy."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._state import Array, State

if TYPE_CHECKING:
    from ._ensemble import EnsembleSolution
    from ._system import BoundSystem

THREADS = 128


def source(text: str, scheme: str, struct: str | None) -> tuple[str, str]:
    """The kernel's text as NVRTC takes it, and its name."""
    header, prefix = _native.cuda(text, scheme, struct)
    # NVRTC has the functions of these itself, and not the files
    header = re.sub(r"(?m)^\s*#\s*include\s*<.*$", "", header)
    member = re.search(r"#ifndef (\w+)_MEMBER", header)
    assert member is not None
    before = (
        f"#define {member[1]}_KERNEL extern \"C\" __global__\n"
        f"#define {member[1]}_MEMBER ((unsigned long)blockIdx.x * (unsigned long)blockDim.x + (unsigned long)threadIdx.x)\n"
    )
    return before + header, f"{prefix}_ensemble"


@lru_cache(maxsize=32)
def kernel(text: str, scheme: str, struct: str | None) -> Any:
    try:
        import cupy
    except ImportError:
        raise RuntimeError(
            "device='cuda' needs CuPy, which is not installed: `pip install cupy-cuda12x`, or the package for your version of CUDA; "
            "device='cpu' runs on all cores"
        ) from None
    code, name = source(text, scheme, struct)
    # products and sums are rounded one by one, as everywhere else
    module = cupy.RawModule(code=code, options=("--fmad=false", "--std=c++14"), backend="nvrtc")
    return cupy, module.get_function(name)


def ensemble(
    system: BoundSystem,
    rows: Array,
    fields: Array,
    span: tuple[float, float],
    step: float,
    steps: int,
    scheme: str,
    every: int | None,
    controls: Any,
    progress: Callable[[float], Any] | None,
) -> EnsembleSolution:
    from ._ensemble import EnsembleSolution, Failed

    layout = system.system
    if layout._module is not None:
        raise ValueError("a system that is compiled ahead is one for the processor: device='cuda' needs its description as text")
    members, width, inputs = len(rows), layout._state.length, layout._controls.length
    if callable(controls):
        raise ValueError("on device='cuda' controls are held: an array, or one with a row for each member")
    if controls is not None and not inputs:
        raise ValueError(f"{layout.name} has no controls")
    if not np.isfinite(rows).all():
        raise ValueError("the states are not finite")
    cupy, run = kernel(layout.text, scheme, layout._struct)
    interval = int(every) if every else max(steps, 1)
    # structures of arrays
    state = cupy.asarray(np.ascontiguousarray(rows.T).ravel())
    parameters = cupy.asarray(np.ascontiguousarray(fields.T).ravel())
    count = steps // interval if every else 0
    samples = cupy.zeros(max(count, 1) * width * members)
    status = cupy.zeros(members, dtype=np.int32)
    arguments: list[Any] = [parameters, np.int32(0), state, np.float64(step)]
    if _timed(run, layout.text, scheme, layout._struct):
        arguments.append(np.float64(span[0]))
    if inputs:
        held = layout._controls.rows(np.zeros(inputs) if controls is None else controls, members, np.zeros(inputs))
        arguments += [cupy.asarray(np.ascontiguousarray(held.T).ravel()), np.uint64(1)]
    arguments += [np.uint64(steps), np.uint64(interval), samples, status, np.uint64(members)]
    run(((members + THREADS - 1) // THREADS,), (THREADS,), tuple(arguments))
    last = cupy.asnumpy(state).reshape(width, members).T
    if progress:
        progress(1.0)
    times, recorded = [span[1]], [last]
    if every:
        kept = cupy.asnumpy(samples).reshape(-1, width, members)[:count].transpose(0, 2, 1)
        times = [span[0], *(span[0] + (k + 1) * interval * step for k in range(count))]
        recorded = [rows, *kept]
        if steps % interval:
            times.append(span[1])
            recorded.append(last)
    codes = cupy.asnumpy(status)
    failed = [Failed(int(member), 0, f"status {codes[member]} of the header") for member in np.flatnonzero(codes)]
    y, start = State(layout._state, np.ascontiguousarray(np.array(recorded))), State(layout._state, rows)
    return EnsembleSolution(system, np.array(times), y, start, State(layout._parameters, fields), failed)


def _timed(_: Any, text: str, scheme: str, struct: str | None) -> bool:
    """Whether the kernel asks for the time."""
    code, name = source(text, scheme, struct)
    signature = re.search(rf"void {name}\(([^)]*)\)", code)
    return signature is not None and "time" in signature[1]
