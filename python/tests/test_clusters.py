"""Ensembles in blocks: the same bytes whoever runs them, and what numpy says of all members."""

import math
import multiprocessing
import pickle
import runpy
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import coadjoint as co
from coadjoint._rows import Rows

MEMBERS = 3000
TIMES = {"t_span": 2, "step": 0.01, "every": 80}


def member(k, rng):
    return {"momentum": rng.normal([0.1, 0.2, 5.0], 0.3), "gamma": [0.0, 0.6, 0.8]}, {"weight": rng.uniform(0.5, 2.0)}


def nutation(sol):
    return sol.y.gamma[..., 2]


def energy(sol):
    return sol.energy


QUANTITIES = {"nutation": nutation, "energy": energy}


def content(known):
    return known.t.tobytes(), known.members, known.failed, {
        name: [one.to_bytes() for one in known[name]] for name in known.keys()
    }


def quantile(ordered, level):
    place = level * (len(ordered) - 1)
    below, part = int(place), place % 1
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + part * (ordered[above] - ordered[below]), max(abs(ordered[below]), abs(ordered[above]))


def agrees(one, values):
    """What is known is what numpy, and fractions, say of all values."""
    exact = [Fraction(value) for value in values.tolist()]
    mean = sum(exact) / len(exact)
    variance = sum(value * value for value in exact) / len(exact) - mean * mean
    assert one.members == len(values)
    assert one.mean == float(mean)
    assert one.deviation == math.sqrt(float(variance))
    assert one.min == values.min() and one.max == values.max()
    ordered = np.sort(values)
    for level, found in one.quantiles.items():
        wanted, size = quantile(ordered, level)
        # the last digits are those of the interpolation
        assert abs(found - wanted) <= (one.relative_error + 1e-15) * size
    return one.relative_error


def test_statistics_are_those_of_all_values():
    rng = np.random.default_rng(3)
    assert agrees(co.Statistics(rng.normal(size=4096)), rng.__class__(np.random.PCG64(3)).normal(size=4096)) == 0.0
    many = rng.normal(size=30_000) * 10.0 ** rng.integers(-5, 5, 30_000)
    assert 0 < agrees(co.Statistics(many), many) < 0.02
    huge = np.concatenate([[1e200, -1e200], rng.normal(1e8, 1e-6, size=999)])
    agrees(co.Statistics(huge[2:]), huge[2:])
    assert co.Statistics(huge).mean == float(sum(map(Fraction, huge.tolist())) / len(huge)) != np.mean(huge)
    assert list(co.Statistics([1, 2]).quantiles) == [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0]


def test_statistics_merge_in_any_order():
    rng = np.random.default_rng(4)
    values = rng.lognormal(sigma=4, size=20_000)
    parts = [co.Statistics(part) for part in np.array_split(values, 13)]
    whole = co.Statistics(values)
    for order in (range(13), rng.permutation(13)):
        merged = co.Statistics()
        for k in order:
            merged.merge(co.Statistics.from_bytes(parts[k].to_bytes()))
        assert merged.to_bytes() == whole.to_bytes() and merged == whole
    assert pickle.loads(pickle.dumps(whole)) == whole != parts[0]
    twice = co.Statistics([1.0, 3.0])
    twice.merge(twice)
    assert (twice.members, twice.mean, twice.deviation) == (4, 2.0, 1.0)
    assert "4 values: 2 ± 1, from 1 to 3" in repr(twice)


def test_statistics_that_are_none():
    empty = co.Statistics([np.nan])
    assert empty.members == 0 and math.isnan(empty.mean) and math.isnan(empty.quantiles[0.5])
    data = co.Statistics([1.0, 2.0]).to_bytes()
    for wrong in (b"", b"wrong", data[:-1], data + b"\0"):
        with pytest.raises(ValueError, match="to_bytes"):
            co.Statistics.from_bytes(wrong)
    for wrong in ([[1.0]], "wrong", 1.0, ["a"]):
        with pytest.raises((TypeError, ValueError)):
            co.Statistics(wrong)
    with pytest.raises(TypeError):
        empty.merge([1.0])
    with pytest.raises(TypeError, match="unhashable"):
        hash(empty)


def test_an_ensemble_is_what_numpy_says_of_its_members(top):
    known = top.ensemble(member, n=MEMBERS, quantities=QUANTITIES, block=512, **TIMES)
    sol = top.ensemble(member, n=MEMBERS, **TIMES)
    assert known.t.tolist() == sol.t.tolist() == [0.0, 0.8, 1.6, 2.0]
    assert known.members == MEMBERS and known.keys() == ["nutation", "energy"] and not known.failed
    for name, quantity in QUANTITIES.items():
        for one, values in zip(known[name], quantity(sol), strict=True):
            agrees(one, values)
    assert len({one.mean for one in known["nutation"]}) == 4
    assert repr(known) == "<statistics of nutation, energy: 3000 members to t = 2>"


