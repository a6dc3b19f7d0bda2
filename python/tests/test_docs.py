"""What README and the guide say in Python runs."""

import os
import re
from pathlib import Path

import matplotlib
import pytest

ROOT = Path(os.environ.get("COADJOINT_REPOSITORY", Path(__file__).parent / "../.."))
PAGES = ["python/README.md", "runtime/src/guide/python.md"]


@pytest.mark.parametrize("page", PAGES)
def test_pages_run(page):
    file = ROOT / page
    if not file.is_file():
        pytest.skip("not in the repository")
    matplotlib.use("Agg")
    blocks = re.findall(r"```(?:python|text)\n(.*?)```", file.read_text(encoding="utf-8"), re.S)
    # what leaves something out is no code, and errors and Rust are none either
    blocks = [one for one in blocks if "co." in one and "…" not in one and "error:" not in one and "use coadjoint" not in one]
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(block, names)
    sol = names["sol"]
    assert abs(sol.energy - sol.energy[0]).max() < 1e-5 and abs(sol.casimirs - sol.casimirs[0]).max() < 1e-12


def test_first_tasks_run(tmp_path, monkeypatch):
    file = ROOT / "python/FIRST_TASKS.md"
    if not file.is_file():
        pytest.skip("not in the repository")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    picture, before, after = re.findall(r"```python\n(.*?)```", file.read_text(encoding="utf-8"), re.S)
    exec(picture, {})
    assert (tmp_path / "my_top.png").stat().st_size > 10_000
    names: dict[str, object] = {}
    exec(before, names)
    exec(after, names)
    old, new = names["before"], names["sol"]
    assert abs(old.y[:3].T - new.y.momentum).max() < 1e-3 and abs(old.y[3:].T - new.y.gamma).max() < 1e-3
    assert len(old.t_events[0]) == len(new.t_events[0]) > 3
    assert abs(old.t_events[0] - new.t_events[0]).max() < 1e-3
