"""Runs: records, dense output, events, controls, tables."""

import numpy as np
import pytest

import coadjoint as co


def test_a_solution_is_views(top, y0):
    sol = top.run(y0, (0, 10), step=0.01)
    assert sol.t.shape == (1001,) and sol.y.flat.shape == (1001, 10) and sol.y.flat.flags.c_contiguous
    for name, columns in (("attitude", slice(0, 4)), ("momentum", slice(4, 7)), ("gamma", slice(7, 10))):
        assert np.shares_memory(sol.y[name], sol.y.flat)
        assert (getattr(sol.y, name) == sol.y.flat[:, columns]).all()
    assert np.shares_memory(np.asarray(sol.y), sol.y.flat)
    assert sol.y[3].momentum.shape == (3,) and sol.y[::100].gamma.shape == (11, 3)
    assert (sol.success, sol.status, sol.nsteps) == (True, 0, 1000)
    assert sol.energy.shape == (1001,) and sol.casimirs.shape == (1001, 2)
    assert np.ptp(sol.casimirs, axis=0).max() < 1e-13
    assert 1e-9 < np.ptp(sol.energy) < 1e-4
    table = sol.to_pandas()
    assert list(table.columns)[:5] == ["attitude_w", "attitude_x", "attitude_y", "attitude_z", "momentum_x"]
    assert table["energy"].iloc[-1] == sol.energy[-1] and table.shape == (1001, 13)


def test_states_are_written_through(top, y0):
    y0.momentum = [1, 2, 3]
    y0["gamma"][2] = 0.5
    assert y0.flat.tolist() == [1, 0, 0, 0, 1, 2, 3, 0, 0, 0.5]
    assert dict(y0).keys() == {"attitude", "momentum", "gamma"}
    with pytest.raises(AttributeError, match="did you mean `momentum`"):
        y0.momentun
    with pytest.raises(AttributeError):
        y0.momentun = 3
    with pytest.raises(KeyError):
        y0["x"]


def test_scipy_rotations_are_attitudes(top):
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec([0.1, -0.2, 0.3])
    y = top.state(attitude=turn, momentum=[1, 1, 1], gamma=turn.inv().apply([0, 0, 1]))
    assert abs(y.attitude[0] - np.cos(np.linalg.norm([0.1, -0.2, 0.3]) / 2)) < 1e-15
    # gamma is the vertical seen from the body: so it stays
    end = top.run(y, 5, step=0.01).end
    back = Rotation.from_quat(np.roll(end.attitude, -1)).inv().apply([0, 0, 1])
    assert np.abs(back - end.gamma).max() < 1e-13


@pytest.fixture(scope="module")
def joint():
    """A hull with an arm: the momenta of both depend on both velocities."""
    system = co.System(group={"hull": "SO3", "arm": "SO2"}, inertia={"hull, arm": "inertia: Matrix4"})
    inertia = np.diag([2.0, 3.0, 4.0, 1.0])
    inertia[0, 3] = inertia[3, 0] = 0.5
    return system(inertia=inertia)


def test_angles_are_rotations_of_the_plane(joint):
    for angle in (0.3, np.float64(0.3), [0.3], -7, [np.cos(0.3), np.sin(0.3)]):
        expected = [np.cos(angle), np.sin(angle)] if np.size(angle) == 1 else angle
        y = joint.state(arm=angle)
        assert np.abs(y.arm - np.ravel(expected)).max() == 0 and joint.deviation(y) < 1e-15
        assert joint.run({"arm": angle}, 0.1, step=0.1).success
    y.arm = 0.5
    assert y.arm.tolist() == [np.cos(0.5), np.sin(0.5)]
    angles = np.array([0.1, 0.2, 0.3])
    expected = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for given in (angles, angles[:, None], expected):
        sol = joint.ensemble({"arm": given, "hull_momentum": [1, 2, 3]}, t_span=0.1, step=0.1)
        assert (sol.start.arm == expected).all()
    assert (joint.ensemble({"arm": 0.2}, n=2, t_span=0.1, step=0.1).start.arm == expected[1]).all()
    assert (joint.ensemble({"arm": [[0.1], [0.2]]}, t_span=0.1, step=0.1).start.arm == expected[:2]).all()
    drawn = joint.ensemble(lambda k, rng: {"arm": angles[k]}, n=3, t_span=0.1, step=0.1)
    assert (drawn.start.arm == expected).all()
    many = sol.start.copy()
    many.arm = -angles
    assert (many.arm == expected * [1, -1]).all()
    arms = co.System(group={"arms": "[SO2; 2]"}, inertia={"arms": "inertia: float"})(inertia=2)
    assert (arms.state(arms=angles[:2]).flat[[0, 1, 3, 4]] == expected[:2].ravel()).all()
    for wrong in ([0.1, 0.2, 0.3], [[0.1, 0.2]], "0.1", None):
        with pytest.raises((ValueError, TypeError)):
            joint.state(arm=wrong)


