"""Memory does not grow with the number of runs."""

import ctypes
import gc
import os
import sys
import time

import pytest

import coadjoint as co

#: As long as it may take; `COADJOINT_CAMPAIGN=1` makes all runs.
SECONDS = 8.0 if "COADJOINT_CAMPAIGN" not in os.environ else 3600.0


class Allocated(ctypes.Structure):
    """What glibc says of its memory: `struct mallinfo2`."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()
    ]


LIBC = ctypes.CDLL(None)


def in_use():
    """Bytes that are allocated, and small objects of Python: pages of the process also say how scattered free ones are."""
    gc.collect()
    LIBC.mallinfo2.restype = Allocated
    memory = LIBC.mallinfo2()
    return memory.uordblks + memory.hblkhd, sys.getallocatedblocks()


@pytest.mark.skipif(not hasattr(LIBC, "mallinfo2"), reason="nothing tells how much memory there is in use")
def test_short_runs_leave_nothing(top, y0, cart):
    bad = top.state(y0)
    bad.attitude[0] = 2.0

    def event(t, y):
        return y.gamma[2] - 0.9999

    def some(count):
        for k in range(count):
            sol = top.run(y0, 0.05, step=0.01, events=event if k % 4 == 0 else None)
            sol(0.013)
            assert sol.energy[0] > 0
            top.stepper(0.01).step(y0.copy())
            cart.run([0, 0], 0.02, step=0.01, controls=lambda t, y: [t])
            with pytest.raises(co.StepError):
                top.run(bad, 0.05, step=0.01)
            if k % 50 == 0:
                top.ensemble(y0, n=9, t_span=0.1, step=0.01)
                with pytest.raises(co.DescriptionError):
                    co.System(group="SO3", potential="wrong", inertia="i: Vector3")
        return count

    # caches are warm after some
    some(1000)
    before, begun, runs = in_use(), time.monotonic(), 0
    while time.monotonic() - begun < SECONDS and runs < 100_000:
        runs += some(500)
    grown = [after - was for was, after in zip(before, in_use())]
    # what is lost in each run would be a solution: more than a thousand bytes, and some objects
    assert grown[0] < 50_000 + runs, f"{grown[0] / runs:.1f} bytes for each of {runs} runs"
    assert grown[1] < 500 + runs // 100, f"{grown[1] / runs:.3f} objects for each of {runs} runs"
    print(f"{runs} runs, {grown[0]} bytes and {grown[1]} objects more")
