"""The command `frames`: the tree of coordinate frames, or the conversion of recordings to frame folders."""

from __future__ import annotations

import functools
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    INPUT_PATH,
    drop_unset,
    print_error,
    print_json,
    print_lines,
    with_client,
)
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.nodes.extern.files import BAG_SUFFIXES, is_bag
from semmap.nodes.runtime import extras
from semmap.schemas import errors
from semmap.schemas.wording import counted

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.nodes.extern.frame_folders.frames import Recording

_PROGRESS_S = 5.0
"""Period of progress messages [s]."""
_WITHIN_S = 0.03


def _or_folders(function: Callable[..., None]) -> Callable[..., None]:
    """Add the conversion of a recording to a command: with two arguments, no system is needed."""

    @click.option(
        "--every",
        type=click.FloatRange(min=0.0),
        metavar="SECONDS",
        help="Recording: minimum time between two frames.",
    )
    @click.option(
        "--within",
        type=click.FloatRange(min=0.0),
        metavar="SECONDS",
        help=f"Recording: maximum time between colour and depth of a frame. Default: {_WITHIN_S}.",
    )
    @click.option("--rgb-topic", metavar="TOPIC", help="Recording: colour topic, if there are several.")
    @click.option("--depth-topic", metavar="TOPIC", help="Recording: depth topic, if there are several.")
    @click.option("--base", metavar="FRAME", help="Recording: frame on /tf for camera poses, z up.")
    @click.option(
        "--intrinsics",
        metavar="FILE",
        type=INPUT_PATH,
        help="Recording: camera file, as for perceive (fx, fy, cx, cy, depth_scale ...).",
    )
    @functools.wraps(function)
    def chosen(name: str | None, folder: Path | None, format: str | None, **arguments: Any) -> None:
        options = {option: arguments.pop(option) for option in _OPTIONS}
        if folder is not None and name is not None:
            if format == "tree":
                raise errors.BadRequest("--format tree applies to the frame tree only, not to a recording")
            from semmap.nodes.runtime.isolated_process import limited_memory

            try:
                with limited_memory():
                    _folders(
                        INPUT_PATH.convert(name, None, None), folder, as_json=format == "json", **options
                    )
            except MemoryError:  # also of an image, or of a folder in the TUM format
                raise errors.BadFile(
                    f"{name} needs more memory to read than this machine can give it"
                ) from None
            return
        if passed := list(drop_unset(options)):
            option = passed[0].replace("_", "-")
            raise errors.BadRequest(f"--{option} requires a recording: semmap frames RECORDING DIR")
        if name is not None and ("/" in name or Path(name).suffix in BAG_SUFFIXES):
            raise errors.BadRequest(f"missing argument DIR; usage: semmap frames {name} DIR")
        function(name=name, format=format, **arguments)

    return chosen


_OPTIONS = ("every", "within", "rgb_topic", "depth_topic", "base", "intrinsics")


@command(example="semmap frames robot1")
@click.argument("name", metavar="[NAME | RECORDING DIR]", required=False, shell_complete=entity_names)
@click.argument("folder", metavar="", required=False, type=click.Path(path_type=Path))
@click.option("--format", "format", type=click.Choice(["tree", "json"]), help="[default: tree]")
@_or_folders
@with_client
def frames(client: Client, name: str | None, format: str | None) -> None:
    """Show the frame tree, or convert a recording.

    Each frame is shown with its pose in its parent. Frames are the map, entities, cameras, and published
    frames. With NAME, only that frame, its ancestors and its descendants are shown.

    With RECORDING and DIR, the frames of a depth camera are written to folders in DIR, for perceive --frames.
    This needs no running system. A recording is a rosbag (.bag, .db3 or a folder), an MCAP file, or a folder
    in the TUM format (rgb, depth, rgb.txt, depth.txt and, optionally, groundtruth.txt).
    """
    found = client.frames(name)
    if format == "json":
        print_json(found)
    else:
        output.show.console().print(output.show.frame_tree(found))


def _folders(
    path: Path,
    folder: Path,
    *,
    as_json: bool,
    every: float | None,
    within: float | None,
    rgb_topic: str | None,
    depth_topic: str | None,
    base: str | None,
    intrinsics: Path | None,
) -> None:
    """Write the frames of a recording. Frames that cannot be used are skipped and reported."""
    extras.require("semmap frames RECORDING DIR", "ros", "perception")
    from semmap.nodes.extern.frame_folders import bag_frames, tum
    from semmap.nodes.extern.frame_folders.frames import make, require_empty

    require_empty(folder)
    common: dict[str, Any] = {
        "within_s": _WITHIN_S if within is None else within,
        "every_s": every or 0.0,
        "intrinsics": intrinsics,
    }
    if is_bag(path):
        found = bag_frames.read(path, colour=rgb_topic, depth=depth_topic, base=base, **common)
    elif path.is_dir():
        if rgb_topic or depth_topic or base:
            raise errors.BadRequest(
                f"{path} is not a rosbag; --rgb-topic, --depth-topic and --base require a rosbag or MCAP file"
            )
        found = tum.read(path, **common)
    else:
        raise errors.BadFile(
            f"{path} is not a recording; supported: {', '.join(BAG_SUFFIXES)} and folders in the TUM format"
        )
    make(folder)
    _write(found, path, folder, as_json=as_json)


def _write(found: Recording, path: Path, folder: Path, *, as_json: bool) -> None:
    from semmap.nodes.extern.frame_folders.frames import write
    from semmap.nodes.perception_node.input.projection import check_intrinsics

    began_s = printed_s = time.monotonic()
    bad: list[errors.SemmapError] = []
    posed = 0
    doubts = dict[str, None]()
    for number, frame in enumerate(found.frames, 1):
        if isinstance(frame, errors.SemmapError):
            bad.append(frame)
        else:
            write(frame, folder)
            height, width = frame.depth_m.shape
            doubts[check_intrinsics(frame.intrinsics, width, height)] = None
            posed += frame.map_from_camera is not None
        if (now_s := time.monotonic()) > printed_s + _PROGRESS_S:
            printed_s = now_s
            print_escaped(
                f"semmap: {number} of {found.count} frames ({now_s - began_s:.0f} s)", file=sys.stderr
            )
    for doubt in filter(None, doubts):
        print_error(f"note: {path}: {doubt}")
    written = found.count - len(bad)
    if not written:
        raise errors.BadFile(f"{path}: no usable frames; first error: {bad[0].text}")
    if as_json:
        counts = {"frames": written, "with_pose": posed, "skipped": len(bad)}
        print_json({"folder": str(folder), **counts, "notes": found.notes})
    else:
        print_lines(found.notes)
        if 0 < posed < written:
            print_lines([f"{counted(written - posed, 'frame')} without a camera pose (no pose at that time)"])
        print_escaped(
            f"{counted(written, 'frame')} of {path} in {folder} ({time.monotonic() - began_s:.1f} s)"
        )
    if bad:
        print_error(f"{counted(len(bad), 'frame')} skipped; first error: {bad[0].text}")
