"""The verb `replay`: a recording in its viewer, or a map's past run again; and `--check` of a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from nodes.extern.cli.calling import TIME, connect_option, identity_option, namespace_option
from nodes.extern.cli.output.printable import say
from nodes.runtime import extras, rhythm
from schemas import errors

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
    help=f"Wait no longer than S seconds for a commit.  [default: {rhythm.LONGEST_S:g}]",
)
@click.option("--listen", metavar="EP", help="Zenoh endpoint of the replay. Default: a free port.")
@click.option("--world", type=_path, help="Scene file. Default: the one that the map was last run with.")
@click.option("--no-sim", is_flag=True, help="Replay the map without a scene.")
@click.option("--no-record", is_flag=True, help="Do not record the replay.")
def replay(what: Path, **options: Any) -> None:
    """Open a recording in the Rerun viewer, or run the past of a map again.

    A recording is a file (.rrd). Of a data folder the journal is run again, map
    and scene, as a system of its own on its own endpoint, with the waits that were
    between its commits. The map itself is only read, and may be in use meanwhile.
    """
    if what.is_dir():
        from nodes.extern.replaying import replay as run_again

        longest_s, speed = options.pop("longest"), options.pop("speed")
        run_again(
            what.resolve(),
            speed=1.0 if speed is None else speed,
            longest_s=rhythm.LONGEST_S if longest_s is None else longest_s,
            sim=not options.pop("no_sim"),
            record=not options.pop("no_record"),
            say=say,
            **options,
        )
        return
    if given := [f"--{name.replace('_', '-')}" for name, value in options.items() if value]:
        raise errors.BadRequest(f"{given[0]} is for a data folder, and {what} is not one")
    extras.require("semmap replay", "record")
    from nodes.recorder.replay import replay as open_viewer

    open_viewer(what)
