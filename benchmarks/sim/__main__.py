"""`python -m benchmarks.sim [--quick] [--parts NAMES] [--drives N] [--worlds DIR] ... [--json FILE]`."""

from __future__ import annotations

import argparse
import json
import os
import platform
import tempfile
from collections.abc import Callable
from pathlib import Path

from benchmarks.sim import doors, drive, endurance, live, standalone, system, worlds
from benchmarks.table import Row, lines


def main() -> None:
    """Measure, print the table, write JSON."""
    words = _arguments()
    load_before = os.getloadavg()[0]
    rows: list[Row] = []
    if words.worlds:
        rows += worlds.measure(words.worlds)
    else:
        for part in words.parts.split(","):
            rows += PARTS[part](words)
    print(lines(rows))
    print(f"load average: {load_before:.1f} before, {os.getloadavg()[0]:.1f} now")
    if words.json_file:
        report = {
            "machine": platform.platform(),
            "load_average": [load_before, os.getloadavg()[0]],
            "rows": [{**row._asdict(), "met": row.met} for row in rows],
        }
        words.json_file.write_text(json.dumps(report, indent=1) + "\n")


def _alone(words: argparse.Namespace) -> list[Row]:
    sizes = (10, 100) if words.quick else (10, 100, 500)
    return [
        row for size in sizes for row in standalone.spawn_and_delete(size)
    ] + standalone.real_time_factors()


def _system(words: argparse.Namespace) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        return system.measure(Path(folder), 20 if words.quick else 100, 10 if words.quick else 60)


def _loads(words: argparse.Namespace) -> list[Row]:
    rows = []
    for entities, reach_s in ((200, 3.0),) if words.quick else ((200, 3.0), (2000, 30.0)):
        with tempfile.TemporaryDirectory() as folder:
            rows.append(system.load(Path(folder), entities, reach_s))
    return rows


def _live(words: argparse.Namespace) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        return live.measure(Path(folder), seconds=6.0 if words.quick else 15.0)


def _doors(words: argparse.Namespace) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        return doors.measure(Path(folder), quick=words.quick)


def _random_doors(words: argparse.Namespace) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        return doors.measure_at_random(Path(folder), words.door_minutes)


def _drive(words: argparse.Namespace) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        return drive.measure(Path(folder), words.drives)


PARTS: dict[str, Callable[[argparse.Namespace], list[Row]]] = {
    "alone": _alone,
    "frames": lambda _: standalone.frames(),
    "system": _system,
    "loads": _loads,
    "live": _live,
    "doors": _doors,
    "random-doors": _random_doors,
    "drive": _drive,
    "endurance": lambda words: endurance.endure(words.minutes),
}


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sim", description="Speed and memory.")
    parser.add_argument("--parts", default=",".join(PARTS), help=f"parts to measure: {','.join(PARTS)}")
    parser.add_argument("--minutes", type=float, default=60.0, help="simulated minutes of endurance")
    parser.add_argument(
        "--door-minutes", type=float, default=1.0, metavar="N",
        help="simulated minutes in which 40 doors open and close (the whole: 10)",
    )  # fmt: skip
    parser.add_argument(
        "--drives",
        type=int,
        default=1,
        metavar="N",
        help="number of drives, all but one with random offsets",
    )
    parser.add_argument(
        "--worlds", type=Path, metavar="DIR",
        help="instead of the parts: import every MJCF file in this folder, and report its bodies",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="small and rough, not for publication")
    parser.add_argument("--json", type=Path, metavar="FILE", dest="json_file")
    words = parser.parse_args()
    if words.quick:
        words.minutes = min(words.minutes, 2.0)
        words.door_minutes = min(words.door_minutes, 0.2)
    return words


if __name__ == "__main__":
    main()
