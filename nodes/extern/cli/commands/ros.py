"""The commands `ros` and `mcap`: the map for ROS 2."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import ENDPOINT, TIME, json_option, print_file, with_client
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.runtime import extras
from semmap.schemas import errors, wording

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client


def _with_its_extra(function: Callable[..., None]) -> Callable[..., None]:
    """Check that the extra `ros` is installed before the command connects to a system."""

    @functools.wraps(function)
    def checked(**arguments: Any) -> None:
        extras.require(f"semmap {click.get_current_context().info_name}", "ros")
        function(**arguments)

    return checked


@command(example="semmap ros --router tcp/127.0.0.1:7447 --domain 0")
@click.option(
    "--router",
    type=ENDPOINT,
    default="tcp/127.0.0.1:7447",
    show_default=True,
    metavar="EP",
    help="Zenoh router of ROS.",
)
@click.option(
    "--domain",
    default=0,
    show_default=True,
    type=click.IntRange(0, 232),
    envvar="ROS_DOMAIN_ID",
    help="ROS domain.",
)
@click.option("--frame", default="map", show_default=True, help="Name of the map frame in ROS.")
@click.option(
    "--rate",
    default=10.0,
    show_default=True,
    type=click.FloatRange(0.1, 100.0),
    help="Rate of transforms [Hz].",
)
@click.option("--meshes", is_flag=True, help="Publish obstacles as meshes instead of primitives.")
@click.option(
    "--camera",
    "cameras",
    multiple=True,
    metavar="NAME=COLOUR,DEPTH,INFO",
    help="ROS camera for perception, with its three topics; may be repeated.",
)
@click.option(
    "--detections",
    multiple=True,
    metavar="TOPIC",
    help="Topic with vision_msgs/Detection3DArray, for perception; may be repeated.",
)
@_with_its_extra
@with_client
def ros(
    client: Client,
    router: str,
    domain: int,
    frame: str,
    rate: float,
    meshes: bool,
    cameras: tuple[str, ...],
    detections: tuple[str, ...],
) -> None:
    """Publish the map to ROS 2, and subscribe to its cameras.

    The command uses the protocol of rmw_zenoh, so ROS need not be installed. It publishes /semmap/detections,
    /semmap/markers and /semmap/map (latched), /tf with a frame for each entity, and diffs on /planning_scene.
    """
    from semmap.nodes.extern.ros.cameras import parse_camera
    from semmap.nodes.extern.ros.runner import RosConfig, run

    config = RosConfig(
        router=router,
        domain=domain,
        frame=frame,
        rate_hz=rate,
        meshes=meshes,
        cameras=tuple(map(parse_camera, cameras)),
        detections=detections,
    )
    run(
        client.session,
        client.prefix,
        config,
        lambda text: print_escaped(text, file=sys.stderr),
        lambda: print_escaped(f"publishing to ROS at {router}, domain {domain}; press Ctrl-C to stop"),
    )


@command(example="semmap mcap morning.mcap --since 08:00 --until 09:00")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--since", metavar="COMMIT|TIME", help=f"Start of the period. {TIME}")
@click.option("--until", metavar="COMMIT|TIME", help="End of the period. Default: now.")
@click.option("--frame", default="map", show_default=True, help="Name of the map frame in ROS.")
@_with_its_extra
@json_option
@with_client
def mcap(client: Client, file: Path, since: str | None, until: str | None, frame: str) -> None:
    """Write a period of the history to an MCAP file.

    FILE.mcap has the topics of semmap ros for each commit. Foxglove and ros2 bag can read it.
    """
    from semmap.nodes.extern.ros.bridge import topics
    from semmap.nodes.extern.ros.mcap_file import states, write

    if file.suffix != ".mcap":
        raise errors.BadRequest(
            f"{file.name}: the suffix must be .mcap, as in {file.with_suffix('.mcap').name}"
        )
    count = write(file, states(client, since, until), topics(), frame=frame)
    print_file(file, f"{wording.counted(count, 'message')} written to {file}", messages=count)
