"""The options of `semmap up` and `semmap node`."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from semmap.nodes import bus
from semmap.nodes.extern.cli.angles import ANGLE
from semmap.nodes.extern.cli.common import ENDPOINT
from semmap.nodes.extern.cli.detector_options import detector_options
from semmap.nodes.extern.cli.ontology_options import TBoxFile, import_option, spatial_root_option
from semmap.nodes.extern.cli.system_settings import complete_settings
from semmap.schemas.endpoints import NAMESPACE_VARIABLE

_path = click.Path(path_type=Path)


def settings_options(function: Callable[..., None]) -> Callable[..., None]:
    """Add the options of `up` and `node`, which the function receives as Settings."""

    @click.option(
        "--tbox",
        type=TBoxFile(),
        multiple=True,
        help="Ontology (file or folder) with its imports, or the word household; may be repeated."
        " Default: household.",
    )
    @import_option
    @spatial_root_option
    @click.option(
        "--abox",
        help="ABox file, or none for an empty map. Default: the flat; none with --tbox other than household,"
        " --truth perceived, or --truth scene with --world.",
    )
    @click.option(
        "--skip-unknown", is_flag=True, help="Skip individuals of the ABox file of unknown classes."
    )
    @click.option(
        "--tbox-from-abox", is_flag=True, help="Add classes and properties of the ABox file to the TBox."
    )
    @click.option(
        "--enforce-shapes", is_flag=True, help="Reject changes that violate a SHACL shape of the TBox."
    )
    @click.option(
        "--world",
        help="MJCF file, JSON scene, or empty. Default: the previous world, or the world of the flat.",
    )
    @click.option(
        "--data",
        type=_path,
        default=None,
        help="Folder for the journal, logs and recordings. Default: your user data folder.",
    )
    @click.option("--fresh", is_flag=True, help="Start a new map; the old one is moved to DIR/kept.")
    @click.option(
        "--truth",
        type=click.Choice(["map", "scene", "perceived"]),
        default=None,
        help="Source of truth for which entities exist. Default: the previous value, or map.",
    )
    @click.option(
        "--threshold",
        "threshold_m",
        type=float,
        default=0.05,
        show_default=True,
        metavar="M",
        help="Minimum displacement of a body that updates the map.",
    )
    @click.option(
        "--angle-threshold",
        "angle_threshold_deg",
        type=float,
        default=5.0,
        show_default=True,
        metavar="DEG",
        help="Minimum rotation of a body that updates the map.",
    )
    @click.option(
        "--stale",
        "stale_s",
        type=float,
        default=2.0,
        show_default=True,
        metavar="SECONDS",
        help="Timeout of live poses.",
    )
    @click.option(
        "--journal-every",
        "journal_every_s",
        type=float,
        default=0.0,
        metavar="SECONDS",
        help="Commit interval of tracked poses. Default: commit only when an entity stops.",
    )
    @click.option(
        "--listen",
        type=ENDPOINT,
        default=bus.DEFAULT_ENDPOINT,
        show_default=True,
        metavar="EP",
        help="Zenoh endpoint that the system listens on.",
    )
    @click.option(
        "--connect",
        type=ENDPOINT,
        multiple=True,
        metavar="EP",
        help="Zenoh endpoint to join; may be repeated.",
    )
    @click.option(
        "--only",
        metavar="NODES",
        default=None,
        help="Run only these nodes, such as kb,coordinator; the others run on other hosts.",
    )
    @click.option(
        "--namespace",
        envvar=NAMESPACE_VARIABLE,
        show_envvar=True,
        default="",
        metavar="ROBOT",
        help="Name of this robot: the prefix of its Zenoh keys, so that robots can share a network.",
    )
    @click.option(
        "--secure",
        type=_path,
        default=None,
        metavar="DIR",
        help="Require a certificate of this folder from every client (see: semmap keys).",
    )
    @click.option(
        "--zenoh-config",
        type=_path,
        default=None,
        metavar="FILE",
        help="Zenoh configuration for settings that semmap does not set.",
    )
    @click.option(
        "--insecure", is_flag=True, help="Accept connections from other hosts without certificates."
    )
    @click.option(
        "--robot",
        metavar="FILE",
        default=None,
        help="Add a robot to the world: an MJCF file, or porter, which is included in semmap.",
    )
    @click.option("--robot-name", default="robot1", show_default=True, help="Name of the robot in the map.")
    @click.option(
        "--robot-at",
        nargs=3,
        type=float,
        default=None,
        metavar="X Y Z",
        help="Position of a new robot [m]; a robot in the map starts at its last pose. Default: 0 0 0, or a"
        " free place in the flat.",
    )
    @click.option(
        "--robot-yaw",
        type=ANGLE,
        default=0.0,
        metavar="ANGLE",
        help="Yaw of a new robot: radians, or degrees as in 90deg.",
    )
    @click.option(
        "--reset-world",
        is_flag=True,
        help="With --truth scene: begin as in the world file. Default: where bodies last stood.",
    )
    @click.option("--window", is_flag=True, help="Show the scene in a window (needs a display).")
    @click.option(
        "--models",
        type=_path,
        default=None,
        help="Folder of model files that replace library models (chair.glb for chair).",
    )
    @click.option(
        "--camera-hz",
        type=float,
        default=None,
        metavar="HZ",
        help="Frame rate of the simulated cameras. Default: 0 (off), 5 with --perception.",
    )
    @click.option(
        "--camera-size",
        nargs=2,
        type=int,
        default=(640, 480),
        metavar="W H",
        show_default=True,
        help="Image size of the simulated cameras [pixel].",
    )
    @click.option("--camera-noise", is_flag=True, help="Add Kinect-like noise to depth images.")
    @click.option("--perception", is_flag=True, help="Update the map from camera frames.")
    @click.option(
        "--when-gone",
        type=click.Choice(["remove", "mark"]),
        default="remove",
        show_default=True,
        help="What to do with perceived entities that are no longer observed.",
    )
    @detector_options
    @click.option(
        "--label-map",
        type=click.Path(path_type=Path),
        default=None,
        metavar="FILE.json",
        help='Labels of a detector and their classes, as in {"coffee mug": "Cup"}.',
    )
    @click.option(
        "--mask-robot",
        metavar="[NAME=]MODEL",
        help="Leave a robot out of camera frames: its MJCF or URDF file, or porter. Its states are those on"
        " semmap/robot/NAME; default NAME: --robot-name.",
    )
    @click.option(
        "--class-map",
        type=click.Path(path_type=Path),
        default=None,
        metavar="FILE.json",
        help='Bodies of the world and their classes, as in {"mug_blue": "Cup"}.',
    )
    @click.option("--no-sim", is_flag=True, help="Do not start the simulator.")
    @click.option("--no-record", is_flag=True, help="Do not start the recorder.")
    @click.option(
        "--record-keep",
        metavar="LIMIT",
        default=None,
        help="Delete recordings older than 12h or 7d, or beyond 500MB or 20GB. Default: keep all.",
    )
    @click.option("--web", is_flag=True, help="Also start the page: the map in a browser.")
    @click.option(
        "--web-port",
        type=click.IntRange(0, 65_535),
        default=None,
        metavar="N",
        help="Port of the page; 0 is any free one. Default: 8080.",
    )
    @click.option("--web-as", metavar="NAME", help="With --secure: certificate that the page uses.")
    @functools.wraps(function)
    def with_settings(name: str | None = None, **options: Any) -> None:
        node_name = {} if name is None else {"name": name}
        function(settings=complete_settings(options, single=name is not None), **node_name)

    return with_settings
