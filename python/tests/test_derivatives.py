"""Derivatives of steps and runs, against differences, and as functions of JAX and PyTorch where these are there."""

import numpy as np
import pytest

import coadjoint as co

H = 1e-5


@pytest.fixture(scope="module")
def driven():
    return co.System(
        group="SO3",
        advected="gamma: R3",
        potential="weight * gamma.dot(&chi)",
        control="moment: R3",
        force="moment",
        derivatives=True,
        inertia="inertia: Vector3",
        parameters="weight: float, chi: Vector3",
    )(inertia=[1, 2, 2.5], weight=1, chi=[0.1, 0.2, 1])


@pytest.fixture(scope="module")
def start(driven):
    return driven.state(attitude=[0.5, 0.5, 0.5, 0.5], momentum=[0.4, -0.8, 1.5], gamma=[0.6, 0, 0.8])


def difference(f, plus, minus):
    """Of order 4, of two pairs of ends."""
    return (8 * (f(plus[0]) - f(minus[0])) - (f(plus[1]) - f(minus[1]))) / (12 * H)


@pytest.mark.parametrize(("scheme", "order"), [("exponential", None), ("cayley", 4)])
def test_a_step(driven, start, scheme, order):
    control = np.array([0.1, 0.2, 0.3])

    def step(system=driven, y=start, u=control):
        y = y.copy()
        system.stepper(0.1, scheme, order).step(y, u)
        return y.flat

    found = driven.jacobian(start, 0.1, scheme, order, control=control)
    assert (found.y.flat == step()).all()
    assert (found.state.shape, found.control.shape, found.parameters.shape) == ((9, 9), (9, 3), (9, 7))
    onto = driven.tangent_map(found.y)
    for k in range(9):
        e = np.eye(9)[k] * H
        own = difference(lambda by: step(y=driven.displace(start, by)), (e, 2 * e), (-e, -2 * e))
        assert np.abs(onto @ found.state[:, k] - own).max() < 1e-9
    for k in range(3):
        e = np.eye(3)[k] * H
        own = difference(lambda by: step(u=control + by), (e, 2 * e), (-e, -2 * e))
        assert np.abs(onto @ found.control[:, k] - own).max() < 1e-9
    for k in range(7):
        e = np.eye(7)[k] * H
        flat = driven.parameters.flat
        own = difference(lambda by: step(system=driven.system(flat + by)), (e, 2 * e), (-e, -2 * e))
        assert np.abs(onto @ found.parameters[:, k] - own).max() < 1e-9


def test_a_run(driven, start):
    rng = np.random.default_rng(4)
    grid, pushes, weights = np.array([0.0, 0.5]), rng.normal(size=(2, 3)), rng.normal(size=(21, 10))

    def run(system=driven, y=start, pushes=pushes):
        return system.run(y, (0, 1), step=0.05, scheme="cayley", controls=(grid, pushes))

    def loss(**changes):
        return float((run(**changes).y.flat * weights).sum())

    gradient = run().gradient(weights)
    flat = driven.parameters.flat
    for k in range(7):
        e = np.eye(7)[k] * H
        own = difference(lambda by: loss(system=driven.system(flat + by)), (e, 2 * e), (-e, -2 * e))
        assert abs(gradient.parameters.flat[k] - own) < 1e-7 * max(1, abs(own))
    for k in range(9):
        e = np.eye(9)[k] * H
        own = difference(lambda by: loss(y=driven.displace(start, by)), (e, 2 * e), (-e, -2 * e))
        assert abs(gradient.tangent[k] - own) < 1e-7 * max(1, abs(own))
    # of vectors the stored numbers are coordinates
    assert np.abs(gradient.y0.flat[4:] - gradient.tangent[3:]).max() < 1e-12
    assert abs(gradient.y0.attitude @ start.attitude) < 1e-12
    # each control is held over the step that leads to its row
    for interval, rows in ((0, slice(1, 11)), (1, slice(11, 21))):
        e = np.zeros((2, 3))
        e[interval, 1] = H
        own = difference(lambda by: loss(pushes=pushes + by), (e, 2 * e), (-e, -2 * e))
        assert abs(gradient.controls.moment[rows, 1].sum() - own) < 1e-7 * max(1, abs(own))
    last = run().gradient(weights[-1])
    only = np.zeros_like(weights)
    only[-1] = weights[-1]
    assert (last.parameters.flat == run().gradient(only).parameters.flat).all()


def invariant(side):
    """A body that falls over, a plate on springs, and areas: whose losses see where they are."""
    body = co.System(
        group="SO3",
        invariance=side,
        control="moment: R3",
        potential="weight * (attitude * chi).z",
        force="moment - 0.1 * velocity",
        derivatives=True,
        inertia="inertia: Vector3",
        parameters="weight: float, chi: Vector3",
    )(inertia=[1, 2, 2.5], weight=0.7, chi=[0.3, -0.2, 0.9])
    plate = co.System(
        group="SE2",
        invariance=side,
        potential="0.5 * stiffness * pose.translation.x.powi(2) + weight * pose.translation.y",
        derivatives=True,
        inertia="inertia: Vector3",
        parameters="stiffness: float, weight: float",
    )(inertia=[1, 2, 2.5], stiffness=0.7, weight=0.3)
    areas = co.System(
        group="SL(2)",
        invariance=side,
        hamiltonian="0.5 * momentum.dot(&momentum.component_div(&inertia))",
        derivatives=True,
        parameters="inertia: Vector3",
    )(inertia=[1, 2, 2.5])
    return {"body": body, "plate": plate, "areas": areas}


