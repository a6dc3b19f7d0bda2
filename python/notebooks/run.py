"""Runs the notebooks: each cell, with its assertions. `python run.py [FOLDER]`; with a folder, what comes out is written there."""

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

here = Path(__file__).parent
for file in sorted(here.glob("*.ipynb")):
    begun = time.monotonic()
    notebook = nbformat.read(file, as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(here)}}).execute()
    if len(sys.argv) > 1:
        nbformat.write(notebook, Path(sys.argv[1]) / file.name)
    print(f"{file.name}: {time.monotonic() - begun:.1f} s")
