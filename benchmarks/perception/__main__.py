"""`python -m benchmarks.perception [--parts simulated,unknown,...] [--scenes N] [--json FILE]`."""

from __future__ import annotations

import argparse
import json
import os
import platform
from pathlib import Path

from benchmarks.perception import simulated, unknown
from benchmarks.perception.table import Row, lines
from nodes.perception_node.recognition.learnt import shipped

PARTS = ("simulated", "unknown")


def arguments() -> argparse.Namespace:
    """What the command line says."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception")
    parser.add_argument("--parts", default=",".join(PARTS), help=f"of: {','.join(PARTS)}")
    parser.add_argument("--scenes", type=int, default=50, help="simulated rooms of each sort")
    parser.add_argument("--samples", type=Path, help="from python -m nodes.training.recognition --samples")
    parser.add_argument("--training-scenes", type=int, default=400, help="where there are no samples")
    parser.add_argument("--json", type=Path, metavar="FILE", dest="json_file")
    return parser.parse_args()


def main() -> None:
    """Measure, print the table, write JSON."""
    words = arguments()
    parts, rows = set(words.parts.split(",")), list[Row]()
    before = os.getloadavg()[0]
    if "simulated" in parts:
        rows += simulated.measure(words.scenes, shipped())
    if "unknown" in parts:
        rows += unknown.measure(words.scenes, words.samples, words.training_scenes)
    print(lines(rows))
    print(f"load average: {before:.1f} before, {os.getloadavg()[0]:.1f} now")
    if words.json_file:
        report = {"machine": platform.platform(), "rows": [{**row._asdict(), "met": row.met} for row in rows]}
        words.json_file.write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
