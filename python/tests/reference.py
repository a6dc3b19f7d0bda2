"""Writes reference.json: where runs of the program end. `python reference.py PROGRAM`.

Examples of the catalogue without controls, each with some schemes: the numbers of the last row, which are written with all their digits.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
STEPS = 500
SCHEMES = {
    ("exponential", None): [],
    ("cayley", None): ["--retraction", "cayley"],
    ("Midpoint<Exponential>", None): ["--method", "midpoint"],
    ("exponential", 6): ["--method", "standard", "--order", "6"],
}

runs = []
for name, example in json.loads((HERE / "../coadjoint/catalogue.json").read_text()).items():
    listed = subprocess.run([sys.argv[1], "list", name, "--json"], capture_output=True, text=True, check=True)
    system = json.loads(listed.stdout)
    if system["controls"]:
        continue
    for (scheme, order), options in SCHEMES.items():
        if not any(scheme.lower().startswith(word) for word in [*system["retractions"], *system["methods"]]):
            continue
        if scheme != "cayley" and "exponential" not in system["retractions"]:
            continue
        with tempfile.TemporaryDirectory() as folder:
            duration = f"{STEPS * example['step']!r}"
            command = [sys.argv[1], "run", name, "--duration", duration, "--out", folder, "--every", str(STEPS), *options]
            subprocess.run(command, capture_output=True, text=True, check=True)
            (file,) = Path(folder).glob("*.csv")
            rows = list(csv.DictReader(file.open()))
        last = {key: float(value) for key, value in rows[-1].items()}
        runs.append({"system": name, "scheme": scheme, "order": order, "step": example["step"], "last": last})
lines = ",\n".join(json.dumps(run) for run in runs)
(HERE / "reference.json").write_text(f"[\n{lines}\n]\n", encoding="utf-8")
print(len(runs), "runs")
