"""Memory does not grow with the number of runs."""

import gc
import os
import time

import pytest

import coadjoint as co

#: As long as it may take; `COADJOINT_CAMPAIGN=1` makes all runs.
SECONDS = 8.0 if "COADJOINT_CAMPAIGN" not in os.environ else 3600.0


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="nothing tells how much memory there is in use")
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

    # caches and allocators are warm after some
    some(1000)
    gc.collect()
    before, begun, runs = resident(), time.monotonic(), 0
    while time.monotonic() - begun < SECONDS and runs < 100_000:
        runs += some(500)
    gc.collect()
    grown = resident() - before
    # what is lost in each run would be a solution, more than a thousand bytes; allocators take some pages more
    assert grown < 400_000 + 20 * runs, f"{grown / runs:.1f} bytes for each of {runs} runs"
    print(f"{runs} runs, {grown / runs:.2f} bytes for each")
