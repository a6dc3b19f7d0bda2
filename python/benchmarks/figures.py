"""Prints the figures of BENCHMARKS.md. `python figures.py [PROGRAM]`; numba and heyoka are compared with where they are installed.

What is compared is taken in turns, and the least of some rounds counts: the machine need not be quiet.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import coadjoint as co

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else None


def least(rounds, **calls):
    """The least time of each call, in seconds."""
    times = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            begun = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - begun)
    return {name: min(all_) for name, all_ in times.items()}


def fresh(code):
    """The least time of a new interpreter over one that does nothing."""
    run = lambda code: subprocess.run([sys.executable, "-c", code], check=True)  # noqa: E731
    found = least(9, empty=lambda: run("import numpy"), full=lambda: run(code))
    return found["full"] - found["empty"]


HEAVY_TOP = dict(
    group="SO3",
    advected="gamma: R3",
    potential="weight * gamma.dot(&chi)",
    inertia="inertia: Vector3",
    parameters="weight: float, chi: Vector3",
)
# as the catalogue's, whose states are the paper's
top, y0 = co.systems.heavy_top.example, co.systems.heavy_top.state()
body = co.systems.free_rigid_body

print(f"import coadjoint, beside numpy: {fresh('import coadjoint') * 1e3:.0f} ms")


def to_first_step():
    made = co.System(**HEAVY_TOP)(inertia=[1, 10, 100], weight=1, chi=[0, 0, 1])
    made.stepper(0.01).step(made.state(momentum=[1, 1, 1], gamma=[0, 0, 1]))


print(f"text to the first step: {least(20, all=to_first_step)['all'] * 1e3:.1f} ms")

stepper, one, many = top.stepper(0.01), y0.copy(), y0.copy()
flat, together = one.flat, top.stepper(0.01)


def calls():
    step = stepper.step
    for _ in range(10_000):
        step(flat)


found = least(15, calls=calls, together=lambda: together.steps(many, 10_000))
call, inside = (found[name] / 10_000 * 1e9 for name in ("calls", "together"))
print(f"a call of one step: {call:.0f} ns, of which the step {inside:.0f} ns: {call - inside:.0f} ns above it")

keeps = least(5, last=lambda: top.run(y0, 1800, step=0.01, every=180_000), all=lambda: top.run(y0, 1800, step=0.01))
print(f"180,000 steps of the heavy top, exponential: {keeps['last'] * 1e3:.0f} ms, all recorded {keeps['all'] * 1e3:.0f} ms")

members = np.random.default_rng(1).normal(size=(10_000, 3))
states = {"momentum": members, "gamma": [0.0, 0.0, 1.0]}
took = least(3, ensemble=lambda: top.ensemble(states, t_span=1, step=0.01, scheme="cayley"))["ensemble"]
print(f"10,000 members, 100 steps each, Cayley: {took * 1e3:.0f} ms, {took / 1e6 * 1e9:.1f} ns for a step of a member")

if PROGRAM:
    with tempfile.TemporaryDirectory() as folder:
        text = Path(folder) / "heavy_top.rs"
        text.write_text(co.systems.heavy_top.text)

        def program(*options):
            def call():
                command = [PROGRAM, "run", *options, "--out", folder, "--force", "--quiet", "--every", "180000"]
                subprocess.run(command, check=True, capture_output=True)

            return call

        sets = []
        for quantity, values in (("inertia", "1,10,100"), ("weight", "1"), ("chi", "0,0,1"), ("momentum", "1,1,1"), ("gamma", "0,0,1")):
            sets += ["--set", f"{quantity}={values}"]
        helped = subprocess.run([PROGRAM, "run", "--help"], capture_output=True, text=True, check=True).stdout
        described = ["--description", str(text), *sets]
        runs = {"compiled": ["heavy_top"]}
        if "--description" in helped:
            runs["text"] = described
        # what the program takes beside the steps: its start and its reading
        begins = {f"{name}_start": program(*run, "--duration", "0.01", "--step", "0.01") for name, run in runs.items()}
        wholes = {name: program(*run, "--duration", "1800", "--step", "0.01") for name, run in runs.items()}
        found = least(5, python=lambda: top.run(y0, 1800, step=0.01, every=180_000), **begins, **wholes)
        for name in runs:
            own = found[name] - found[f"{name}_start"]
            print(f"the program, {name}, without its start: {own * 1e3:.0f} ms; Python / program {found['python'] / own:.2f}")

        command = [PROGRAM, "ensemble", "heavy_top", "--members", "10000", "--block", "10000", "--duration", "1", "--step", "0.01"]
        command += ["--every", "100", "--out", folder, "--force", "--json"]
        # members as the program draws them
        drawn = {"momentum": np.random.default_rng(1).uniform(0.99, 1.01, (10_000, 3)), "gamma": [0.0, 0.0, 1.0]}
        its, ours = [], []
        for _ in range(5):
            # by its own clock, which leaves out what draws members and pictures
            its.append(json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["seconds"])
            ours.append(least(1, one=lambda: top.ensemble(drawn, t_span=1, step=0.01, scheme="cayley"))["one"])
        took = f"{min(its) * 1e3:.0f} ms; Python / program {min(ours) / min(its):.2f}"
        print(f"the program's steps of 10,000 members: {took}")


# -- at equal error ----------------------------------------------------------------------------------------------------------------------------

END = 1800.0
#: Where a Taylor method with 40 digits leads the free body: attitude, momentum, gamma.
FREE_BODY = [0.24326931190348805, -0.6249400018701446, -0.724368806738971, 0.1598745375977873, 1.035228567192545,
             0.45969549742538734, -1.3103365458214526, 0.15260941470878095, -0.5356737045271371, -0.8305203482277943]


def others(inertia, weight, start):
    """Right sides of the free body and the heavy top, as each of the others wants them: attitude, momentum, gamma."""
    i1, i2, i3 = map(float, inertia)
    made = {}
    try:
        from numba import njit

        @njit
        def fun(t, y):
            w, x, yy, z, a, b, c, g1, g2, g3 = y
            o1, o2, o3 = a / i1, b / i2, c / i3
            return np.array(
                [
                    -0.5 * (x * o1 + yy * o2 + z * o3),
                    0.5 * (w * o1 + yy * o3 - z * o2),
                    0.5 * (w * o2 + z * o1 - x * o3),
                    0.5 * (w * o3 + x * o2 - yy * o1),
                    b * o3 - c * o2 + weight * g2,
                    c * o1 - a * o3 - weight * g1,
                    a * o2 - b * o1,
                    g2 * o3 - g3 * o2,
                    g3 * o1 - g1 * o3,
                    g1 * o2 - g2 * o1,
                ]
            )

        fun(0.0, start)
        from scipy.integrate import solve_ivp

        made["DOP853 of scipy, right side by numba"] = lambda tolerance: solve_ivp(
            fun, (0, END), start, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=[END]
        ).y[:, -1]
    except ImportError:
        print("numba is not installed: scipy is not compared with")
    try:
        import heyoka as hy

        w, x, y, z, a, b, c, g1, g2, g3 = hy.make_vars("w", "x", "y", "z", "a", "b", "c", "g1", "g2", "g3")
        o1, o2, o3 = a / i1, b / i2, c / i3
        system = [
            (w, -0.5 * (x * o1 + y * o2 + z * o3)),
            (x, 0.5 * (w * o1 + y * o3 - z * o2)),
            (y, 0.5 * (w * o2 + z * o1 - x * o3)),
            (z, 0.5 * (w * o3 + x * o2 - y * o1)),
            (a, b * o3 - c * o2 + weight * g2),
            (b, c * o1 - a * o3 - weight * g1),
            (c, a * o2 - b * o1),
            (g1, g2 * o3 - g3 * o2),
            (g2, g3 * o1 - g1 * o3),
            (g3, g1 * o2 - g2 * o1),
        ]
        compiled = {}

        def heyoka(tolerance):
            # to compile it is not counted
            if tolerance not in compiled:
                compiled[tolerance] = hy.taylor_adaptive(system, start, tol=tolerance)
            taylor = compiled[tolerance]
            taylor.time, taylor.state[:] = 0.0, start
            taylor.propagate_until(END)
            return np.array(taylor.state)

        made["heyoka"] = heyoka
    except ImportError:
        print("heyoka is not installed: it is not compared with")
    return made


def sweep(solve, choices, exact):
    """Errors at the end, and times, of some choices; a warm call goes before."""
    rows = []
    for choice in choices:
        end = solve(choice)
        error = np.abs(end - exact).max()
        rows.append((error, least(3, it=lambda choice=choice: solve(choice))["it"]))
    return rows


def at(rows, wanted):
    """The least time of a choice whose error is no larger."""
    good = [took for error, took in rows if error <= wanted]
    return f"{min(good) * 1e3:8.1f}" if good else "       -"


ERRORS = (1e-4, 1e-6, 1e-8)
for name, weight in (("free body", 0.0), ("heavy top", 1.0)):
    moving = co.System(
        group="SO3",
        advected="gamma: R3",
        potential="weight * gamma.dot(&chi)",
        taylor=True,
        methods="HamiltonJacobi(6), HamiltonJacobi(8)",
        inertia="inertia: Vector3",
        parameters="weight: float, chi: Vector3",
    )(inertia=[1, 10, 100], weight=weight, chi=[0, 0, 1])
    start = moving.state(momentum=[1, 1, 1], gamma=[0, 0, 1]).flat
    exact = moving.run(start, END, tolerance=1e-16).end.flat
    if name == "free body":
        print(f"\nthe exact end of the free body: off by {np.abs(exact - FREE_BODY).max():.1e}")
    print(f"\n{name}")
    fixed = lambda order: lambda step: moving.run(start, END, step=step, order=order, every=10**9).end.flat  # noqa: E731
    rows = {
        "Taylor steps": sweep(lambda tolerance: moving.run(start, END, tolerance=tolerance, every=10**9).end.flat,
                              10.0 ** -np.arange(5, 17), exact),
        "exponential, order 6": sweep(fixed(6), 0.8 / 2.0 ** np.arange(6), exact),
        "exponential, order 8": sweep(fixed(8), 1.6 / 2.0 ** np.arange(6), exact),
        "exponential, order 10": sweep(fixed(10), 3.2 / 2.0 ** np.arange(6), exact),
    }
    for order in (6, 8):
        solve = lambda step, order=order: moving.run(start, END, step=step, scheme="hamilton-jacobi", order=order, every=10**9).end.flat  # noqa: E731
        try:
            rows[f"Hamilton–Jacobi, order {order}"] = sweep(solve, 0.4 / 2.0 ** np.arange(6), exact)
        except co.StepError as error:
            print(f"Hamilton–Jacobi, order {order}: {error}")
    for other, solve in others([1, 10, 100], weight, start).items():
        rows[other] = sweep(solve, 10.0 ** -np.arange(4, 14), exact)
    print(f"{'ms to the end, at an error of':40}" + "".join(f"{error:>10.0e}" for error in ERRORS))
    for method, found in rows.items():
        print(f"{method:40}" + "".join(f"{at(found, error):>10}" for error in ERRORS))
