"""The command `perceive`: object detection in files, without a running system."""

from __future__ import annotations

import io
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import INPUT_PATH, print_error, print_json
from semmap.nodes.extern.cli.detector_options import detector_of, detector_options
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.output.show import console
from semmap.nodes.extern.cli.output.show_perceived import as_records, as_table, show_frame
from semmap.nodes.extern.files import is_bag, write_atomically
from semmap.nodes.runtime import extras
from semmap.schemas import errors, wording
from semmap.schemas.perception import FrameRow

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from semmap.nodes.perception_node.detector import Detector
    from semmap.nodes.perception_node.input.cloud import Cloud
    from semmap.nodes.perception_node.input.viewpoint import Placement, Up
    from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel

_PROGRESS_S = 5.0
"""Period of progress messages [s]."""
_CLUTTER = "?: depth noise, a fragment, or a part of furniture (with --frames, parts are combined)"
_FRAMES = {
    "map": "map frame",
    "plane": "frame: z = 0 is the floor or the largest plane, the origin is below the camera",
}


_ANY_PATH = click.Path(path_type=Path)


def _path_option(
    name: str, metavar: str, help: str, *also: str, type: click.Path = INPUT_PATH
) -> Callable[[Any], Any]:
    """Return an option whose value is a file or a folder."""
    return click.option(name, *also, metavar=metavar, type=type, help=help)


