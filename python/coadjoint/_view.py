"""Pages of the program in a notebook."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native

if TYPE_CHECKING:
    from ._solution import Solution


METHODS = {name: word for word, name in _native.steps()}
RETRACTIONS = {name: word for word, name in _native.retractions()}


def options(solution: Solution) -> list[str]:
    """The program's words for a solution's steps."""
    duration = float(solution.t_end - solution.t[0])
    if solution.step is None:
        # Taylor steps are longer than what is to be seen moving
        return ["--duration", repr(duration), "--step", repr(duration / 2000)]
    found = ["--duration", repr(duration), "--step", repr(solution.step)]
    scheme = solution.scheme
    if match := re.fullmatch(r"Order(\d+)<(.*)>", scheme):
        found += ["--order", match[1]]
        scheme = match[2]
    if match := re.fullmatch(r"(\w+)<(\w+)>", scheme):
        if match[1] not in METHODS:
            raise ValueError(f"the program has no page of steps with the scheme `{solution.scheme}`")
        found += ["--method", METHODS[match[1]]]
        scheme = match[2]
    if scheme in METHODS:
        # on the exponential, as the library's name without a retraction says
        return [*found, "--method", METHODS[scheme]]
    return [*found, "--retraction", RETRACTIONS.get(scheme, scheme)]


def view(solution: Solution, program: str, height: int) -> Any:
    """Lets the program take the same steps, write its page of them, and shows that."""
    system = solution.system.system
    if system._module is not None:
        raise ValueError("a page needs the system's description as text")
    if solution.controls is not None:
        raise ValueError("pages are of motions without controls; `sol.plot()` shows what these do")
    if solution.t[0] != 0.0 or solution.t_end <= 0.0:
        raise ValueError("pages are of motions that start at time 0 and go forward")
    found = shutil.which(program)
    if found is None:
        raise RuntimeError(
            f"there is no program `{program}`: `cargo install --path systems` in the repository of coadjoint installs it; `sol.plot()` needs none"
        )
    sets = []
    for state in (solution.system.parameters, solution.y[0]):
        for name in state.keys():
            sets += ["--set", f"{name}={','.join(map(repr, state[name].ravel().tolist()))}"]
    with tempfile.TemporaryDirectory() as folder:
        text, page = Path(folder) / "description.rs", Path(folder) / "motion.html"
        text.write_text(system.text, encoding="utf-8")
        command = [found, "run", "--description", str(text), *sets, *options(solution)]
        command += ["--out", folder, "--html", str(page), "--quiet"]
        made = subprocess.run(command, capture_output=True, text=True, check=False)
        if made.returncode:
            raise RuntimeError(made.stderr.strip())
        html = page.read_text(encoding="utf-8")
    try:
        from IPython.display import HTML
    except ImportError:
        return html
    escaped = html.replace("&", "&amp;").replace('"', "&quot;")
    show: Any = HTML
    return show(f'<iframe srcdoc="{escaped}" width="100%" height="{height}" style="border:0"></iframe>')
