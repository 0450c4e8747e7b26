"""The verb `frames`: the tree of coordinate frames, or a recording's pictures as folders of frames."""

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
from semmap.nodes.extern.cli.common import drop_unset, print_error, print_json, with_client
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.nodes.runtime import extras
from semmap.schemas import errors
from semmap.schemas.wording import counted

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.nodes.extern.frame_folders.frames import Recording

_SAY_S = 5.0
"""After this time it is told again how far a recording is."""
_WITHIN_S = 0.03


def _or_folders(function: Callable[..., None]) -> Callable[..., None]:
    """With two words it is about a recording, and no system is asked."""

    @click.option(
        "--every",
        type=click.FloatRange(min=0.0),
        metavar="SECONDS",
        help="Of a recording: take fewer frames.",
    )
    @click.option(
        "--within",
        type=click.FloatRange(min=0.0),
        metavar="SECONDS",
        help=f"Colour and depth no farther apart are one frame. Default: {_WITHIN_S}.",
    )
    @click.option("--rgb-topic", metavar="TOPIC", help="Where a bag has colour on several topics.")
    @click.option("--depth-topic", metavar="TOPIC", help="Where a bag has depth on several topics.")
    @click.option("--base", metavar="FRAME", help="In which frame of /tf poses are told, z up.")
    @click.option(
        "--intrinsics",
        metavar="FILE.json",
        type=click.Path(path_type=Path),
        help="The recording's camera: fx, fy, cx, cy [pixel] and, optionally, depth_scale [m].",
    )
    @functools.wraps(function)
    def chosen(name: str | None, folder: Path | None, format: str | None, **arguments: Any) -> None:
        options = {option: arguments.pop(option) for option in _OPTIONS}
        if folder is not None and name is not None:
            if format is not None:
                raise errors.BadRequest(
                    "--format goes with the tree; a recording becomes folders of pictures"
                )
            _folders(Path(name), folder, **options)
            return
        if said := list(drop_unset(options)):
            option = said[0].replace("_", "-")
            raise errors.BadRequest(f"--{option} goes with a recording: semmap frames RECORDING DIR")
        if name is not None and ("/" in name or Path(name).suffix in _SUFFIXES):
            raise errors.BadRequest(f"name the new folder for its frames, too: semmap frames {name} DIR")
        function(name=name, format=format, **arguments)

    return chosen


_OPTIONS = ("every", "within", "rgb_topic", "depth_topic", "base", "intrinsics")
_SUFFIXES = (".bag", ".db3", ".mcap")


@command(example="semmap frames robot1")
@click.argument("name", metavar="[NAME | RECORDING DIR]", required=False, shell_complete=entity_names)
@click.argument("folder", metavar="", required=False, type=click.Path(path_type=Path))
@click.option("--format", "format", type=click.Choice(["tree", "json"]), help="[default: tree]")
@_or_folders
@with_client
def frames(client: Client, name: str | None, format: str | None) -> None:
    """Show the tree of frames, each with its pose in its parent.

    Frames are the map, entities, cameras, and what others publish. With NAME that frame, those above it and
    those below it.

    With RECORDING and DIR something else is done, without a system: the frames that a depth camera recorded
    become folders in DIR, for perceive --frames. A recording is a rosbag (.bag, .db3 or a folder), an MCAP
    file, or a folder as TUM's tools write it (rgb, depth, rgb.txt, depth.txt, maybe groundtruth.txt).
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
    every: float | None,
    within: float | None,
    rgb_topic: str | None,
    depth_topic: str | None,
    base: str | None,
    intrinsics: Path | None,
) -> None:
    """Write the frames of a recording; what is wrong with one is told, and the others go on."""
    extras.require("semmap frames RECORDING DIR", "ros", "perception")
    from semmap.nodes.extern.frame_folders import bag, bag_frames, tum
    from semmap.nodes.extern.frame_folders.frames import make, require_empty

    if not path.exists():
        raise errors.BadFile(f"there is no file {path}, nor a folder")
    require_empty(folder)
    common: dict[str, Any] = {
        "within_s": _WITHIN_S if within is None else within,
        "every_s": every or 0.0,
        "intrinsics": intrinsics,
    }
    if bag.is_bag(path):
        found = bag_frames.read(path, colour=rgb_topic, depth=depth_topic, base=base, **common)
    elif path.is_dir():
        if rgb_topic or depth_topic or base:
            raise errors.BadRequest(f"{path} is no bag: it has no topics and no /tf")
        found = tum.read(path, **common)
    else:
        raise errors.BadFile(
            f"{path} is no recording; there are {', '.join(_SUFFIXES)}, and folders as TUM's tools write them"
        )
    make(folder)
    _write(found, path, folder)


def _write(found: Recording, path: Path, folder: Path) -> None:
    from semmap.nodes.extern.frame_folders.frames import write

    began_s = said_s = time.monotonic()
    bad: list[errors.SemmapError] = []
    posed = 0
    for number, frame in enumerate(found.frames, 1):
        if isinstance(frame, errors.SemmapError):
            bad.append(frame)
        else:
            write(frame, folder)
            posed += frame.map_from_camera is not None
        if (now_s := time.monotonic()) > said_s + _SAY_S:
            said_s = now_s
            print_escaped(
                f"semmap: {number} of {found.count} frames ({now_s - began_s:.0f} s)", file=sys.stderr
            )
    written = found.count - len(bad)
    if not written:
        raise errors.BadFile(f"{path}: no frame can be used, the first because: {bad[0].text}")
    for note in found.notes:
        print_escaped(note)
    if 0 < posed < written:
        print_escaped(
            f"{counted(written - posed, 'frame')} without a camera pose: nobody said where it was then"
        )
    print_escaped(f"{counted(written, 'frame')} of {path} in {folder} ({time.monotonic() - began_s:.1f} s)")
    if bad:
        print_error(f"{counted(len(bad), 'frame')} could not be used, the first: {bad[0].text}")