def test_velocities_become_momenta(joint, top):
    y = top.state(velocity=[1, 2, 3], gamma=[0, 0, 1])
    assert y.momentum.tolist() == [1, 20, 300]
    assert y == top.with_velocity({"momentum": [1, 2, 3], "gamma": [0, 0, 1]}) == top.with_velocity({"velocity": [1, 2, 3], "gamma": [0, 0, 1]})
    assert top.run({"velocity": [1, 2, 3], "gamma": [0, 0, 1]}, 0.1, step=0.1).y[0] == y
    inertia = joint.parameters.inertia
    y = joint.state(hull_velocity=[1, 2, 3], arm_velocity=4, arm=0.3)
    assert np.abs(np.append(y.hull_momentum, y.arm_momentum) - inertia @ [1, 2, 3, 4]).max() < 1e-14
    # the arm is at rest
    y = joint.state(hull_velocity=[1, 2, 3])
    assert np.abs(np.append(y.hull_momentum, y.arm_momentum) - inertia @ [1, 2, 3, 0]).max() < 1e-14
    # the hull's other axes do not depend on the arm
    with pytest.raises(ValueError, match="the velocity of `hull` depends on `arm_momentum` too"):
        joint.state(hull_velocity=[1, 2, 3], arm_momentum=4)
    with pytest.raises(ValueError, match="`arm_velocity` and `arm_momentum` say the same"):
        joint.state(arm_velocity=1, arm_momentum=4)
    free = co.System(group={"hull": "SO3", "arm": "SO2"}, inertia={"hull": "inertia: Vector3", "arm": "arm_inertia: float"})
    y = free(inertia=[1, 2, 3], arm_inertia=5).state(hull_velocity=[1, 1, 1], arm_momentum=4)
    assert y.hull_momentum.tolist() == [1, 2, 3] and y.arm_momentum.tolist() == [4]
    arms = co.System(group={"arms": "[SO2; 2]"}, inertia={"arms": "inertia: float"})(inertia=2)
    assert arms.state(arms_velocity=[[1], [2]]).flat[[2, 5]].tolist() == [2, 4]
    assert arms.state(arms_velocity_1=3, arms_momentum_0=1).flat[[2, 5]].tolist() == [1, 6]
    with pytest.raises(ValueError, match="`arms_velocity_1` and `arms_momentum_1` say the same"):
        arms.state(arms_velocity_1=3, arms_momentum=[[1], [2]])


def test_velocities_of_members_are_with_their_own_parameters(joint):
    inertia = joint.parameters.inertia
    sizes = np.array([1.0, 2.0, 3.0])
    members = joint.ensemble(
        {"hull_velocity": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}, {"inertia": sizes[:, None, None] * inertia}, t_span=0.1, step=0.1
    )
    expected = np.stack([size * inertia[:, k] for k, size in enumerate(sizes)])
    assert np.abs(np.hstack([members.start.hull_momentum, members.start.arm_momentum]) - expected).max() < 1e-14

    def member(k, rng):
        return {"hull_velocity": np.eye(3)[k]}, {"inertia": sizes[k] * inertia}

    drawn = joint.ensemble(member, n=3, t_span=0.1, step=0.1)
    assert (drawn.start.flat == members.start.flat).all()


