"""Compares typed Taylor steps with heyoka: `python heyoka.py BENCHMARK`, the program that `cargo bench --bench taylor` runs.

A free body and a heavy top with moments 1, 10, 100 for 1800 s, attitude included. Of each choice of a tolerance the time that the processor spends
on it, in turns, the least of some rounds; for each error the least time of a choice that has no larger one at the end. Exact is heyoka's end in
extended precision.
"""

import resource
import subprocess
import sys
import time

import heyoka
import numpy as np

PROGRAM = sys.argv[1]
ROUNDS = int(sys.argv[2]) if len(sys.argv) > 2 else 3
END = 1800.0
ERRORS = (1e-6, 1e-9, 1e-11)
# how often a round takes the motion
REPEATED = 10


def equations(is_top):
    w, x, y, z, a, b, c, g1, g2, g3 = heyoka.make_vars("w", "x", "y", "z", "a", "b", "c", "g1", "g2", "g3")
    o1, o2, o3 = a / 1.0, b / 10.0, c / 100.0
    torque = (g2 * 1.0 - g3 * 0.2, g3 * 0.3 - g1 * 1.0, g1 * 0.2 - g2 * 0.3) if is_top else (0.0, 0.0, 0.0)
    system = [
        (w, -0.5 * (x * o1 + y * o2 + z * o3)),
        (x, 0.5 * (w * o1 + y * o3 - z * o2)),
        (y, 0.5 * (w * o2 + z * o1 - x * o3)),
        (z, 0.5 * (w * o3 + x * o2 - y * o1)),
        (a, b * o3 - c * o2 + torque[0]),
        (b, c * o1 - a * o3 + torque[1]),
        (c, a * o2 - b * o1 + torque[2]),
    ]
    if is_top:
        system += [(g1, g2 * o3 - g3 * o2), (g2, g3 * o1 - g1 * o3), (g3, g1 * o2 - g2 * o1)]
    return system


def ours(name, tolerance):
    def run(rounds):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        said = subprocess.run(
            [PROGRAM, name, repr(tolerance), str(rounds)], capture_output=True, text=True, check=True
        )
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, said.stdout.split()

    def once():
        # what it takes to start is no part of it
        (few, _), (many, words) = run(1), run(1 + REPEATED)
        return (many - few) / REPEATED, int(words[1]), np.array([np.longdouble(word) for word in words[2:]])

    return once


def theirs(start, taylor):
    def once():
        begun = time.thread_time()
        for _ in range(REPEATED):
            taylor.time, taylor.state[:] = 0.0, start
            steps = taylor.propagate_until(END)[3]
        return (time.thread_time() - begun) / REPEATED, steps, np.array(taylor.state, dtype=np.longdouble)

    return once


for name in ("body", "top"):
    start = [1.0, 0, 0, 0, 1, 1, 1] + ([0, 0, 1.0] if name == "top" else [])
    system = equations(name == "top")
    exact = heyoka.taylor_adaptive(
        system, np.array(start, dtype=np.longdouble), tol=np.longdouble(1e-19), fp_type=np.longdouble
    )
    exact.propagate_until(np.longdouble(END))
    exact = np.array(exact.state)

    def error(end):
        opposite = np.concatenate([-end[:4], end[4:]])
        return float(min(np.abs(end - exact).max(), np.abs(opposite - exact).max()))

    ways = {("ours", 10.0**-k): ours(name, 10.0**-k) for k in range(7, 17)}
    for k in range(8, 17):
        ways["heyoka", 10.0**-k] = theirs(start, heyoka.taylor_adaptive(system, start, tol=10.0**-k))
    found = {}
    for _ in range(ROUNDS):
        for way, once in ways.items():
            took, steps, end = once()
            least = min(took, found[way][0]) if way in found else took
            found[way] = (least, steps, error(end))
    for (who, tolerance), (took, steps, off) in found.items():
        each = took * 1e9 / steps
        print(f"{name} {who} {tolerance:.0e}: {took * 1e3:.2f} ms, {steps} steps of {each:.0f} ns, error {off:.1e}")
    for wanted in ERRORS:
        least = {
            who: min((took, way[1]) for way, (took, _, off) in found.items() if way[0] == who and off <= wanted)
            for who in ("ours", "heyoka")
        }
        ratio = least["ours"][0] / least["heyoka"][0]
        words = ", ".join(f"{who} {took * 1e3:.2f} ms (tolerance {at:.0e})" for who, (took, at) in least.items())
        print(f"{name} to {wanted:.0e}: {words}, ratio {ratio:.2f}")