@pytest.mark.parametrize("name", ["body", "plate", "areas"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_coordinates_of_tangent_vectors(side, name):
    system = invariant(side)[name]
    start = system.displace(system.state(), [0.4, -0.3, 0.6, 0.5, 0.9, -0.7])

    # how stored numbers change by displacements, and by the motion
    onto = system.tangent_map(start)
    for k in range(6):
        e = np.eye(6)[k] * H
        own = difference(lambda by: system.displace(start, by).flat, (e, 2 * e), (-e, -2 * e))
        assert np.abs(onto[:, k] - own).max() < 1e-9

    def step(y):
        y = y.copy()
        system.stepper(0.1).step(y)
        return y.flat

    found = system.jacobian(start, 0.1)
    onto = system.tangent_map(found.y)
    for k in range(6):
        e = np.eye(6)[k] * H
        own = difference(lambda by: step(system.displace(start, by)), (e, 2 * e), (-e, -2 * e))
        assert np.abs(onto @ found.state[:, k] - own).max() < 1e-9

    weights = np.random.default_rng(5).normal(size=(11, len(start.flat)))

    def loss(system=system, y=start):
        return float((system.run(y, 1, step=0.1).y.flat * weights).sum())

    gradient = system.run(start, 1, step=0.1).gradient(weights)
    for k in range(6):
        e = np.eye(6)[k] * H
        own = difference(lambda by: loss(y=system.displace(start, by)), (e, 2 * e), (-e, -2 * e))
        assert abs(gradient.tangent[k] - own) < 1e-7 * max(1, abs(own))
    # by the stored numbers, it says the same of every displacement
    assert np.abs(system.tangent_map(start).T @ gradient.y0.flat - gradient.tangent).max() < 1e-10
    flat = system.parameters.flat
    for k in range(len(flat)):
        e = np.eye(len(flat))[k] * H
        own = difference(lambda by: loss(system=system.system(flat + by)), (e, 2 * e), (-e, -2 * e))
        assert abs(gradient.parameters.flat[k] - own) < 1e-7 * max(1, abs(own))


def test_turns_are_about_the_axes_of_the_side():
    about = {}
    for side in ("left", "right"):
        body = invariant(side)["body"]
        lying = body.displace(body.state(), [np.pi / 2, 0, 0, 0, 0, 0])
        about[side] = body.displace(lying, [0, 0, np.pi / 2, 0, 0, 0]).attitude
    # the body's third axis lies along −y by now
    assert np.abs(about["left"] - [0.5, 0.5, -0.5, 0.5]).max() < 1e-12
    assert np.abs(about["right"] - [0.5, 0.5, 0.5, 0.5]).max() < 1e-12


def test_jax():
    pytest.importorskip("jax")
    import runpy
    from pathlib import Path

    found = runpy.run_path(str(Path(__file__).parent / "../examples/with_jax.py"))
    assert found["distance"] < 1e-6


def test_torch():
    pytest.importorskip("torch")
    import runpy
    from pathlib import Path

    found = runpy.run_path(str(Path(__file__).parent / "../examples/with_torch.py"))
    assert found["distance"] < 1e-6


def test_what_is_not_asked_for_is_not_there():
    def body(derivatives):
        system = co.System(group="SO3", inertia="J: Vector3", control="u: R3", force="u", derivatives=derivatives)
        return system(J=[1, 2, 3.0])

    some, y = body("state"), {"momentum": [1, 2, 3.0]}
    found = some.jacobian(some.state(y), 0.1)
    assert (found.state.shape, found.control.shape, found.parameters.shape) == ((6, 6), (6, 0), (6, 0))
    gradient = some.run(y, 1, step=0.1).gradient(np.ones(7))
    assert gradient.parameters is None and gradient.controls is None
    whole = body(True).run(y, 1, step=0.1).gradient(np.ones(7))
    assert (gradient.tangent == whole.tangent).all() and whole.parameters.flat.any() and whole.controls.flat.any()
    for derivatives in ("adjoint", "tangent"):
        with pytest.raises(ValueError, match=r"derivatives\(state\)"):
            body(derivatives).run(y, 1, step=0.1).gradient(np.ones(7))


def test_steps_take_controls_as_lists():
    body = co.System(group="SO3", inertia="J: Vector3", control="u: R3", force="u")(J=[1, 2, 3.0])
    ways = []
    for control in (np.array([0.1, 0.0, 2.0]), [0.1, 0, 2]):
        y, stepper = body.state(momentum=[1, 2, 3.0]), body.stepper(0.1)
        stepper.step(y, control)
        stepper.steps(y, 3, control)
        ways.append(y.flat)
    assert (ways[0] == ways[1]).all()
    with pytest.raises(ValueError, match="2 numbers in place of 3"):
        body.stepper(0.1).step(body.state(), [0.1, 0.2])
