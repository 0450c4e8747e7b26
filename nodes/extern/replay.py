"""Replay of the history of a map from its journal, in a separate system; and checks of recordings."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from msgspec import structs

from semmap.nodes.extern.journal_copy import journal_copy, private_folder
from semmap.nodes.runtime import extras, playback_clock
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.nodes.supervisor.settings import SETTINGS, Replay, Settings
from semmap.ontology import EMPTY_WORLD, FLAT_WORLD, HOUSEHOLD_TTL
from semmap.schemas import codec, errors
from semmap.schemas.moments import When


def replay(
    data: str | Path,
    *,
    since: When | None = None,
    until: When | None = None,
    speed: float = 1.0,
    longest_s: float = playback_clock.LONGEST_S,
    listen: str | None = None,
    world: str | Path | None = None,
    sim: bool = True,
    record: bool = True,
    web: int | None = None,
    say: Callable[[str], None] = print,
) -> None:
    """Replay the map in the data folder `data`, from one commit or time to another, until Ctrl-C.

    The replay has its own knowledge base, simulator and recorder, in a temporary folder. `data` is only read;
    its system may be running. The intervals between commits are divided by `speed`, and limited to
    `longest_s` [s]. `world` is the scene file; by default it is that of the map. `web` is the port of a page
    that shows the replay; 0 selects a free port, None starts no page.

    Raises BadFile if the folder has no map, Refused if the map is damaged or the period is not in its
    history, BadRequest for an invalid period or speed, and the errors of `semmap up`.
    """
    data, world = Path(data).resolve(), None if world is None else Path(world)
    playback_clock.require_speed(speed)
    playback_clock.require_longest(longest_s)
    extras.require(
        "semmap replay",
        "kb",
        *(["sim"] if sim else []),
        *(["record"] if record else []),
        *([] if web is None else ["web"]),
    )
    from semmap.nodes.kb_node.storage.replay.preparation import prepare
    from semmap.nodes.supervisor.up import up

    with private_folder() as folder:
        span = prepare(data, folder, since=since, until=until)
        settings = structs.replace(
            read_settings(data, world),
            data=str(folder),
            listen=listen or free_endpoint(),
            truth="replayed",
            sim=sim,
            record=record,
            web=web is not None,
            web_port=web or 0,
            replay=Replay(of=str(data), since=span.since, until=span.until, speed=speed, longest_s=longest_s),
        )
        up(settings, say=say)


def check(
    file: str | Path,
    data: str | Path | None = None,
    *,
    where: str | None = None,
    identity: str | None = None,
    namespace: str | None = None,
    tell: Callable[[str], None] = print,
) -> str:
    """Compare the commits of a recording with the journal of a data folder, or of a running system.

    Returns a summary. `tell` receives a note on parts of the recording that cannot be read. Raises Refused
    with the first difference or the missing commits, and BadFile if there is no recording or no map.
    """
    file, data = Path(file), None if data is None else Path(data)
    extras.require("semmap replay --check", "kb", "record")
    from semmap.nodes.kb_node.storage.journal import Journal
    from semmap.nodes.recorder.checking import check as compare
    from semmap.nodes.recorder.intact_part import open_intact_part
    from semmap.nodes.recorder.recorded_commits import commits_of

    with open_intact_part(file) as whole:
        if note := whole.describe(file):
            tell(note)
        recorded = commits_of(whole.path)
    with (
        journal_copy(
            "semmap replay --check", data, where=where, identity=identity, namespace=namespace
        ) as copy,
        closing(Journal(copy.path)) as journal,
    ):
        verdict = compare(recorded, journal.commit, first=journal.first, last=journal.last)
    if not verdict.is_same:
        raise errors.Refused(f"{file} is not a recording of this map: {verdict.text}")
    if not verdict.is_whole:
        raise errors.Refused(f"{file} is not complete: {verdict.text}")
    return f"{file}: {verdict.text}"


def read_settings(data: Path, world: Path | None = None) -> Settings:
    """Return the settings to show the map of a data folder: its world, models and shapes.

    A map with `--truth perceived` is shown in an empty world, because its world file is not its scene.
    """
    try:
        before: Settings | None = codec.decode((data / SETTINGS).read_bytes(), Settings)
    except (OSError, errors.BadRequest):
        before = None
    if world is not None:
        scene = world
    elif before is None:
        scene = FLAT_WORLD
    else:
        scene = EMPTY_WORLD if before.truth == "perceived" else Path(before.world)
    if not scene.exists():
        raise errors.BadFile(f"the world {scene} of this map no longer exists; choose one with --world")
    return Settings(
        data=str(data),
        tbox=str(HOUSEHOLD_TTL),
        abox=None,
        world=str(scene.resolve()),
        models=None if before is None else before.models,
    )
