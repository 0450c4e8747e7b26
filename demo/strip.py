"""`python -m demo.strip OUT.png`: images of two cameras from the drive that `make demo` recorded."""

from __future__ import annotations

import io
import sys
from collections import defaultdict
from pathlib import Path

from PIL import Image

from semmap.nodes.recorder.intact_part import chunks

_CAMERAS = ("kitchen", "robot1_head")
_PICTURE, _PLACE, _TIME = "EncodedImage:blob", "Transform3D:translation", "time"
_ROBOT = "/map/bodies/robot1"
_AT_X_M = (7.6, 6.76, 7.6, 8.39)
"""The robot's x at four moments: at the start, at the fridge, past the counter, and at the end."""
_SIZE, _GAP = (480, 360), 8


def main() -> None:
    """Draw the strip: a row for each camera, a column for each moment."""
    out, recording = Path(sys.argv[1]), Path(__file__).with_name("drive.rrd")
    seen, path = _seen(recording)
    columns = [_when(path, i) for i in range(len(_AT_X_M))]
    width, height = (_SIZE[0] + _GAP) * len(columns) - _GAP, (_SIZE[1] + _GAP) * len(_CAMERAS) - _GAP
    strip = Image.new("RGB", (width, height), "white")
    for row, camera in enumerate(_CAMERAS):
        for column, stamp in enumerate(columns):
            nearest = min(seen[camera], key=lambda taken: abs(taken[0] - stamp))
            picture = Image.open(io.BytesIO(nearest[1])).convert("RGB").resize(_SIZE)
            strip.paste(picture, ((_SIZE[0] + _GAP) * column, (_SIZE[1] + _GAP) * row))
    strip.quantize(256).save(out)


def _seen(recording: Path) -> tuple[dict[str, list[tuple[int, bytes]]], list[tuple[int, float]]]:
    """Return the images of each camera and the robot's x [m], with time stamps [ns], in order of time."""
    seen: dict[str, list[tuple[int, bytes]]] = defaultdict(list)
    path: list[tuple[int, float]] = []
    for chunk in chunks(recording):
        batch, camera = chunk.to_record_batch(), chunk.entity_path.rpartition("/")[2]
        wanted = _PLACE if chunk.entity_path == _ROBOT else _PICTURE if camera in _CAMERAS else ""
        if wanted not in batch.schema.names:
            continue
        stamps = batch.column(_TIME).cast("int64").to_pylist()
        for stamp, values in zip(stamps, batch.column(wanted).to_pylist(), strict=True):
            if not values:
                continue
            if wanted == _PLACE:
                path.append((stamp, values[0][0]))
            else:
                seen[camera].append((stamp, bytes(values[0])))
    return seen, sorted(path)


def _when(path: list[tuple[int, float]], moment: int) -> int:
    """Return when the robot is closest to a moment's x [ns]; the last two are on the way back."""
    turned = min(range(len(path)), key=lambda i: path[i][1])
    leg = path[: turned + 1] if moment < 2 else path[turned:]
    return min(leg, key=lambda stood: abs(stood[1] - _AT_X_M[moment]))[0]


if __name__ == "__main__":
    main()