def test_a_table_is_held_and_a_curve_is_smooth(cart):
    from scipy.interpolate import CubicSpline

    times, push = np.linspace(0, 2, 5), np.linspace(0, 2, 5)
    held = cart.run([0, 0], 2, step=0.5, controls=(times, push[:, None]))
    # each value until the next time
    assert held.controls.push[1:, 0].tolist() == push[:-1].tolist() and abs(held.end.momentum[0] - 1.5) < 1e-12
    smooth = cart.run([0, 0], 2, step=0.01, controls=CubicSpline(times, push[:, None]))
    assert abs(smooth.end.momentum[0] - 2) < 1e-4


def test_orders_are_what_they_say(top, y0):
    exact = top.run(y0, 2, step=0.01, order=8).y.flat[-1]
    for order in (2, 4, 6):
        errors = [
            np.abs(top.run(y0, 2, step=h, order=order).y.flat[-1] - exact).max() for h in (0.1, 0.05)
        ]
        assert abs(np.log2(errors[0] / errors[1]) - order) < 0.6, (order, errors)
    names = {
        "exponential": "Exponential",
        "cayley": "Cayley",
        "verlet": "StormerVerlet",
        "Order4<Cayley>": "Order4<Cayley>",
    }
    for scheme, name in names.items():
        assert top.run(y0, 1, step=0.1, scheme=scheme).scheme == name


def test_rhs_is_what_scipy_integrates(top, y0):
    from scipy.integrate import solve_ivp

    theirs = solve_ivp(top.rhs, (0, 2), y0.flat, rtol=1e-11, atol=1e-11, t_eval=[1.0, 2.0])
    ours = top.run(y0, (0, 2), step=0.01, order=6, t_eval=[1.0, 2.0])
    assert np.abs(theirs.y.T - ours.y.flat).max() < 1e-9


def test_dense_output(top, y0):
    sol = top.run(y0, (0, 2), step=0.1, order=4)
    fine = top.run(y0, (0, 2), step=0.001, order=4)
    times = fine.t[::37]
    between = sol(times)
    assert between.flat.shape == (len(times), 10)
    assert np.abs(between.flat - fine.y.flat[::37]).max() < 1e-5
    # on its group, and with its Casimirs
    assert np.abs(np.linalg.norm(between.attitude, axis=1) - 1).max() < 1e-14
    assert np.abs(top.casimirs(between) - top.casimirs(y0)).max() < 1e-13
    # on the steps themselves what was recorded
    assert (sol(sol.t).flat == sol.y.flat).all()
    assert sol(0.55).flat.shape == (10,) and sol([[0.1, 0.2]]).gamma.shape == (1, 2, 3)
    thinned = top.run(y0, (0, 2), step=0.1, order=4, every=6)
    assert np.abs(thinned(times).flat - between.flat).max() < 1e-13
    for times in (-0.1, 2.1, [0.5, np.nan]):
        with pytest.raises(ValueError, match="known from 0.0 to 2.0 alone"):
            sol(times)


def test_t_eval_are_states_within_steps(top, y0):
    times = [0.0, 0.25, 1 / 3, 1.7, 2.0]
    sol = top.run(y0, (0, 2), step=0.1, order=4, t_eval=times)
    whole = top.run(y0, (0, 2), step=0.1, order=4)
    assert sol.t.tolist() == times
    assert np.abs(sol.y.flat - whole(times).flat).max() < 1e-14
    assert (sol.end.flat == whole.y.flat[-1]).all()
    with pytest.raises(ValueError, match="no dense output"):
        sol(0.1)
    both = top.run(y0, (0, 2), step=0.1, order=4, t_eval=times, dense_output=True)
    assert both.t.tolist() == times and (both(0.77).flat == whole(0.77).flat).all()


def test_back_in_time(top, y0):
    there = top.run(y0, (0, 5), step=0.01)
    back = top.run(there.end, (5, 0), step=0.01)
    assert back.t[0] == 5 and back.t[-1] == pytest.approx(0, abs=1e-14)
    assert np.abs(back.end.flat - y0.flat).max() < 1e-12
    assert np.abs(back(2.5).flat - there(2.5).flat).max() < 1e-12


def test_the_last_step_is_shorter(top, y0):
    sol = top.run(y0, 0.25, step=0.1)
    assert np.abs(sol.t - [0, 0.1, 0.2, 0.25]).max() < 1e-15 and sol.nsteps == 4 - 1
    assert np.abs(sol(0.25).flat - sol.end.flat).max() == 0


