"""Frames of real cameras with names for their things, by `semmap perceive`, now and at an older commit.

The frames, the scorer and the layout of the table scenes belong to the shared data: `real/` and `mosd/` in
the data folder, and `score_names.py` and `mosd_frames.py` in `tools/` beside it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.perception.table import Row

_HERE = Path(__file__).resolve().parents[2]
_SINGLE, _PHANTOMS = 0.85, 0.6


def measure(data: Path, before: str = "") -> list[Row]:
    """Return the figures of both sets; with `before`, those of that commit come first."""
    tools, rows = data.parent / "tools", list[Row]()
    with frame_sets(data) as sets:
        for name, frames in sets.items():
            if before:
                with _checked_out(before) as code:
                    rows += _rows(f"{name} at {before}", _score(tools, frames, code))
            rows += _rows(name, _score(tools, frames, _HERE))
    return rows


@contextmanager
def frame_sets(data: Path) -> Iterator[dict[str, Path]]:
    """Lay out both sets as folders of frames, by name; none without the data or the tools beside it."""
    tools = data.parent / "tools"
    if not (data / "real").is_dir() or not (tools / "score_names.py").exists():
        print(f"no real frames in {data}, or no scorer in {tools}: set SEMMAP_DATA")
        yield {}
        return
    with TemporaryDirectory() as folder:
        sets = {"real": data / "real", "mosd": Path(folder) / "mosd"}
        names = data / "mosd" / "names.json"
        _run([tools / "mosd_frames.py", data / "mosd", names, sets["mosd"]])
        yield sets


def _rows(name: str, counts: Mapping[str, float]) -> list[Row]:
    things, single, frames = (max(1, counts[key]) for key in ("things", "single", "frames"))
    right = counts["right"] + counts["new_right"]
    wrong = counts["wrong"] + counts["new_wrong"]
    return [
        Row(f"{name}: found singly, of {counts['things']} things", counts["single"] / things, "", _SINGLE),
        Row(f"{name}: class or a superclass, of those", right / single),
        Row(f"{name}: another class, of those", wrong / single),
        Row(f"{name}: phantoms, a frame", counts["phantom"] / frames, "", _PHANTOMS, less=True),
        Row(f"{name}: phantoms with a name, a frame", counts["named"] / frames),
    ]


def _score(tools: Path, frames: Path, code: Path) -> dict[str, float]:
    """Run perception of the code in a folder on all frames, and return the counts of the scorer."""
    with TemporaryDirectory() as folder:
        result, labels = Path(folder) / "result.json", Path(folder) / "labels"
        program = "from semmap.nodes.extern.cli.app import main; main()"
        given: list[str | Path] = ["perceive", "--frames", frames, "--labels", labels, "--json", result]
        _run(["-c", program, *given], code)
        scored = _run([tools / "score_names.py", frames, result, "--labels", labels, "--json", "-"], code)
    counts: dict[str, float] = json.loads(scored)["all"]
    return counts


def _run(arguments: list[str | Path], code: Path = _HERE) -> str:
    environment = os.environ | {"PYTHONPATH": str(code)}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(
        command, cwd=code, env=environment, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


@contextmanager
def _checked_out(commit: str) -> Iterator[Path]:
    """Check out a commit in a temporary folder."""
    with TemporaryDirectory() as folder:
        code = Path(folder) / "code"
        subprocess.run(["git", "worktree", "add", "--detach", "-q", code, commit], cwd=_HERE, check=True)
        try:
            yield code
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", code], cwd=_HERE, check=True)
