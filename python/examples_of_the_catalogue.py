"""Writes coadjoint/catalogue.json: the examples of the catalogue, as the program lists them. `python examples_of_the_catalogue.py PROGRAM`."""

import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
examples = {}
for file in sorted((HERE / "../systems/src").glob("*.rs")):
    if "lie_poisson_system(" not in file.read_text(encoding="utf-8"):
        continue
    listed = subprocess.run([sys.argv[1], "list", file.stem, "--json"], capture_output=True, text=True, check=True)
    system = json.loads(listed.stdout)
    examples[file.stem] = {
        "parameters": [number for one in system["parameters"] for number in one["example"]],
        "state": [number for one in system["state"] for number in one["example"]],
        "step": system["step"],
        "duration": system["duration"],
    }
lines = (f"{json.dumps(name)}: {json.dumps(example)}" for name, example in examples.items())
(HERE / "coadjoint/catalogue.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