def test_events_are_found_within_steps(oscillator):
    # position = cos(2 t)
    def through(t, y):
        return y.position[0]

    def falling(t, y):
        return y.position[0]

    falling.direction = -1

    def second(t, y):
        return y.momentum[0]

    second.terminal = 2
    second.direction = 1
    sol = oscillator.run([1.0, 0.0], 10, step=0.05, order=6, events=[through, falling, second])
    quarter = np.pi / 4
    assert sol.status == 1 and sol.success
    # momentum rises through zero where the position is lowest, at t = pi / 2, 3 pi / 2
    assert np.abs(sol.t_events[2] - [np.pi / 2, 3 * np.pi / 2]).max() < 1e-8
    assert abs(sol.t_end - 3 * np.pi / 2) < 1e-8 and sol.t[-1] == sol.t_end
    assert np.abs(sol.t_events[0] - quarter * np.arange(1, 6, 2)).max() < 1e-8
    assert np.abs(sol.t_events[1] - quarter * np.array([1, 5])).max() < 1e-8
    assert np.abs(sol.y_events[0].position).max() < 1e-14
    assert sol.y_events[0].flat.shape == (3, 2)
    alone = oscillator.run([1.0, 0.0], 0.5, step=0.05, events=through)
    assert alone.t_events[0].shape == (0,) and alone.y_events[0].flat.shape == (0, 2)


def test_events_of_the_description_are_watched_by_name():
    spring = co.System(
        group="R1",
        potential="2 * mass * position.x * position.x",
        inertia="mass: float",
        event={"through": "position.x", "down": "position.x, falling", "short": "position.x + 0.9999, falling"},
        taylor=True,
    )(mass=1)
    quarter = np.pi / 4

    def momentum(t, y):
        return y.momentum[0]

    momentum.terminal, momentum.direction = 2, 1
    # position = cos(2 t); beside a function, in the order in which they are given
    sol = spring.run([1.0, 0.0], 10, step=0.05, order=6, events=["down", momentum, "through"])
    assert sol.status == 1 and abs(sol.t_end - 3 * np.pi / 2) < 1e-8
    assert np.abs(sol.t_events[0] - quarter * np.array([1, 5])).max() < 1e-8
    assert np.abs(sol.t_events[1] - [np.pi / 2, 3 * np.pi / 2]).max() < 1e-8
    assert np.abs(sol.t_events[2] - quarter * np.arange(1, 6, 2)).max() < 1e-8
    assert sol.y_events[0].position.shape == (2, 1) and np.abs(sol.y_events[0].position).max() < 1e-8
    # by steps to a tolerance none is missed, however long they are
    sol = spring.run([1.0, 0.0], 10, tolerance=1e-12, events="through")
    assert np.abs(sol.t_events[0] - quarter * np.arange(1, 13, 2)).max() < 1e-11
    sol = spring.run([1.0, 0.0], 3, tolerance=1e-12, events="short")
    assert len(sol.t_events) == 1 and len(sol.t_events[0]) == 1
    assert abs(sol.t_events[0][0] - np.arccos(-0.9999) / 2) < 1e-9
    with pytest.raises(ValueError, match="no event 'up': it has `through`, `down`, `short`"):
        spring.run([1.0, 0.0], 1, step=0.1, events=["down", "up"])


def test_an_event_changes_the_state():
    ball = co.System(group="R1", potential="mass * gravity * position.x", inertia="mass: float", parameters="gravity: float")(
        mass=0.1, gravity=10
    )

    def bounce(t, y):
        return y.position[0]

    def apply(t, y):
        y.momentum *= -0.8

    bounce.direction, bounce.apply = -1, apply
    sol = ball.run([1.25, 0.0], 3, step=0.03, events=bounce)
    assert np.abs(sol.t_events[0][:2] - [0.5, 1.3]).max() < 1e-13
    # before and after the jump
    twice = np.flatnonzero(np.diff(sol.t) == 0)
    assert len(twice) == len(sol.t_events[0])
    assert np.allclose(sol.y.momentum[twice] * -0.8, sol.y.momentum[twice + 1])
    # and in between: free fall from the bounce on
    t = sol.t_events[0][0] + 0.1
    speed = 0.8 * 5
    assert abs(sol(t).position[0] - (speed * 0.1 - 5 * 0.01)) < 1e-12


