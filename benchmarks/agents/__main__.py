"""`python -m benchmarks.agents [--json FILE]`: seventy tasks with tools, or `list --format json` only."""

from __future__ import annotations

import argparse
import asyncio
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.agents.agent import Agent, talking
from benchmarks.agents.tasks import TASKS, Kind, Task, prepare
from benchmarks.table import Row, as_json, lines
from semmap import Client
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import codec
from semmap.testing import own_system

_WORDS = ("--allow", "change", "--classes", "Cup,Book,Door", "--rate", "600", "--agent", "benchmark")
_BY_LIST: dict[Kind, str] = {"find": "1", "count": "1", "compare": "1", "when": "one a commit"}
"""Tasks that can be done with `list`."""


class Done(NamedTuple):
    """The result of one task. `fault` is empty if it is correct."""

    task: Task
    calls: int
    characters: int
    fault: str


async def done(task: Task, agent: Agent, client: Client) -> Done:
    """Do a task and compare the result with the map."""
    agent.begin()
    try:
        found = await task.way(agent)
        true = task.truth(client)
        fault = "" if found == true else f"found {found!r}, but it is {true!r}"
    except Exception as error:  # a failure must not prevent the other tasks
        fault = f"{type(error).__name__}: {error}"
    return Done(task, agent.calls, agent.characters, fault)


async def all_done(client: Client, endpoint: str) -> list[Done]:
    """Do all tasks in order."""
    async with talking(endpoint, *_WORDS) as agent:
        return [await done(task, agent, client) for task in TASKS]


def rows(found: Sequence[Done], listed: int, commits: int) -> list[Row]:
    """Return the number of correct tasks and their cost; `listed` is the size of all entities as JSON."""
    made = [Row("tasks done right", sum(not d.fault for d in found) / len(found), "", 1.0, more=True)]
    for kind in dict.fromkeys(d.task.kind for d in found):
        of = [d for d in found if d.task.kind == kind]
        calls, characters = (sum(getattr(d, what) for d in of) / len(of) for what in ("calls", "characters"))
        made.append(Row(f"{kind}: {len(of)} tasks, calls each", calls, ""))
        made.append(Row(f"{kind}: characters to read each", characters, ""))
        if kind in _BY_LIST:
            by_list = listed * (commits if kind == "when" else 1)
            made.append(
                Row(f"{kind}: characters by `list --format json` ({_BY_LIST[kind]} call)", by_list, "")
            )
    return made


def measured() -> tuple[list[Done], list[Row]]:
    """Run all tasks on a separate system with the flat and a short history."""
    endpoint = free_endpoint()
    with (
        tempfile.TemporaryDirectory() as folder,
        own_system(Path(folder), "--no-sim", "--no-record", endpoint=endpoint) as client,
    ):
        prepare(client)
        listed, commits = len(codec.encode_json(client.list())), client.status().commit
        found = asyncio.run(all_done(client, endpoint))
    return found, rows(found, listed, commits)


def main() -> None:
    """Print the table and the faults."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the figures to this file")
    said = parser.parse_args()
    found, table = measured()
    print(lines(table))
    for one in found:
        if one.fault:
            print(f"wrong: {one.task.kind}: {one.task.wanted}: {one.fault}")
    if said.json:
        tasks: list[dict[str, Any]] = [
            {"kind": d.task.kind, "task": d.task.wanted, "calls": d.calls, "characters": d.characters,
             "right": not d.fault}
            for d in found
        ]  # fmt: skip
        said.json.write_text(json.dumps({"rows": [as_json(row) for row in table], "tasks": tasks}, indent=2))


if __name__ == "__main__":
    main()
