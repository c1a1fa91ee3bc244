#!/usr/bin/env python3
"""script/coverage_table.py SUMMARY: gcovr's summary as a table, one row per layer (script/coverage)."""
import json
import subprocess
import sys
from pathlib import Path

files = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["files"]
layers: dict[str, list[int]] = {}
for file in files:
    counts = layers.setdefault(file["filename"].split("/")[2], [0, 0])
    counts[0] += file["line_covered"]
    counts[1] += file["line_total"]
order = [line.split(":")[0].strip() for line in Path("src/lefort/LAYERS").read_text(encoding="utf-8").splitlines()
         if ":" in line and not line.startswith("#")]
commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], check=True, capture_output=True, text=True).stdout.strip()
print(f"# Line coverage\n\nVersion {commit}, `script/coverage`: lines that the tests execute, without those of the real case "
      "(label `demo`).\nLines of headers count for the layer that defines them.\n\n| layer | lines | executed |\n|---|---|---|")
for name in order:
    if name in layers:
        covered, total = layers[name]
        print(f"| {name} | {total} | {100.0 * covered / max(total, 1):.0f} % |")
covered, total = (sum(counts[k] for counts in layers.values()) for k in (0, 1))
print(f"| **all** | {total} | {100.0 * covered / max(total, 1):.1f} % |")