def test_controls(cart):
    h = 0.01
    constant = cart.run([0, 0], 2, step=h, controls=[3.0])
    assert abs(constant.end.position[0] - 3.0) < 1e-13 and abs(constant.end.momentum[0] - 6) < 1e-13
    assert (cart.run([0, 0], 2, step=h, controls={"push": 3.0}).y.flat == constant.y.flat).all()
    assert constant.controls.push[5] == 3.0
    # position'' = sin(t) / 2
    driven = cart.run([0, 0], 3, step=0.1, order=6, controls=lambda t: [np.sin(t)])
    assert abs(driven.end.position[0] - (3 - np.sin(3)) / 2) < 1e-9
    assert abs(driven(1.234).position[0] - (1.234 - np.sin(1.234)) / 2) < 1e-8
    grid = cart.run([0, 0], 2, step=h, controls=([0.0, 0.5, 1.0], [[2.0], [0.0], [-2.0]]))
    assert abs(grid.end.momentum[0] - (2 * 0.5 - 2 * 1.0)) < 1e-13
    asked = []

    def law(t, y):
        asked.append(t)
        return {"push": -2 * y.position[0] - 4 * y.momentum[0]}

    held = cart.run([1, 0], 5, step=h, controls=law)
    assert len(asked) == 500 and asked[1] == h and abs(held.end.position[0]) < 0.3
    assert np.abs(held(2.345).flat - held.y.flat[235]).max() < 0.01
    assert held.controls.push[1, 0] == -2.0
    coarse = cart.run([1, 0], 5, step=h, controls=law, every=10)
    with pytest.raises(ValueError, match="every=1"):
        coarse(0.5)
    # a table holds other values between recorded states, too
    coarse = cart.run([0, 0], 1, step=0.1, controls=([0.0, 0.5], [[2.0], [-2.0]]), every=10)
    with pytest.raises(ValueError, match="every=1"):
        coarse(0.5)


def test_velocity_and_tangent(top, y0):
    y = top.with_velocity({"momentum": [0.1, 0.2, 0.3], "gamma": [0, 0, 1]})
    assert np.allclose(y.momentum, [0.1, 2.0, 30.0])
    tangent = top.tangent_map(y0)
    assert tangent.shape == (10, 9)
    # half of the turn in the quaternion
    assert np.abs(tangent[1:4, :3] - 0.5 * np.eye(3)).max() < 1e-13 and np.abs(tangent[4:, 3:] - np.eye(6)).max() < 1e-13
    motion = top._native.motion(y0.flat, np.zeros(1), np.empty(0))
    assert np.abs(tangent @ motion - top.rhs(0, y0)).max() < 1e-12
    moved = top.displace(y0, 1e-3 * np.arange(9))
    assert np.abs((moved.flat - y0.flat) - tangent @ (1e-3 * np.arange(9))).max() < 1e-5


def test_certificates(top):
    y = top.state(attitude=[0.5, 0.5, 0.5, 0.5], momentum=[0.4, -0.8, 1.5], gamma=[0.6, 0, 0.8])
    report = top.certify(y, "cayley")
    assert report.passed and report["|gamma|²"].figure < 1e-11 and report["|gamma|²"].verdict == "passed"
    assert "Poisson map" in repr(report)
    # of several states, each as it likes
    still = top.state(gamma=[0, 0, 1])
    assert [one.name for one in report] == [one.name for one in report.certificates]
    for states in ([still, y], (still, y.flat), [{"gamma": [0, 0, 1]}, y], np.stack([still.flat, y.flat])):
        several = top.certify(states, "cayley")
        assert several.passed and several["|gamma|²"].figure >= report["|gamma|²"].figure
    assert {one.state for one in several.certificates} <= {0, 1}
    with pytest.raises(KeyError):
        report["no such"]


