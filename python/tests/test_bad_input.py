"""Bad input is an exception, never an abort, and what was there is as before."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import coadjoint as co

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("named", "error"),
    [
        ({}, ValueError),
        ({"inertia": [1, 2, 3]}, ValueError),
        ({"inertia": [1, 2], "weight": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [1, 2, 3, 4], "weight": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [[1, 2, 3]], "weight": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": "abc", "weight": 1, "chi": [0, 0, 1]}, TypeError),
        ({"inertia": [1, 2, None], "weight": 1, "chi": [0, 0, 1]}, TypeError),
        ({"inertia": [1, 2, 3j], "weight": 1, "chi": [0, 0, 1]}, TypeError),
        ({"inertia": [1, 2, NAN], "weight": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [1, 2, -3], "weight": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [1, 2, 0], "weight": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [1, 2, 3], "weight": [1, 2], "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [1, 2, 3], "wait": 1, "chi": [0, 0, 1]}, ValueError),
        ({"inertia": [1, 2, 3], "weight": INF, "chi": [0, 0, 1]}, ValueError),
    ],
)
def test_parameters(HeavyTop, named, error):
    with pytest.raises(error):
        HeavyTop(**named)


@pytest.mark.parametrize(
    ("y", "error"),
    [
        (None, ValueError),
        ({}, ValueError),
        ([1, 0, 0, 0], ValueError),
        (np.zeros((2, 10)), ValueError),
        (np.zeros(11), ValueError),
        (["a"] * 10, TypeError),
        ([1, 0, 0, 0, 1, 1, NAN, 0, 0, 1], co.StepError),
        ([1, 0, 0, 0, 1, 1, INF, 0, 0, 1], co.StepError),
        ([2, 0, 0, 0, 1, 1, 1, 0, 0, 1], co.StepError),
        ([0, 0, 0, 0, 1, 1, 1, 0, 0, 1], co.StepError),
        ({"momentum": [1, 1], "gamma": [0, 0, 1]}, ValueError),
        ({"momentun": [1, 1, 1], "gamma": [0, 0, 1]}, ValueError),
        ({"gamma": object()}, TypeError),
        ({"momentum": [1, 1, 1], "velocity": [1, 1, 1], "gamma": [0, 0, 1]}, ValueError),
        ({"velocity": [1, 1], "gamma": [0, 0, 1]}, ValueError),
        ({"hull_velocity": [1, 1, 1], "gamma": [0, 0, 1]}, ValueError),
    ],
)
def test_states(top, y, error):
    with pytest.raises(error):
        top.run(y, 1, step=0.01)


@pytest.mark.parametrize(
    ("keys", "error"),
    [
        ({}, TypeError),
        ({"step": 0.01, "tolerance": 1e-9}, TypeError),
        ({"step": 0}, ValueError),
        ({"step": NAN}, ValueError),
        ({"step": INF}, ValueError),
        ({"step": "0.1"}, TypeError),
        ({"step": True}, TypeError),
        ({"step": 0.01, "scheme": "no such"}, ValueError),
        ({"step": 0.01, "scheme": "Midpoint<Cayley"}, ValueError),
        ({"step": 0.01, "scheme": "second-kind"}, ValueError),
        ({"step": 0.01, "scheme": "midpoint"}, ValueError),
        ({"step": 0.01, "scheme": 3}, TypeError),
        ({"step": 0.01, "order": 3}, ValueError),
        ({"step": 0.01, "every": 0}, ValueError),
        ({"step": 0.01, "every": 1.5}, ValueError),
        ({"step": 0.01, "t_eval": [0.5, 0.1]}, ValueError),
        ({"step": 0.01, "t_eval": [0.5, 0.5]}, ValueError),
        ({"step": 0.01, "t_eval": [0.5, 2.0]}, ValueError),
        ({"step": 0.01, "t_eval": [NAN]}, ValueError),
        ({"step": 0.01, "t_eval": [[0.5]]}, ValueError),
        ({"step": 0.01, "controls": [1.0]}, ValueError),
        ({"step": 0.01, "controls": lambda t: [1.0]}, ValueError),
        ({"step": 0.01, "events": 3}, TypeError),
        ({"step": 0.01, "events": [3]}, TypeError),
        ({"step": 0.01, "events": lambda: 0.0}, TypeError),
        ({"step": 0.01, "events": lambda t, y: "a"}, ValueError),
        ({"step": 0.01, "events": lambda t, y: None}, TypeError),
        ({"step": 0.01, "progress": 3}, TypeError),
        ({"tolerance": 2.0}, ValueError),
        ({"tolerance": NAN}, ValueError),
    ],
    ids=lambda value: str(value)[:50],
)
def test_runs(top, y0, keys, error):
    before = y0.flat.copy()
    with pytest.raises(error):
        # long enough that progress is told
        top.run(y0, 100 if "progress" in keys else 1, **keys)
    assert (y0.flat == before).all()


@pytest.mark.parametrize("step", [-0.1, 0, 0.0, -0.0, NAN, INF, -INF])
@pytest.mark.parametrize("span", [10, (0, 10), -10, (10, 0)])
def test_the_direction_is_that_of_the_span(top, y0, span, step):
    runs = (
        lambda: top.run(y0, span, step=step),
        lambda: top.ensemble(y0, n=2, t_span=span, step=step),
        lambda: top.ensemble(lambda k, rng: y0, n=2, t_span=span, step=step, quantities={"energy": lambda sol: sol.energy}),
    )
    for run in runs:
        with pytest.raises(ValueError, match="the step is a length, .* and `t_span` says the direction"):
            run()


def test_nothing_is_written_for_a_step_that_is_none(top, y0, tmp_path):
    with pytest.raises(ValueError, match="t_span"):
        top.ensemble(y0, n=2, t_span=1, step=-0.1, quantities={"energy": lambda sol: sol.energy}, rows=tmp_path / "rows.csv")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("span", [NAN, INF, (0, NAN), (0, 1, 2), "a", None, (0, 1e300), [[0, 1]]])
def test_spans(top, y0, span):
    with pytest.raises((ValueError, TypeError, co.StepError)):
        top.run(y0, span, step=0.01)


@pytest.mark.parametrize(
    "controls",
    [
        [1.0, 2.0],
        {"pull": 1.0},
        "a",
        [NAN],
        ([0.0, 1.0], [[1.0]]),
        ([1.0, 0.0], [[1.0], [2.0]]),
        ([0.0, NAN], [[1.0], [2.0]]),
        ([], []),
        lambda: 0.0,
        lambda a, b, c: 0.0,
        lambda t: [1.0, 2.0],
        lambda t: None,
        lambda t: [NAN],
        lambda t: 1 / 0,
        lambda t, y: y.no_such,
        lambda t, y: 1 / 0,
    ],
)
def test_controls(cart, controls):
    with pytest.raises((ValueError, TypeError, ZeroDivisionError, AttributeError, co.StepError)):
        cart.run([0, 0], 1, step=0.01, controls=controls)
    # nothing is left behind
    assert cart.run([0, 0], 1, step=0.5).nsteps == 2


def test_what_an_event_raises_is_raised(top, y0):
    for place in (0, 3, 50):
        calls = []

        def event(t, y, place=place, calls=calls):
            calls.append(t)
            if len(calls) > place:
                raise LookupError("here")
            return 1.0

        with pytest.raises(LookupError, match="here"):
            top.run(y0, 10, step=0.01, events=event)
        # the run ends soon
        assert len(calls) < place + 20

    def event(t, y):
        return y.gamma[2] - 0.99

    for wrong in (lambda t, y: [1.0], lambda t, y: 1 / 0, lambda t, y: "a"):
        event.apply = wrong
        with pytest.raises((ValueError, ZeroDivisionError, TypeError)):
            top.run(y0, 10, step=0.01, events=event)
    for attribute, value in (("terminal", -1), ("terminal", 1.5), ("direction", "up")):
        bad = lambda t, y: 1.0  # noqa: E731
        setattr(bad, attribute, value)
        with pytest.raises(ValueError):
            top.run(y0, 1, step=0.01, events=bad)


def test_a_step_that_cannot_be_taken_tells_where():
    pole = co.System(group="R1", potential="position.x.sqrt()", inertia="mass: float")(mass=1)
    with pytest.raises(co.StepError) as caught:
        pole.run([1.0, 0.0], 100, step=0.05)
    error = caught.value
    assert isinstance(error, ArithmeticError) and 0.5 < error.t < 100 and error.y.shape == (2,)
    reached = error.solution
    assert not reached.success and reached.status == -1 and reached.message == str(error)
    assert reached.t[-1] == error.t and (reached.y.flat[-1] == error.y).all()
    assert len(reached.t) == error.step
    stepper, y = pole.stepper(0.05), np.array([NAN, 0.0])
    with pytest.raises(co.StepError) as caught:
        stepper.step(y)
    assert np.isnan(y[0]) and caught.value.step is None and stepper.t == 0.0


@pytest.mark.parametrize(
    ("y", "error"),
    [
        (None, (TypeError, AttributeError)),
        ([1.0] * 10, (TypeError, AttributeError)),
        (np.ones(10, dtype=np.float32), TypeError),
        (np.ones(10, dtype=int), TypeError),
        (np.ones((1, 10)), TypeError),
        (np.ones(20)[::2], (BufferError, ValueError)),
        (np.ones(9), co.StepError),
        (np.broadcast_to(1.0, 10), (BufferError, ValueError)),
    ],
)
def test_arrays_of_single_steps(top, y, error):
    stepper = top.stepper(0.01)
    with pytest.raises(error):
        stepper.step(y)
    with pytest.raises((*error, ValueError) if isinstance(error, tuple) else (error, ValueError)):
        stepper.steps(y, 3)


def test_read_only_states_are_refused(top, y0):
    y0.flat.flags.writeable = False
    with pytest.raises((BufferError, ValueError)):
        top.stepper(0.01).step(y0)
    with pytest.raises(ValueError):
        top.parameters.weight[...] = 3.0
    # and taken where they are only read
    assert top.run(y0, 0.1, step=0.01).nsteps == 10


def test_arrays_of_any_kind_are_read(top, y0):
    expected = top.run(y0, 1, step=0.01).y.flat
    strided = np.empty(20)
    strided[::2] = y0.flat
    for y in (list(y0.flat), tuple(y0.flat), strided[::2], y0.flat[::-1].copy()[::-1], y0.flat.astype(">f8"), y0.flat.astype(np.float32)):
        assert (top.run(y, 1, step=0.01).y.flat == expected).all()


@pytest.mark.parametrize(
    ("states", "keys", "error"),
    [
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.3}, ValueError),
        ({"momentum": np.ones((3, 3))}, {"t_span": 1, "step": 0.1}, ValueError),
        ({"momentum": np.ones((3, 3)), "gamma": np.ones((2, 3))}, {"t_span": 1, "step": 0.1}, ValueError),
        ({"momentum": np.ones((3, 2)), "gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1}, ValueError),
        (np.ones((3, 9)), {"t_span": 1, "step": 0.1}, ValueError),
        (np.ones((3, 10)), {"t_span": 1, "step": 0.1}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "parameters": {"weight": [1, NAN]}}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "parameters": {"wait": [1]}}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "parameters": np.ones((3, 4))}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "n": 3, "parameters": {"weight": [1, 2]}}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "controls": [1.0]}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "every": 0}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "scheme": "midpoint"}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 1, "step": 0.1, "device": "tpu"}, ValueError),
        ({"gamma": [0, 0, 1]}, {"t_span": 200, "step": 0.001, "progress": lambda share: 1 / 0}, ZeroDivisionError),
    ],
)
def test_ensembles(top, states, keys, error):
    with pytest.raises(error):
        top.ensemble(states, **keys)


def test_a_member_that_fails_stays_where_it_is():
    pole = co.System(group="R1", potential="position.x.sqrt()", inertia="mass: float")(mass=1)
    sol = pole.ensemble([[1.0, 0.0], [50.0, 0.0], [1.1, 0.0]], t_span=5, step=0.05, scheme="exponential", every=10)
    assert [one.member for one in sol.failed] == [0, 2] and sol.ok.tolist() == [False, True, False]
    assert sol.failed[0].step > 10 and sol.failed[0].reason
    assert np.isfinite(sol.y.flat).all()
    assert (sol.y.flat[-1, 0] == sol.y.flat[-2, 0]).all() and (sol.y.flat[-1, 1] != sol.y.flat[-2, 1]).all()


def test_what_is_used_lives(top, y0):
    HeavyTop = co.System(**__import__("conftest").HEAVY_TOP)
    own = HeavyTop(inertia=[1, 2, 3], weight=1, chi=[0, 0, 1])
    sol = own.run(y0, 1, step=0.01)
    stepper = own.stepper(0.01)
    view = sol.y.momentum
    last = sol.y.flat[-1].copy()
    del HeavyTop, own
    gc.collect()
    assert sol(0.5).flat.shape == (10,) and np.isfinite(sol.energy).all()
    y = y0.copy()
    stepper.steps(y, 100)
    assert (y.flat == last).all()
    del sol
    gc.collect()
    assert (view[-1] == last[4:7]).all()


def test_one_stepper_in_two_threads(top):
    """A stepper that is in use says so; no one waits for ever."""
    stepper, seen = top.stepper(0.001, order=10), []

    def work():
        y = top.state(momentum=[1, 1, 1], gamma=[0, 0, 1])
        try:
            stepper.steps(y, 30_000)
        except RuntimeError as error:
            seen.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("in use in another thread" in one for one in seen) and len(seen) <= 1


def test_an_array_that_is_in_use(top, y0):
    """While steps are taken without Python's lock, nobody else may step the same state."""
    busy, said = threading.Event(), []

    def work():
        busy.set()
        top.stepper(0.001, order=10).steps(y0, 60_000)

    thread = threading.Thread(target=work)
    thread.start()
    busy.wait()
    time.sleep(0.05)
    while thread.is_alive():
        try:
            top.stepper(0.01).step(y0)
        except BufferError as error:
            said.append(error)
            break
    thread.join()
    assert said