def test_random_numbers_belong_to_the_member(top):
    few = top.ensemble(member, n=70, t_span=0.1, step=0.1)
    more = top.ensemble(member, n=100, t_span=0.1, step=0.1)
    other = top.ensemble(member, n=70, t_span=0.1, step=0.1, seed=2**64 - 1)
    assert (few.parameters.flat == more.parameters.flat[:70]).all()
    assert len(np.unique(more.parameters.weight)) == 100
    assert not set(few.parameters.weight.tolist()) & set(other.parameters.weight.tolist())
    # what they are is written down: they are to be the same tomorrow
    rng = np.random.Generator(np.random.Philox(key=np.array([0, 69], dtype=np.uint64)))
    assert more.parameters.weight[69] == member(69, rng)[1]["weight"]


@contextmanager
def nobody():
    yield None


SPAWN = multiprocessing.get_context("spawn")


def processes():
    return ProcessPoolExecutor(2, mp_context=SPAWN)


@contextmanager
def dask(workers):
    distributed = pytest.importorskip("distributed", reason="there is no dask[distributed]: not tested on its workers")
    from dask import config

    with (
        # rather than for ever, when workers are lost
        config.set({"distributed.scheduler.no-workers-timeout": "20s"}),
        distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def drawn(top):
    return content(top.ensemble(member, n=MEMBERS, quantities=QUANTITIES, block=512, **TIMES))


@pytest.mark.parametrize(
    "client",
    [nobody, lambda: ThreadPoolExecutor(3), processes, lambda: SPAWN.Pool(2), lambda: dask(1), lambda: dask(2)],
    ids=["here", "threads", "processes", "pool", "dask-1", "dask-2"],
)
def test_the_bytes_are_the_same_whoever_runs_blocks(top, drawn, client):
    sol = top.ensemble(member, n=MEMBERS, t_span=0, step=0.01)
    shares = []
    with client() as client:
        keys = {"quantities": QUANTITIES, "block": 512, "client": client, **TIMES}
        assert content(top.ensemble(member, n=MEMBERS, progress=shares.append, **keys)) == drawn
        assert content(top.ensemble(sol.y.flat[0], sol.parameters.flat, **keys)) == drawn
        if client is None or hasattr(client, "gather"):
            # what multiprocessing cannot send
            keys["quantities"] = {"nutation": lambda sol: sol.y.gamma[..., 2], "energy": lambda sol: sol.energy}
            assert content(top.ensemble(lambda k, rng: member(k, rng), n=MEMBERS, **keys)) == drawn
    assert shares == [(k + 1) / 6 for k in range(6)]


ROWS = {"weight": lambda sol: sol.parameters.weight, "drawn": lambda sol: sol.start.momentum[:, 2], "gamma": nutation}


def files(directory):
    return {path.name: path.read_bytes() for path in sorted(directory.iterdir())}


@pytest.mark.parametrize("ending", ["csv", "parquet"])
@pytest.mark.parametrize("client", [lambda: ThreadPoolExecutor(3), lambda: dask(2)], ids=["threads", "dask-2"])
def test_rows_are_the_same_whoever_runs_blocks(top, tmp_path, monkeypatch, client, ending):
    if ending == "parquet":
        pytest.importorskip("pyarrow", reason="there is no pyarrow: rows are not tested as Parquet")
    # a path from here, and workers that stand elsewhere
    monkeypatch.chdir(tmp_path)
    keys = {"n": MEMBERS, "quantities": ROWS, "block": 512, **TIMES}
    alone = top.ensemble(member, rows=f"here.{ending}", **keys)
    with client() as client:
        known = top.ensemble(member, rows=f"there.{ending}", client=client, **keys)
    assert content(known) == content(alone)
    names = [f"members-{first:012}.{ending}" for first in range(0, MEMBERS, 512)]
    assert list(files(tmp_path / f"here.{ending}")) == names
    assert files(tmp_path / f"there.{ending}") == files(tmp_path / f"here.{ending}")


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_rows_are_the_members(top, tmp_path, ending):
    if ending == "parquet":
        pytest.importorskip("pyarrow", reason="there is no pyarrow: rows are not tested as Parquet")
    pandas = pytest.importorskip("pandas")
    directory = tmp_path / f"top.{ending}"
    known = top.ensemble(member, n=300, quantities=ROWS, rows=directory, block=128, **TIMES)
    sol = top.ensemble(member, n=300, **TIMES)
    if ending == "csv":
        # to the last digit, which not every version of pandas reads
        table = [line.split(",") for path in sorted(directory.iterdir()) for line in path.read_text().splitlines()]
        columns = list(zip(*(line for line in table if line != table[0]), strict=True))
        rows = pandas.DataFrame({name: list(map(float, column)) for name, column in zip(table[0], columns, strict=True)})
        assert all(member.isdecimal() for member in columns[0])
        rows.member = rows.member.astype(np.int64)
    else:
        rows = pandas.read_parquet(directory)
    assert rows.columns.tolist() == ["member", "time", "weight", "drawn", "gamma"] and rows.member.dtype == np.int64
    rows = rows.sort_values(["time", "member"])
    assert (rows.member.to_numpy().reshape(4, 300) == np.arange(300)).all()
    assert (rows.time.to_numpy().reshape(4, 300) == sol.t[:, None]).all()
    assert (rows.gamma.to_numpy().reshape(4, 300) == nutation(sol)).all()
    assert (rows.weight.to_numpy().reshape(4, 300) == sol.parameters.weight).all()
    assert (rows.drawn.to_numpy().reshape(4, 300) == sol.start.momentum[:, 2]).all()
    agrees(known["drawn"][-1], sol.start.momentum[:, 2])


def test_rows_of_members_that_fail_end(tmp_path):
    pole = co.System(group="R1", potential="position.x.sqrt()", inertia="mass: float")(mass=1)
    keys = {"t_span": 5, "step": 0.05, "scheme": "exponential", "every": 10}
    x = {"x": lambda sol: sol.y.position[..., 0]}
    known = pole.ensemble([[1.0, 0.0], [50.0, 0.0]], quantities=x, rows=tmp_path / "pole.csv", **keys)
    lines = [line.split(",") for line in (tmp_path / "pole.csv/members-000000000000.csv").read_text().split()[1:]]
    values = {(int(member), float(time)): float(x) for member, time, x in lines}
    assert len(values) == 2 * len(known.t)
    for k, t in enumerate(known.t.tolist()):
        assert math.isnan(values[0, t]) == (known["x"][k].members == 1)
        assert not math.isnan(values[1, t])
    assert math.isnan(values[0, 5.0])


def test_rows_are_whole_or_not_there(top, tmp_path):
    keys = {"n": 300, "block": 100, **TIMES}
    whole = tmp_path / "whole.csv"
    top.ensemble(member, quantities={"gamma": nutation}, rows=whole, **keys)
    with pytest.raises(FileExistsError, match="not empty"):
        top.ensemble(member, quantities={"gamma": nutation}, rows=whole, **keys)
    # the disk of a worker is full
    resource = pytest.importorskip("resource")
    size = (whole / "members-000000000000.csv").stat().st_size
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size // 2, limits[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            top.ensemble(member, quantities={"gamma": nutation}, rows=tmp_path / "full.csv", **keys)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, before)
    assert not files(tmp_path / "full.csv")
    # a worker that does not see the directory
    rows = Rows(tmp_path / "elsewhere.csv", {})
    with pytest.raises(FileNotFoundError, match="all workers share"):
        rows.write(0, np.zeros(1), {"x": np.zeros((1, 2))})


def test_the_bytes_are_the_same_in_blocks_of_64_or_more(top, drawn):
    # as many as registers hold are stepped together, in either
    for block in (64, 2048, 10_000):
        assert content(top.ensemble(member, n=MEMBERS, quantities=QUANTITIES, block=block, **TIMES)) == drawn


def test_controls_belong_to_members(oscillator):
    pushes = np.linspace(-1, 1, 300)[:, None]
    keys = {"t_span": 1, "step": 0.01}
    sol = oscillator.ensemble([0.0, 0.0], n=300, controls=pushes, **keys)
    known = oscillator.ensemble(
        [0.0, 0.0], n=300, controls=pushes, quantities={"x": lambda sol: sol.y.position[..., 0]}, block=128, **keys
    )
    agrees(known["x"][0], sol.y.position[0, :, 0])
    law = {"controls": lambda t, y: -y.momentum, "quantities": {"x": lambda sol: sol.y.position[..., 0]}}
    damped = oscillator.ensemble([[k, 0.0] for k in range(100)], block=64, **law, **keys)
    assert damped["x"][0].members == 100


def test_members_that_fail_are_counted_until_then():
    pole = co.System(group="R1", potential="position.x.sqrt()", inertia="mass: float")(mass=1)
    states = np.array([[1.0, 0.0], [50.0, 0.0], [1.1, 0.0]] * 40)
    keys = {"t_span": 5, "step": 0.05, "scheme": "exponential", "every": 10}
    sol = pole.ensemble(states, **keys)
    known = pole.ensemble(states, quantities={"x": lambda sol: sol.y.position[..., 0]}, block=64, **keys)
    assert known.failed == sol.failed and len(known.failed) == 80
    counted = [one.members for one in known["x"]]
    assert counted[0] == counted[1] == 120 and counted[-1] == 40
    assert known["x"][-1].min == sol.y.position[-1, 1, 0]
    assert known.members == 120 and "80 failed" in repr(known)


def test_parts_of_ensembles_merge(top):
    keys = {"quantities": QUANTITIES, **TIMES}
    sol = top.ensemble(member, n=1024, t_span=0, step=0.01)
    parts = [
        top.ensemble(sol.y.flat[0, cut], sol.parameters.flat[cut], **keys) for cut in (slice(0, 512), slice(512, 1024))
    ]
    whole = top.ensemble(member, n=1024, **keys)
    merged = pickle.loads(pickle.dumps(parts[1]))
    merged.merge(parts[0])
    assert content(merged) == content(whole)
    with pytest.raises(ValueError, match="one ensemble"):
        merged.merge(top.ensemble(member, n=9, t_span=1, step=0.01, quantities=QUANTITIES))


@pytest.mark.parametrize(
    "states, keys, error, says",
    [
        (member, {}, ValueError, "`n`"),
        (member, {"n": 0}, ValueError, "`n`"),
        (member, {"n": 3, "seed": -1}, ValueError, "`seed`"),
        (member, {"n": 3, "parameters": {"weight": 1.0}}, ValueError, "return state, parameters"),
        (lambda k, rng: {"momentun": [1, 1, 1]}, {"n": 3}, ValueError, "did you mean `momentum`"),
        (member, {"n": 3, "quantities": {}}, ValueError, "empty"),
        (member, {"n": 3, "block": 0, "quantities": QUANTITIES}, ValueError, "`block`"),
        (member, {"n": 3, "client": 5, "quantities": QUANTITIES}, TypeError, "`map`"),
        (member, {"n": 3, "client": ThreadPoolExecutor(1)}, ValueError, "`quantities`"),
        (member, {"n": 3, "quantities": {"all": lambda sol: sol.y.gamma}}, ValueError, "quantity `all`"),
        (member, {"n": 3, "quantities": {"bad": lambda sol: 1 / 0}}, ZeroDivisionError, "division"),
        (member, {"n": 3, "quantities": QUANTITIES, "rows": "rows.txt"}, ValueError, "`.csv` or `.parquet`"),
        (member, {"n": 3, "quantities": {"time": nutation}, "rows": "rows.csv"}, ValueError, "column `time`"),
        (member, {"n": 3, "rows": "rows.csv"}, ValueError, "rows are of `quantities`"),
    ],
)
def test_what_makes_no_sense_is_refused(top, states, keys, error, says):
    with pytest.raises(error, match=says):
        top.ensemble(states, t_span=0.1, step=0.01, **keys)
    if not {"quantities", "client", "rows"} & keys.keys():
        with pytest.raises(error, match=says):
            top.ensemble(states, t_span=0.1, step=0.01, quantities=QUANTITIES, **keys)


def test_errors_of_workers_arrive(top):
    with ThreadPoolExecutor(2) as client, pytest.raises(ZeroDivisionError):
        top.ensemble(member, n=9, t_span=0.1, step=0.01, quantities={"bad": lambda sol: 1 / 0}, client=client)


def test_a_system_that_is_sent_twice_is_made_once(top):
    assert pickle.loads(pickle.dumps(top)).system is pickle.loads(pickle.dumps(top)).system


def moved(thing):
    """What arrives at a worker: numbers where no number may start, and none may be written."""
    buffers = []
    data = pickle.dumps(thing, protocol=5, buffer_callback=buffers.append)
    lying = [memoryview(b"." + buffer.raw().tobytes())[1:] for buffer in buffers]
    assert lying
    return pickle.loads(data, buffers=lying)


def test_what_was_sent_is_what_it_was(top, y0):
    sol = top.run(y0, 1.0, step=0.01)
    members = top.ensemble(member, n=1, t_span=1, step=0.01, every=10)
    arrived, state = moved(top), moved(y0)
    assert arrived == top and (arrived.run(state, 1.0, step=0.01).y.flat == sol.y.flat).all()
    top.stepper(0.01).step(state)
    assert (state.flat == sol.y.flat[1]).all()
    assert (moved(sol).energy == sol.energy).all() and (moved(sol)(0.123).flat == sol(0.123).flat).all()
    assert (moved(members).energy == members.energy).all()


def test_the_example_runs_on_ray(capsys):
    pytest.importorskip("ray", reason="there is no Ray: its example is not tested")
    runpy.run_path(str(Path(__file__).parent / "../examples/with_ray.py"), run_name="__main__")
    assert "the same bytes" in capsys.readouterr().out
