"""`python -m benchmarks.perception [--parts simulated,unknown,...] [--scenes N] [--json FILE]`."""

from __future__ import annotations

import argparse
import json
import os
import platform
from pathlib import Path

from benchmarks.perception import (
    exemplars,
    fitted,
    foreign,
    live,
    real_frames,
    recorded,
    shown_once,
    simulated,
    static,
    tables,
    tracking,
    unknown,
)
from benchmarks.perception.table import Row, lines
from semmap.nodes.perception_node.image_features.image_evidence import with_images
from semmap.nodes.perception_node.recognition.recognition_model import shipped

PARTS = (
    "recorded",
    "real",
    "static",
    "simulated",
    "tables",
    "painted",
    "unknown",
    "foreign",
    "fitted",
    "learnt",
    "shown",
    "tracking",
    "live",
)


def arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception")
    parser.add_argument("--parts", default=",".join(PARTS), help=f"parts to measure: {','.join(PARTS)}")
    parser.add_argument("--scenes", type=int, default=50, help="simulated rooms of each sort")
    parser.add_argument(
        "--recorded", type=Path, default=recorded.data_folder(), help="real scenes with labels"
    )
    parser.add_argument("--piles", type=int, default=300, help="rendered scenes to train segmentation on")
    parser.add_argument(
        "--samples", type=Path, help="the folder of semmap.nodes.training.recognition --parts"
    )
    parser.add_argument("--things", type=Path, default=recorded.data_folder().with_name("foreign"))
    parser.add_argument("--training-scenes", type=int, default=400, help="scenes to train on without samples")
    parser.add_argument(
        "--before", default="", metavar="REV", help="also measure the real frames at a commit"
    )
    parser.add_argument("--static-frames", default="", help="names of real frames to show for a minute")
    parser.add_argument("--looks", type=int, default=static.LOOKS, help="observations of a static frame")
    parser.add_argument("--moves", type=int, default=100, help="moves for tracking")
    parser.add_argument("--json", type=Path, metavar="FILE", dest="json_file")
    return parser.parse_args()


def main() -> None:
    """Measure, print the table, write JSON."""
    words = arguments()
    parts, rows = set(words.parts.split(",")), list[Row]()
    before = os.getloadavg()[0]
    if "recorded" in parts:
        rows += recorded.measure(words.recorded, words.piles)
    data = words.recorded.parent
    if "real" in parts:
        rows += real_frames.measure(data.resolve(), words.before)
    if "static" in parts:
        names = [name for name in words.static_frames.split(",") if name]
        rows += static.measure(data / "real", shipped(), names, words.looks)
    if "simulated" in parts:
        rows += simulated.measure(words.scenes, shipped())
    if "tables" in parts:
        rows += tables.measure(words.scenes, shipped())
    if "painted" in parts:
        rows += simulated.measure_painted(words.scenes, shipped())
    if "foreign" in parts:
        rows += foreign.measure(words.things, words.samples, words.training_scenes)
    if "fitted" in parts:
        rows += fitted.measure(words.scenes, shipped())
    if "learnt" in parts:
        rows += exemplars.measure(words.things, words.scenes // 2, with_images(shipped()))
    if "shown" in parts:
        rows += shown_once.measure(data.resolve(), shipped())
    if "unknown" in parts:
        rows += unknown.measure(words.scenes, words.samples, words.training_scenes)
    if "tracking" in parts:
        rows += tracking.measure(words.moves, shipped())
    if "live" in parts:
        rows += live.measure()
    print(lines(rows))
    print(f"load average: {before:.1f} before, {os.getloadavg()[0]:.1f} now")
    if words.json_file:
        report = {"machine": platform.platform(), "rows": [{**row._asdict(), "met": row.met} for row in rows]}
        words.json_file.write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