@command(example="semmap perceive --frames recording --format json")
@click.argument("files", metavar="[FILE...]", nargs=-1, type=INPUT_PATH)
@_path_option(
    "--frames",
    "DIR",
    "Dataset, or one of its frames: a folder with rgb.png, depth.png [mm] and camera.json.",
)
@_path_option(
    "--labels",
    "OUT",
    "Write the object label of each point to this .npy file or, with --frames, to files in this folder.",
    type=_ANY_PATH,
)
@_path_option(
    "--json",
    "OUT",
    "With --frames: write the results to this JSON file, one row per frame.",
    "rows",
    type=_ANY_PATH,
)
@_path_option(
    "--intrinsics",
    "FILE",
    "JSON with fx, fy, cx, cy [pixel], depth_scale [m], map_from_camera; or camera_info YAML, or a matrix K.",
)
@click.option(
    "--up",
    type=click.Choice(["x", "y", "z", "-x", "-y", "-z"]),
    help="Clouds are in a map's or robot's frame; this axis is up.",
)
@click.option(
    "--pose",
    type=float,
    nargs=7,
    metavar="X Y Z QW QX QY QZ",
    help="Pose of the optical frame (z forward) in the map; with --up, in the frame of the cloud.",
)
@click.option("--topic", metavar="NAME", help="Topic of the clouds of a bag, if it has several.")
@click.option(
    "--every",
    metavar="SECONDS",
    type=click.FloatRange(0),
    default=1.0,
    show_default=True,
    help="Time between the clouds of a bag that are used; 0 for all.",
)
@_path_option(
    "--masks",
    "FILE",
    "Masks of a detector (COCO, labelme, CVAT, YOLO, image, .npz); with --frames, their name in each folder.",
    type=_ANY_PATH,
)
@_path_option(
    "--mask-robot",
    "FILE.json",
    "Leave out the robot: model (MJCF, URDF), joints, map_from_base; with --frames, the name in each folder.",
    type=_ANY_PATH,
)
@detector_options
@_path_option(
    "--label-map", "FILE.json", 'Labels of the detector and their classes, as in {"coffee mug": "Cup"}.'
)
@click.option("--masks-only", is_flag=True, help="Report only the objects that the detector found.")
@click.option("--fit", is_flag=True, help="Fit class models to the objects, for full poses (needs Open3D).")
@_path_option(
    "--data", "DIR", "Also use the exemplars in this data folder (semmap learn --data).", type=_ANY_PATH
)
@click.option("--format", type=click.Choice(["table", "json"]), default="table", show_default=True)
def perceive(
    files: tuple[Path, ...],
    frames: Path | None,
    labels: Path | None,
    rows: Path | None,
    intrinsics: Path | None,
    up: Up | None,
    pose: tuple[float, ...] | None,
    topic: str | None,
    every: float,
    masks: Path | None,
    mask_robot: Path | None,
    label_map: Path | None,
    masks_only: bool,
    fit: bool,
    data: Path | None,
    format: str,
    **model: Any,
) -> None:
    """Find the objects in point clouds, depth images or datasets.

    Point clouds are PCD or PLY files, with Open3D also .xyz, .xyzrgb and .pts files, and those in bags (.bag,
    .db3, .mcap). Images are a colour and a depth image (PNG, JPEG, TIFF, PGM, .npy). The labels are integers
    in the shape of the cloud: (height, width), or (1, points) for unorganized clouds. 0 is the background, 1
    to n are the objects.
    """
    extras.require("semmap perceive", "perception")
    if fit:
        _require_open3d()
    if mask_robot is not None:
        extras.require("semmap perceive --mask-robot", "sim")
    detector = detector_of(masks, label_map, masks_only=masks_only, each_core=frames is not None, **model)
    if frames is not None:
        if files or any(option is not None for option in (intrinsics, up, pose)):
            raise errors.BadRequest(
                "--frames excludes FILE, --intrinsics, --up and --pose; each frame has its own camera.json"
            )
        _dataset(frames, labels, rows, detector, _learnt(data), format, mask_robot, fit=fit)
        return
    if rows is not None:
        raise errors.BadRequest("--json requires --frames; for files use --format json")
    if not files:
        raise errors.BadRequest("missing argument FILE; name a file, or a dataset with --frames DIR")
    if labels is not None and labels.suffix != ".npy":
        raise errors.BadRequest(
            f"--labels {labels.name}: the suffix must be .npy, as in {labels.with_suffix('.npy').name}"
        )
    import numpy as np  # importing it takes half of the start of the command line

    from semmap.nodes.perception_node.fitting.fit_observations import fit_view
    from semmap.nodes.perception_node.fitting.model_surfaces import shipped as surfaces
    from semmap.nodes.perception_node.input.robot_mask import read_robot
    from semmap.nodes.perception_node.input.viewpoint import Placement
    from semmap.nodes.perception_node.pipeline import recognise_segments
    from semmap.nodes.perception_node.views.masked import with_masks
    from semmap.nodes.perception_node.views.segmented_view import segment_cloud

    learnt = _learnt(data)
    clouds = _clouds(files, intrinsics, Placement(up, None if pose is None else _pose(pose)), topic, every)
    first = list(islice(clouds, 2))
    for option, value in (("--labels", labels), ("--masks", masks)):
        if value is not None and len(first) != 1:
            raise errors.BadRequest(f"{option} requires a single frame")
    records, robot = [], None if mask_robot is None else read_robot(mask_robot)
    for file, cloud in chain(first, clouds):
        sight = segment_cloud(cloud if robot is None else robot.remove_from(cloud))
        for note in sight.notes:
            print_error(f"note: {file}: {note}")
        if detector is not None:
            height, width = sight.labels.shape
            masks_found = detector.masks_of(cloud, (height, width))
            if unknown_here := detector.labels.unknown([masks_found]):
                print_error(wording.unknown_labels(unknown_here))
            sight = with_masks(sight, masks_found)
        observations = recognise_segments(sight, learnt, None if detector is None else detector.labels)
        if fit:
            observations = fit_view(sight, observations, surfaces())
        frame = "plane" if cloud.map_from_camera is None else "map"
        if format == "json":
            objects = as_records(sight, observations)
            records.append({"file": str(file), "frame": frame, "objects": objects, "notes": sight.notes})
        else:
            console().print(f"{file}: {wording.counted(len(observations), 'object')}; {_FRAMES[frame]}")
            if observations:
                console().print(as_table(sight, observations))
            if None in observations.values():
                console().print(_CLUTTER)
        if labels is not None:
            buffer = io.BytesIO()
            np.save(buffer, np.where(np.isin(sight.labels, list(sight.carriers)), 0, sight.labels))
            write_atomically(labels, buffer.getvalue())
            if format == "table":
                print(f"wrote {labels}")
    if format == "json":
        print_json(records)


def _clouds(
    files: Sequence[Path], intrinsics: Path | None, placement: Placement, topic: str | None, every_s: float
) -> Iterator[tuple[str, Cloud]]:
    """Yield the frames of files and the clouds of bags, each with a name. Raises BadFile and BadRequest."""
    from semmap.nodes.perception_node.input.files.cloud_files import read_frames

    bags = [file for file in files if is_bag(file)]
    if len(bags) not in (0, len(files)):
        raise errors.BadRequest(f"{bags[0]} is a bag; name only bags, or only clouds and images")
    if bags:
        extras.require("semmap perceive with a bag", "ros")
        if not math.isfinite(every_s):
            raise errors.BadRequest("--every must be a number of seconds, such as 0.5")
        from semmap.nodes.extern.frame_folders.bag_clouds import read_clouds

        for bag in bags:
            yield from read_clouds(bag, placement, topic=topic, every_s=every_s)
        return
    if topic is not None:
        raise errors.BadRequest("--topic requires a bag (.bag, .db3, .mcap)")
    for file, cloud in read_frames(files, intrinsics, placement.up, placement.frame_from_camera):
        yield str(file), cloud


