"""Pages of the program in a notebook."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._solution import Solution


def view(solution: Solution, program: str, height: int) -> Any:
    """Writes what the program reads, lets it make the page, and shows that."""
    found = shutil.which(program)
    if found is None:
        raise RuntimeError(
            f"there is no program `{program}`: `cargo install --path systems` in the repository of coadjoint installs it; `sol.plot()` needs none"
        )
    with tempfile.TemporaryDirectory() as folder:
        table, page = Path(folder) / "motion.csv", Path(folder) / "motion.html"
        solution.to_pandas().to_csv(table)
        made = subprocess.run([found, "play", str(table), "--out", str(page)], capture_output=True, text=True, check=False)
        if made.returncode:
            raise RuntimeError(made.stderr.strip())
        text = page.read_text(encoding="utf-8")
    try:
        from IPython.display import HTML
    except ImportError:
        return text
    escaped = text.replace("&", "&amp;").replace('"', "&quot;")
    show: Any = HTML
    return show(f'<iframe srcdoc="{escaped}" width="100%" height="{height}" style="border:0"></iframe>')
