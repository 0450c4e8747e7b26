"""The command `replay`: shows a recording, replays the history of a map, or checks a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    ENDPOINT,
    TIME,
    connect_option,
    identity_option,
    namespace_option,
    print_error,
)
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.runtime import extras, playback_clock
from semmap.schemas import errors

_path = click.Path(path_type=Path)


@command(example="semmap replay maps/flat --since 08:00 --speed 10")
@click.argument("what", metavar="FILE.rrd|DATA_DIR", type=_path)
@click.option("--since", metavar="COMMIT|TIME", help="Start of the period. Default: the first commit.")
@click.option("--until", metavar="COMMIT|TIME", help=f"End of the period. Default: now. {TIME}")
@click.option("--speed", type=float, default=None, metavar="X", help="Playback speed factor.  [default: 1]")
@click.option(
    "--longest",
    type=float,
    default=None,
    metavar="S",
    help=f"Maximum wait between two commits.  [default: {playback_clock.LONGEST_S:g}]",
)
@click.option(
    "--listen", type=ENDPOINT, metavar="EP", help="Zenoh endpoint of the replay. Default: a free port."
)
@click.option("--world", type=_path, help="Scene file. Default: the last world of the map.")
@click.option("--no-sim", is_flag=True, help="Replay the map without a scene.")
@click.option("--no-record", is_flag=True, help="Do not record the replay.")
@click.option(
    "--web",
    type=click.IntRange(0, 65_535),
    is_flag=False,
    flag_value=0,
    metavar="[PORT]",
    help="Also show the replay on the page. Default: a free port.",
)
@click.option("--check", is_flag=True, help="Compare the commits of a recording with those of the map.")
@click.option("--data", type=_path, help="With --check: data folder of the map. Default: a running system.")
@connect_option
@identity_option
@namespace_option
def replay(
    what: Path,
    check: bool,
    data: Path | None,
    where: str | None,
    identity: str | None,
    namespace: str | None,
    **options: Any,
) -> None:
    """Open a recording, or replay the history of a map.

    A recording (.rrd) is opened in the Rerun viewer. For a data folder, a separate system with its own
    endpoint replays the commits of the journal, with the original intervals between them. The map is only
    read; its system may be running.

    With --check, the recorded commits are compared with the journal of --data, or of the system at --connect.
    If commits differ or are missing, they are printed, and the exit status is 1.
    """
    if what.is_dir():
        if check:
            raise errors.BadRequest(f"--check requires a recording (.rrd); {what} is a data folder")
        from semmap.nodes.extern.replay import replay as run_again

        longest_s, speed = options.pop("longest"), options.pop("speed")
        run_again(
            what.resolve(),
            speed=1.0 if speed is None else speed,
            longest_s=playback_clock.LONGEST_S if longest_s is None else longest_s,
            sim=not options.pop("no_sim"),
            record=not options.pop("no_record"),
            say=print_escaped,
            **options,
        )
        return
    if passed := [
        f"--{name.replace('_', '-')}" for name, value in options.items() if value not in (None, False)
    ]:
        raise errors.BadRequest(f"{passed[0]} requires a data folder; {what} is not a folder")
    if check:
        from semmap.nodes.extern.replay import check as verify

        print_escaped(
            verify(what, data, where=where, identity=identity, namespace=namespace, tell=print_error)
        )
        return
    if data is not None:
        raise errors.BadRequest("--data requires --check")
    extras.require("semmap replay", "record")
    from semmap.nodes.recorder.replay import replay as open_viewer

    open_viewer(what, print_error)
