"""Third-party worlds: imports every MJCF file below a folder, and reports its bodies."""

from __future__ import annotations

import math
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import mujoco

from benchmarks.table import Row
from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.sim_node.physics.base_scene import read_mjcf
from semmap.schemas import errors, keys
from semmap.schemas.scenes import Scene, SceneQuery

_PATIENCE_S = 60.0
_CALM_S = 2.0


class Outcome(NamedTuple):
    """The import result of one world."""

    bodies: int
    entities: int
    named: int
    """The number of bodies that did not become entities and are reported."""
    lost: tuple[str, ...]


def measure(folder: Path) -> list[Row]:
    """Return a row for each MJCF file with bodies; files that fail to load are reported and not counted.

    Raises BadFile if there is no such file in the folder.
    """
    rows, lost, worlds = [], 0, 0
    stuck: list[str] = []
    for path in sorted(folder.rglob("*.xml")):
        if not is_scene(path):
            continue
        where = path.relative_to(folder)
        try:
            names = _bodies(path)
        except errors.BadFile as error:
            print(f"{where}: not counted: {error}")
            continue
        if not names:
            print(f"{where}: not counted: it has no bodies")
            continue
        try:
            outcome = _try_out_twice(path, names)
        except RuntimeError as error:
            print(f"{where}: not measured: {' '.join(str(error).split())}", flush=True)
            stuck.append(str(where))
            continue
        worlds, lost = worlds + 1, lost + len(outcome.lost)
        told = f"{outcome.entities} entities, {outcome.named} named as left out"
        print(
            f"{where}: {outcome.bodies} bodies: {told}; lost: {', '.join(outcome.lost) or 'none'}", flush=True
        )
        rows.append(Row(f"{path.name}: bodies neither entity nor named", float(len(outcome.lost)), "", 0.0))
    if stuck:
        rows.append(Row(f"worlds with which no system started: {', '.join(stuck)}", float(len(stuck)), ""))
    if not worlds:
        raise errors.BadFile(f"{folder} contains no MJCF file with bodies")
    return [
        *rows,
        Row(f"{worlds} worlds: bodies neither entity nor named as left out", float(lost), "", 0.0, 0.0),
    ]


def is_scene(path: Path) -> bool:
    """Return whether a file is MJCF by its root element, and not included by others."""
    try:
        root = next(ElementTree.iterparse(path, ("start",)))[1]
    except (ElementTree.ParseError, OSError):
        return False
    return str(root.tag) == "mujoco"


def _bodies(path: Path) -> list[str]:
    """Return the names of the bodies in a file, "" for unnamed ones. Raises BadFile."""
    model: mujoco.MjModel = read_mjcf(path).compile()
    return [model.body(number).name for number in range(1, model.nbody)]


def _try_out_twice(path: Path, names: list[str]) -> Outcome:
    """Call `try_out`, and retry a failed start on a busy machine. Raises RuntimeError."""
    try:
        return try_out(path, names)
    except RuntimeError:
        return try_out(path, names)


def try_out(path: Path, names: list[str]) -> Outcome:
    """Start with this world, and compare map and `semmap status` with the names of its bodies.

    An unnamed body is accounted for by a generated name or by a description in the status.
    """
    words = ("--world", str(path), "--truth", "scene", "--no-record")
    with tempfile.TemporaryDirectory() as folder, own_system(Path(folder) / "data", *words) as client:
        entities, scene = _settled(client)
        problems = client.status().problems
    entities = {body.body or body.name for body in scene.bodies if body.name in entities}
    told = list(scene.left_out)  # of which the status lists the first and counts the others
    told += [b.name for b in scene.bodies if any(problem.startswith(f"{b.name}: ") for problem in problems)]
    named = entities | set(told)
    lost = [name for name in names if name and name not in named]
    nameless = [name for name in (*entities, *told) if name not in names]
    lost += ["(without a name)"] * (names.count("") - len(nameless))
    return Outcome(len(names), len(entities), len(names) - len(entities) - len(lost), tuple(lost))


def _settled(client: Client) -> tuple[set[str], Scene]:
    """Return the names of the entities when they are complete, and the scene."""
    deadline, since = time.monotonic() + _PATIENCE_S, math.inf
    before: set[str] = set()
    while time.monotonic() < min(deadline, since + _CALM_S):
        time.sleep(0.2)
        names = {entity.name for entity in client.list()}
        if client.status().in_agreement is not None and (names != before or since == math.inf):
            before, since = names, time.monotonic()
    return before, bus.ask(client.session, keys.SIM, SceneQuery.VERB, SceneQuery(), Scene)
