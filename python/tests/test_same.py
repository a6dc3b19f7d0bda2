"""Results are those of the program, bit for bit; in pieces, by single steps and in any number of threads too."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import coadjoint as co

HERE = Path(__file__).parent
RUNS = json.loads((HERE / "reference.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("run", RUNS, ids=lambda run: f"{run['system']}-{run['scheme']}-{run['order']}")
def test_a_run_ends_where_the_programs_does(run):
    system = getattr(co.systems, run["system"])
    sol = system.example.run(
        system.state(), run["last"]["time"], step=run["step"], scheme=run["scheme"], order=run["order"]
    )
    columns = [column for one in system.state_quantities for column in one.columns]
    assert sol.t[-1] == run["last"]["time"]
    assert sol.y.flat[-1].tolist() == [run["last"][column] for column in columns]
    assert sol.energy[-1] == run["last"]["energy"]


def test_the_catalogue_is_that_of_the_repository():
    folder = Path(os.environ.get("COADJOINT_REPOSITORY", HERE / "../..")) / "systems/src"
    if not folder.is_dir():
        pytest.skip("not in the repository")
    files = {one.stem for one in folder.glob("*.rs") if "lie_poisson_system(" in one.read_text(encoding="utf-8")}
    assert set(co.systems.names()) == files
    for name in co.systems.names():
        assert getattr(co.systems, name).text == (folder / f"{name}.rs").read_text(encoding="utf-8")


def test_single_steps_and_pieces_are_those_of_a_run(top, y0):
    sol = top.run(y0, 3.0, step=0.01)
    one, many = y0.copy(), y0.copy()
    stepper, together = top.stepper(0.01), top.stepper(0.01)
    for k in range(300):
        stepper.step(one)
        assert (one.flat == sol.y.flat[k + 1]).all()
    together.steps(many, 123)
    together.steps(many, 177)
    assert (many.flat == sol.y.flat[300]).all()
    assert stepper.t == together.t == sol.t[-1] == 3.0
    thinned = top.run(y0, 3.0, step=0.01, every=7)
    assert (thinned.y.flat[:-1] == sol.y.flat[::7]).all() and (thinned.y.flat[-1] == sol.y.flat[-1]).all()


def test_a_long_run_that_looks_for_signals_is_that_of_short_ones(top, y0):
    sol = top.run(y0, 600.0, step=0.01, every=60_000)
    y = y0.copy()
    top.stepper(0.01).steps(y, 60_000)
    assert len(sol) == 2 and (sol.y.flat[-1] == y.flat).all()


def test_members_are_those_of_one_thread(tmp_path):
    script = """
import numpy as np, coadjoint as co
top = co.systems.heavy_top.example
momenta = np.random.default_rng(1).normal(size=(1003, 3))
sol = top.ensemble({"momentum": momenta, "gamma": [0, 0, 1]}, t_span=1, step=0.01)
print(sol.y.flat.tobytes().hex()[-400:], hash(sol.y.flat.tobytes()))
"""
    said = {
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "RAYON_NUM_THREADS": threads, "PYTHONHASHSEED": "0"},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for threads in "124"
    }
    assert len(said) == 1


def test_a_member_is_one_alone(top):
    rng = np.random.default_rng(2)
    states = {"momentum": rng.normal(size=(21, 3)), "gamma": [0.0, 0.6, 0.8]}
    weights = rng.uniform(0.5, 2.0, size=21)
    sol = top.ensemble(states, {"weight": weights}, t_span=2, step=0.01, scheme="exponential", every=50)
    assert sol.y.flat.shape == (5, 21, 10) and not sol.failed
    for k in (0, 7, 20):
        alone = top.replace(weight=weights[k])
        own = alone.run(dict(momentum=states["momentum"][k], gamma=[0, 0.6, 0.8]), 2, step=0.01, every=50)
        # a member may take an iteration more than it would alone
        assert np.abs(own.y.flat - sol.y.flat[:, k]).max() < 1e-12
        assert np.abs(own.energy - sol.energy[:, k]).max() < 1e-12