def test_words_for_schemes_are_those_that_were_derived():
    body = co.System(group="SO3", inertia="inertia: Vector3", methods="Midpoint, HamiltonJacobi(4)", retractions="Cayley")
    body = body(inertia=[1, 2, 3])
    for scheme, order, name in (
        (None, None, "Cayley"),
        ("midpoint", None, "Midpoint<Cayley>"),
        ("midpoint", 4, "Order4<Midpoint<Cayley>>"),
        ("euler-b", None, "SymplecticEulerB<Cayley>"),
        ("verlet", None, "StormerVerlet<Cayley>"),
        ("hamilton-jacobi", None, "HamiltonJacobi<Cayley, 4>"),
    ):
        sol = body.run({"momentum": [1, 2, 3]}, 1, step=0.1, scheme=scheme, order=order)
        assert sol.scheme == name
    with pytest.raises(ValueError, match="HamiltonJacobi<Cayley, 6>"):
        body.run({"momentum": [1, 2, 3]}, 1, step=0.1, scheme="hamilton-jacobi", order=6)
    # where there is no one order, it is 6
    both = co.System(group="SO3", inertia="inertia: Vector3", methods="HamiltonJacobi(4), HamiltonJacobi(6)")(inertia=[1, 2, 3])
    assert both.run({"momentum": [1, 2, 3]}, 1, step=0.1, scheme="hamilton-jacobi").scheme == "HamiltonJacobi<Exponential, 6>"


def test_a_picture(top, y0):
    import matplotlib

    matplotlib.use("Agg")
    sol = top.run(y0, 1, step=0.01)
    figure = sol.plot()
    assert [axis.get_ylabel() for axis in figure.axes] == ["attitude", "momentum", "gamma", "error"]
    assert len(sol.plot(["gamma"]).axes) == 2
    with pytest.raises(ValueError, match="did you mean `gamma`"):
        sol.plot(["gama"])


def test_progress_is_told(top, y0):
    shares = []
    top.run(y0, 2000, step=0.01, every=1000, progress=shares.append)
    assert shares and all(0 <= a <= b <= 1 for a, b in zip(shares, shares[1:], strict=False))
    shares.clear()
    top.ensemble(y0, n=200, t_span=50, step=0.01, progress=shares.append)
    assert shares and shares[-1] <= 1 and sorted(shares) == shares


def test_a_tolerance():
    system = co.systems.heavy_top
    top, y0 = system.example, system.state()
    exact = top.run(y0, 20, step=0.002, order=8, every=10_000).end
    for tolerance in (1e-6, 1e-12):
        sol = top.run(y0, 20, tolerance=tolerance)
        assert sol.t[-1] == 20 and 10 < sol.nsteps < 600 and sol.step is None
        assert np.abs(sol.end.flat - exact.flat).max() < 1e4 * tolerance
        assert np.abs(sol.casimirs - sol.casimirs[0]).max() < 1e-12
    fine = top.run(y0, 20, step=0.01, order=8)
    assert np.abs(sol(fine.t[::13]).flat - fine.y.flat[::13]).max() < 1e-7
    at = top.run(y0, 20, tolerance=1e-12, t_eval=fine.t[::13])
    assert np.abs(at.y.flat - fine.y.flat[::13]).max() < 1e-7
    assert "Taylor" in repr(sol) and "tolerance 1e-12" in repr(sol)

    def down(t, y):
        return y.gamma[2]

    events = [top.run(y0, 20, events=down, **keys).t_events[0] for keys in ({"tolerance": 1e-12}, {"step": 0.01, "order": 8})]
    assert len(events[0]) > 2 and np.abs(events[0] - events[1]).max() < 1e-8
    back = top.run(sol.end, (20, 0), tolerance=1e-12)
    assert np.abs(back.end.flat - y0.flat).max() < 1e-8


def test_series_are_held_against_the_motion():
    ball = co.System(
        group="R3", inertia="mass: float", parameters="g: float, c: float", potential="mass * g * position.z",
        force="-c * velocity.norm() * velocity", taylor=True,
    )(mass=1, g=9.81, c=0.2)
    sol = ball.run({}, 2, tolerance=1e-12)
    assert abs(sol.end.momentum[2] + np.sqrt(9.81 / 0.2) * np.tanh(2 * np.sqrt(9.81 * 0.2))) < 1e-9


