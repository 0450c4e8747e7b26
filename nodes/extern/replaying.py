"""The past of a map, run again from its journal as a system of its own beside the one that may run."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from msgspec import structs

from semmap.nodes.extern.journals import journal_copy, own_folder
from semmap.nodes.runtime import extras, rhythm
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
    longest_s: float = rhythm.LONGEST_S,
    listen: str | None = None,
    world: str | Path | None = None,
    sim: bool = True,
    record: bool = True,
    web: int | None = None,
    say: Callable[[str], None] = print,
) -> None:
    """Run the map of the data folder `data` again, from one commit or time to another, until Ctrl-C.

    It has a knowledge base, a simulator and a recorder of its own, in a folder that is deleted at the end;
    `data` is only read, also while its own system runs. Commits come with the waits that were between them,
    divided by `speed`, and none longer than `longest_s` [s]. `world` is the scene file, by default the map's.
    `web` is the port of a page that shows it: 0 is any that is free, None no page.

    Raises BadFile when there is no map, Refused when it is damaged or the span is not in its history,
    BadRequest for a span or speed that is none; and what `semmap up` raises.
    """
    data, world = Path(data).resolve(), None if world is None else Path(world)
    rhythm.require_speed(speed)
    rhythm.require_longest(longest_s)
    extras.require(
        "semmap replay",
        "kb",
        *(["sim"] if sim else []),
        *(["record"] if record else []),
        *([] if web is None else ["web"]),
    )
    from semmap.nodes.kb_node.storage.replay.preparation import prepare
    from semmap.nodes.supervisor.up import up

    with own_folder() as folder:
        span = prepare(data, folder, since=since, until=until)
        settings = structs.replace(
            settings_of(data, world),
            data=str(folder),
            listen=listen or _free_endpoint(),
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
    """Compare the commits of a recording with those in the journal of a data folder, or of a running system.

    Returns what was compared, in a sentence; `tell` is told of what cannot be read of the recording. Raises
    Refused with the first difference, or with the commits that the recording lacks; BadFile for no recording
    or no map.
    """
    file, data = Path(file), None if data is None else Path(data)
    extras.require("semmap replay --check", "kb", "record")
    from semmap.nodes.kb_node.storage.journal import Journal
    from semmap.nodes.recorder.checking import check as compare
    from semmap.nodes.recorder.recorded_commits import commits_of
    from semmap.nodes.recorder.whole_part import whole_part

    with whole_part(file) as whole:
        if told := whole.told(file):
            tell(told)
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


def settings_of(data: Path, world: Path | None = None) -> Settings:
    """What a system needs to show the map of a data folder: its world, models and shapes, and nothing else.

    Where reality was perceived, the scene of a world file is not the map's: the floor alone is.
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
        raise errors.BadFile(f"the world {scene} of this map is not there any more; give one with --world")
    return Settings(
        data=str(data),
        tbox=str(HOUSEHOLD_TTL),
        abox=None,
        world=str(scene.resolve()),
        models=None if before is None else before.models,
    )


def _free_endpoint() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"
