"""The verb `replay`: a recording in its viewer, or a map's past run again; and `--check` of a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from semmap.nodes.extern.cli.calling import TIME, complain, connect_option, identity_option, namespace_option
from semmap.nodes.extern.cli.output.printable import say
from semmap.nodes.runtime import extras, playback_clock
from semmap.schemas import errors

_path = click.Path(path_type=Path)


@click.command()
@click.argument("what", metavar="FILE.rrd|DATA_DIR", type=_path)
@click.option("--since", metavar="COMMIT|TIME", help="Begin with the map as it was then. Default: the first.")
@click.option("--until", metavar="COMMIT|TIME", help=f"End with the map as it was then. Default: now. {TIME}")
@click.option("--speed", type=float, default=None, metavar="X", help="So many times as fast.  [default: 1]")
@click.option(
    "--longest",
    type=float,
    default=None,
    metavar="S",
    help=f"Wait no longer than S seconds for a commit.  [default: {playback_clock.LONGEST_S:g}]",
)
@click.option("--listen", metavar="EP", help="Zenoh endpoint of the replay. Default: a free port.")
@click.option("--world", type=_path, help="Scene file. Default: the one that the map was last run with.")
@click.option("--no-sim", is_flag=True, help="Replay the map without a scene.")
@click.option("--no-record", is_flag=True, help="Do not record the replay.")
@click.option(
    "--web",
    type=click.IntRange(0, 65_535),
    is_flag=False,
    flag_value=0,
    metavar="[PORT]",
    help="Show the replay in the page, too. Default: a free port.",
)
@click.option("--check", is_flag=True, help="Of a recording: verify that its commits are those of the map.")
@click.option("--data", type=_path, help="With --check: the map's data folder. Default: a running system.")
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
    """Open a recording, or run the past of a map again.

    A recording (.rrd) is opened in the Rerun viewer. Of a data folder the journal is run again, map
    and scene, as a system of its own on its own endpoint, with the waits that were
    between its commits. The map itself is only read, and may be in use meanwhile.

    With --check the recorded commits are compared with those in the journal of
    --data, or of the system at --connect. The first difference is named, or the
    commits that the recording lacks; the exit status is 1 then.
    """
    if what.is_dir():
        if check:
            raise errors.BadRequest("--check is for a recording (.rrd); a replay is of the journal itself")
        from semmap.nodes.extern.replaying import replay as run_again

        longest_s, speed = options.pop("longest"), options.pop("speed")
        run_again(
            what.resolve(),
            speed=1.0 if speed is None else speed,
            longest_s=playback_clock.LONGEST_S if longest_s is None else longest_s,
            sim=not options.pop("no_sim"),
            record=not options.pop("no_record"),
            say=say,
            **options,
        )
        return
    if given := [
        f"--{name.replace('_', '-')}" for name, value in options.items() if value not in (None, False)
    ]:
        raise errors.BadRequest(f"{given[0]} is for a data folder, and {what} is not one")
    if check:
        from semmap.nodes.extern.replaying import check as verify

        say(verify(what, data, where=where, identity=identity, namespace=namespace, tell=complain))
        return
    if data is not None:
        raise errors.BadRequest("--data is for --check")
    extras.require("semmap replay", "record")
    from semmap.nodes.recorder.replay import replay as open_viewer

    open_viewer(what, complain)