def test_steps_to_a_tolerance_end_where_a_table_of_controls_changes():
    cart = co.System(group="R1", inertia="m: float", control="u: R1", force="u", taylor=True)(m=1)
    table = ([0, 1.0, 2.0], [[0.0], [1.0], [0.0]])
    sol = cart.run({}, 5, controls=table, tolerance=1e-12, t_eval=[1.5, 5])
    assert np.allclose(sol.y.flat, [[0.125, 0.5], [3.5, 1]], rtol=0, atol=1e-13)
    back = cart.run(sol.end, (5, 0), controls=table, tolerance=1e-12)
    assert np.abs(back.end.flat).max() < 1e-13


def test_a_bound_of_the_steps():
    push = co.System(
        group="R1", inertia="m: float", force="vector![if t < 4.0 { 0.0 } else if t < 4.001 { 1.0 } else { 0.0 }]",
        taylor=True,
    )(m=1)
    sol = push.run({}, 10, tolerance=1e-12, max_step=0.001)
    assert abs(sol.end.momentum[0] - 1e-3) < 1e-12
    with pytest.raises(ValueError, match="max_step"):
        push.run({}, 10, step=0.1, max_step=0.01)


def test_a_tolerance_takes_no_scheme(top, y0):
    for words in ({"scheme": "cayley"}, {"order": 4}):
        with pytest.raises(TypeError, match="Taylor steps"):
            top.run(y0, 1, tolerance=1e-9, **words)


def test_a_tolerance_needs_power_series(top, y0):
    with pytest.raises(ValueError, match="`taylor=True`"):
        top.run(y0, 1, tolerance=1e-9)


def test_a_page_is_that_of_the_program(top, y0, cart):
    import os
    import shutil

    from coadjoint._view import options

    sol = top.run(y0, 2, step=0.01, scheme="cayley", order=4)
    assert options(sol)[-4:] == ["--order", "4", "--retraction", "cayley"]
    listed = co.systems.heavy_top
    sol = listed.example.run(listed.state(), 1, step=0.01, scheme="midpoint")
    assert options(sol)[4:] == ["--method", "midpoint"]
    for wrong in (cart.run([0, 0], 1, step=0.1, controls=[1.0]), top.run(y0, (1, 2), step=0.1), top.run(y0, (0, -1), step=0.1)):
        with pytest.raises(ValueError, match="pages are of motions"):
            wrong.view()
    program = os.environ.get("COADJOINT_PROGRAM") or shutil.which("coadjoint")
    if program:
        page = top.run(y0, 2, step=0.01).view(program)
        assert "<html" in (page if isinstance(page, str) else page.data)


def test_orders_with_controls_that_are_functions_of_time():
    spring = dict(group="R1", potential="0.5 * position.x.powi(2)", control="u: float", force="u", methods="HamiltonJacobi(4), Midpoint")
    mass = co.System(inertia="m: float", taylor=True, **spring)(m=1)
    exact = 2 / 3 * np.sin(2) - np.sin(4) / 3

    def off(**keys):
        return abs(mass.run({}, 2, controls=lambda t: [np.sin(2 * t)], **keys).y.position[-1, 0] - exact)

    assert off(step=0.1, order=4) < 1e-5 and off(tolerance=1e-12) < 1e-11
    with pytest.warns(UserWarning, match="of order 2"):
        held = [off(step=h, scheme="hamilton-jacobi") for h in (0.1, 0.05)]
    assert 3.5 < held[0] / held[1] < 4.5
    # steps that hold a control by themselves say nothing
    mass.run({}, 2, step=0.1, scheme="hamilton-jacobi", controls=[1.0])
    # a law of the state is held over a step, of which a tolerance knows nothing
    with pytest.warns(UserWarning, match="max_step"):
        mass.run({}, 2, tolerance=1e-9, controls=lambda t, y: [-y.position[0]])
    mass.run({}, 2, tolerance=1e-9, max_step=0.1, controls=lambda t, y: [-y.position[0]])


def test_a_momentum_moves_with_its_control():
    lagrangian = "0.5 * m * velocity.x.powi(2) + u * velocity.x - 0.5 * position.x.powi(2)"
    mass = co.System(group="R1", parameters="m: float", control="u: float", lagrangian=lagrangian, taylor=True)(m=1)
    # p = v + u, and x'' = −x − u'
    sol = mass.run([1.0, 0.0], 3, tolerance=1e-12, controls=lambda t: [t])
    assert abs(sol.y.position[-1, 0] - (2 * np.cos(3) - 1)) < 1e-11