def _pose(numbers: tuple[float, ...]) -> NDArray[np.float64]:
    """Return the (4, 4) pose of position [m] and quaternion (w first). Raises BadRequest."""
    import numpy as np
    from scipy.spatial.transform import Rotation

    if not np.isfinite(numbers).all() or not np.isclose(np.linalg.norm(numbers[3:]), 1.0, atol=1e-3):
        raise errors.BadRequest("--pose: QW QX QY QZ must be a unit quaternion, such as 1 0 0 0")
    found = np.eye(4)
    found[:3, :3] = Rotation.from_quat(numbers[3:], scalar_first=True).as_matrix()
    found[:3, 3] = numbers[:3]
    return found


def _require_open3d() -> None:
    from semmap.nodes.perception_node.fitting.fit import available

    if not available():
        raise errors.BadRequest(
            "--fit requires Open3D (installed by the extra semmap[perception] for Python up to 3.12); without"
            " it, boxes are reported"
        )


def _learnt(data: Path | None) -> RecognitionModel:
    """Return the trained classifiers, with the exemplars of a data folder."""
    from semmap.nodes.perception_node.exemplar_store import FILENAME, ExemplarStore
    from semmap.nodes.perception_node.image_features.image_evidence import with_images
    from semmap.nodes.perception_node.recognition.recognition_model import shipped

    if data is None:
        return with_images(shipped())
    if not (data / FILENAME).exists():
        raise errors.BadFile(
            f"no exemplars in {data}; to add one: semmap learn CLASS --frames DIR --data {data}"
        )
    return with_images(ExemplarStore(data / FILENAME, shipped()).learnt)


def _dataset(
    folder: Path,
    labels: Path | None,
    out: Path | None,
    detector: Detector | None,
    learnt: RecognitionModel,
    format: str,
    robot: Path | None,
    *,
    fit: bool,
) -> None:
    """Find the objects in each frame of a dataset. The error of a frame is in its row."""
    import msgspec
    import numpy as np

    from semmap.nodes.perception_node.datasets import perceive_folders
    from semmap.nodes.perception_node.fitting.model_surfaces import shipped as surfaces
    from semmap.nodes.perception_node.input.files.frame_folders import frames_in

    folders = frames_in(folder)
    if out is not None and (out.is_dir() or not out.absolute().parent.is_dir()):
        raise errors.BadFile(f"{out} cannot be written: it is a folder, or its parent folder does not exist")
    if labels is not None:
        try:
            labels.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise errors.BadFile(f"{labels} cannot be created: {error.strerror}") from None
    rows, unknown, printed_s, began_s = [], set[str](), 0.0, time.monotonic()
    noted = dict[str, list[str]]()
    for found in perceive_folders(folders, learnt, detector, surfaces() if fit else None, robot):
        rows.append(found.row)
        unknown.update(found.unknown_labels)
        for note in found.row.notes:
            noted.setdefault(note, []).append(found.row.frame)
        if labels is not None and found.labels is not None:
            buffer = io.BytesIO()
            np.save(buffer, found.labels)
            write_atomically(labels / f"{found.row.frame}.npy", buffer.getvalue())
        if out is None and format == "table":
            show_frame(found.row)
        elif time.monotonic() > printed_s + _PROGRESS_S:
            printed_s = time.monotonic()
            print_escaped(
                f"semmap: {len(rows)} of {len(folders)} frames ({printed_s - began_s:.0f} s)", file=sys.stderr
            )
    if out is not None:
        lines = b",\n".join(msgspec.json.encode(row) for row in rows)
        write_atomically(out, b"[\n" + lines + b"\n]\n")
    if unknown:
        print_error(wording.unknown_labels(sorted(unknown)))
    for note, names in noted.items():
        print_error(f"note: {wording.few(names)}: {note}")
    if out is None and format == "json":
        print_json(rows)
    else:
        print_escaped(
            _summary(rows, time.monotonic() - began_s, [path for path in (out, labels) if path is not None])
        )
    if all(row.error for row in rows):
        raise errors.BadFile(f"{folder}: no usable frames")


def _summary(rows: Sequence[FrameRow], took_s: float, written: Sequence[Path]) -> str:
    bad = [row for row in rows if row.error]
    objects = wording.counted(sum(len(row.objects) for row in rows), "object")
    speed = f"{took_s:.1f} s ({len(rows) / took_s:.1f} frames/s)"
    lines = [f"{wording.counted(len(rows), 'frame')}, {objects} in {speed}"]
    if bad:
        lines.append(f"{wording.counted(len(bad), 'frame')} skipped; first error: {bad[0].error}")
    return "\n".join([*lines, *(f"wrote {path}" for path in written)])
