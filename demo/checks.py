"""Checks of the files that the tour writes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from semmap.nodes.recorder.intact_part import chunks
from semmap.nodes.recorder.recorded_commits import read_commits

if TYPE_CHECKING:
    from demo.tour import Tour

_ROBOT, _POSITION = "/map/bodies/robot1", "Transform3D:translation"
_DRIVEN_M, _POSES = 2.0, 40
_SAID = ("name", "class", "types", "pose", "size_m", "preferred_reference", "alternative_references")


def check_export(t: Tour) -> None:
    """Check that loading the export gives the same map, over the present map and into an empty one."""
    from demo.tour import EXPORT

    before = _said(t)
    t.do("load", str(EXPORT), "--replace", holds="changes nothing in the map")
    t.do("clear")
    t.do("load", str(EXPORT), holds=f"loaded {len(before)} entities")
    if _said(t) != before:
        t.failures.append(f"{EXPORT} does not load back equal")


def check_recording(path: Path, commits: int, failures: list[str]) -> None:
    """Check that the recording contains all commits."""
    recorded = [commit.seq for commit in read_commits(path)]
    print(f"{path.name}: {len(recorded)} commits, of {commits}")
    if recorded != list(range(1, commits + 1)):
        failures.append(f"{path} does not contain all commits: {recorded}")


def check_drive(path: Path, failures: list[str]) -> None:
    """Check that the recording shows the robot driving, not only its stops."""
    batches = (chunk.to_record_batch() for chunk in chunks(path) if chunk.entity_path == _ROBOT)
    columns = (batch.column(_POSITION).to_pylist() for batch in batches if _POSITION in batch.schema.names)
    positions = np.array([at for column in columns for (at,) in filter(None, column)]).reshape(-1, 3)
    length_m = float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum())
    print(f"{path.name}: the robot drives {length_m:.1f} m, in {len(positions)} poses")
    if length_m < _DRIVEN_M or len(positions) < _POSES:
        failures.append(f"{path} does not show how the robot drives")


def check_picture(path: Path, failures: list[str]) -> None:
    """Check that the image is not blank."""
    pixels = np.asarray(Image.open(path).convert("L"), dtype=float)
    print(f"{path.name}: {pixels.shape[1]} x {pixels.shape[0]}, contrast {pixels.std():.0f}")
    if pixels.std() < 5.0:
        failures.append(f"{path} is blank")


def _said(t: Tour) -> list[dict[str, Any]]:
    """Return the asserted fields of each entity, without provenance."""
    entities = t.ask("list")
    assert isinstance(entities, list)
    return [{key: entity[key] for key in _SAID} for entity in entities]