def test_other_threads_go_on(top, y0):
    counted = 0
    thread = threading.Thread(target=lambda: top.run(y0, 300, step=0.001, order=6, every=1000))
    thread.start()
    while thread.is_alive():
        counted += 1
        time.sleep(0.001)
    assert counted > 20


INTERRUPTED = """
import coadjoint as co, signal, sys
# whoever was started in the background inherits that it is ignored
signal.signal(signal.SIGINT, signal.default_int_handler)
top = co.systems.heavy_top.example
y = co.systems.heavy_top.state()
calls = {
    "run": lambda: top.run(y, 1e7, step=0.01, every=10**9),
    "steps": lambda: top.stepper(0.01).steps(y, 10**9),
    "ensemble": lambda: top.ensemble(y, n=1000, t_span=1e5, step=0.01),
    "events": lambda: top.run(y, 1e7, step=0.01, every=10**9, events=lambda t, y: 1.0),
}
print("ready", flush=True)
try:
    calls[sys.argv[1]]()
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.parametrize("call", ["run", "steps", "ensemble", "events"])
@pytest.mark.skipif(os.name == "nt", reason="signals are others there")
def test_interrupts(call):
    process = subprocess.Popen([sys.executable, "-c", INTERRUPTED, call], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    begun = time.monotonic()
    try:
        said, _ = process.communicate(timeout=20)
    finally:
        process.kill()
    assert said == "interrupted\n" and process.returncode == 0
    assert time.monotonic() - begun < 5


def test_what_there_is_not_is_named(HeavyTop, top, cart):
    with pytest.raises(ValueError, match=r"there is no parameter `weigth`; did you mean `weight`\?"):
        HeavyTop(inertia=[1, 2, 3], weigth=1, chi=[0, 0, 1])
    with pytest.raises(ValueError, match="there is no parameter `b`; known: inertia, weight, chi"):
        HeavyTop(b=1)
    with pytest.raises(ValueError, match="there is no control `b`; known: push"):
        cart.run([0, 0], 1, step=0.1, controls={"b": 1})
    with pytest.raises(ValueError, match="the state has no `b`: it has attitude, momentum, gamma"):
        top.state(b=1)
    with pytest.raises(TypeError, match=r"velocities in the places of its momenta, .* `state\(velocity=…\)`"):
        top.with_velocity(top.state(gamma=[0, 0, 1]), [1, 0, 0.2])
    with pytest.raises(ValueError, match="no event 'low': `event=` gives it some"):
        top.run(top.state(gamma=[0, 0, 1]), 1, step=0.1, events="low")


def test_steps_that_were_not_derived_are_asked_for_by_keywords(top, y0):
    asked = {
        'methods="…"': (lambda: top.run(y0, 1, step=0.1, scheme="midpoint"), lambda: top.stepper(0.1, "midpoint")),
        'retractions="…"': (lambda: top.ensemble(y0, n=2, t_span=1, step=0.1, scheme="second-kind"), lambda: top.certify(y0, "second-kind")),
        "taylor=True": (lambda: top.run(y0, 1, tolerance=1e-9),),
        "derivatives=True": (lambda: top.jacobian(y0, 0.1), lambda: top.run(y0, 1, step=0.1).gradient(y0.flat)),
    }
    for said, calls in asked.items():
        for call in calls:
            with pytest.raises(ValueError) as caught:
                call()
            assert f"`{said}` in its description asks for" in str(caught.value)


def test_derivatives_that_there_are_not_are_refused(top, y0):
    with pytest.raises(ValueError, match="derivatives"):
        top.jacobian(y0, 0.01)
    sol = top.run(y0, 0.1, step=0.01)
    for wrong in (np.ones(3), np.ones((11, 3)), np.ones((3, 10))):
        with pytest.raises(ValueError):
            sol.gradient(wrong)
    with pytest.raises(ValueError, match="derivatives"):
        sol.gradient(np.ones(10))


def test_no_program_is_said(top, y0):
    with pytest.raises(RuntimeError, match="no program"):
        top.run(y0, 0.1, step=0.01).view(program="no-such-program")


def test_certificates_without_states_are_refused(top):
    for states in ([], np.ones((2, 9)), {"momentum": [1, 1, 1]}):
        with pytest.raises((ValueError, TypeError, IndexError)):
            top.certify(states)
