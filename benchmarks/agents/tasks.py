"""Seventy tasks: the request, the shortest correct sequence of tool calls, and the expected result.

The agent's result is compared with that of a client that uses other commands.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any, Literal, NamedTuple

from benchmarks.agents.agent import Agent
from semmap import Client
from semmap.schemas import errors

Kind = Literal[
    "find", "understand", "count", "compare", "plan", "why", "possible", "when", "change", "refuse", "undo"
]


class Task(NamedTuple):
    """`way(agent)` returns the agent's result; `truth(client)` then returns the expected one."""

    kind: Kind
    wanted: str
    way: Callable[[Agent], Awaitable[Any]]
    truth: Callable[[Client], Any]


def _name(row: Any) -> str:
    return str(row["name"])


# find, count, compare


async def _found(text: str, agent: Agent) -> set[str]:
    return {_name(candidate) for candidate in (await agent("find", text=text))["candidates"]}


def _those(client: Client, class_: str, **where: Any) -> set[str]:
    return {entity.name for entity in client.list(class_, **where)}


def _find(text: str, class_: str, **where: Any) -> Task:
    return Task("find", text, partial(_found, text), lambda client: _those(client, class_, **where))


async def _counted(agent: Agent, **where: Any) -> int:
    return int((await agent("list", **where))["total"])


def _count(wanted: str, **where: Any) -> Task:
    return Task("count", wanted, partial(_counted, **where), lambda c: len(c.list(**where)))


async def _number_of(class_: str, agent: Agent) -> int:
    counted = f"SELECT (COUNT(DISTINCT ?e) AS ?n) {{ ?e a dm:{class_} }}"
    return int((await agent("query", query=counted))["rows"][0][0])


def _number(class_: str) -> Task:
    return Task(
        "count",
        f"how many of {class_}?",
        partial(_number_of, class_),
        lambda client: len(client.list(class_)),
    )


async def _wider(first: str, second: str, agent: Agent) -> str:
    sizes = {name: (await agent("get", name=name))["size"] for name in (first, second)}
    return max(sizes, key=lambda name: sizes[name][0] * sizes[name][1])


def _widest(client: Client, names: tuple[str, str]) -> str:
    def area_m2(name: str) -> float:
        size = client.get(name).size_m
        return 0.0 if size is None else size[0] * size[1]

    return max(names, key=area_m2)


def _compare(first: str, second: str) -> Task:
    return Task(
        "compare",
        f"which takes more room on the floor, {first} or {second}?",
        partial(_wider, first, second),
        lambda client: _widest(client, (first, second)),
    )


async def _nearest(class_: str, to: str, agent: Agent) -> str:
    return _name((await agent("list", class_=class_, nearest=1, to=to))["entities"][0])


def _near(class_: str, to: str) -> Task:
    return Task(
        "compare",
        f"which {class_} is nearest to {to}?",
        partial(_nearest, class_, to),
        lambda client: client.list(class_, nearest=1, to=to)[0].name,
    )


async def _more_of(first: str, second: str, agent: Agent) -> bool:
    counted = "SELECT (COUNT(DISTINCT ?a) AS ?n) (COUNT(DISTINCT ?b) AS ?m)"
    found = await agent("query", query=f"{counted} {{ {{ ?a a dm:{first} }} UNION {{ ?b a dm:{second} }} }}")
    n, m = found["rows"][0]
    return bool(n > m)


def _more(first: str, second: str) -> Task:
    return Task(
        "compare",
        f"are there more of {first} than of {second}?",
        partial(_more_of, first, second),
        lambda client: len(client.list(first)) > len(client.list(second)),
    )


# why, when


async def _because(name: str, predicate: str, value: str, agent: Agent) -> str:
    found = await agent("explain", name=name, predicate=predicate, value=value)
    return str(found["because"]["said"])


def _why(name: str, predicate: str, value: str) -> Task:
    return Task(
        "why",
        f"why {name} {predicate} {value}?",
        partial(_because, name, predicate, value),
        lambda client: client.explain(name, predicate, value).text,
    )


async def _spells(name: str, relation: str, other: str, agent: Agent) -> list[int]:
    found = await agent("when", name=name, relation=relation, other=other)
    return [int(spell["since"]) for spell in found["spells"]]


def _when(name: str, relation: Any, other: str) -> Task:
    return Task(
        "when",
        f"when was {name} {relation} {other}?",
        partial(_spells, name, relation, other),
        lambda client: [spell.since for spell in client.when(name, relation, other).spells],
    )


async def _moved_last(agent: Agent) -> tuple[int, str]:
    (commit,) = (await agent("history", name="cup1", limit=1))["commits"]
    return int(commit["commit"]), str(commit["by"])


def _mover(client: Client) -> tuple[int, str]:
    commit = client.history("cup1", limit=1)[0]
    return commit.seq, f"{commit.source} {commit.agent}".strip()


async def _otherwise(agent: Agent) -> set[str]:
    return {_name(change) for change in (await agent("diff", since=1, until=3))["changes"]}


def _differing(client: Client) -> set[str]:
    found = client.diff(1, 3)
    return {c.name for c in found.changes} | {r.subject for r in found.relations}


async def _was_at(agent: Agent) -> list[float]:
    found: list[float] = (await agent("get", name="cup1", as_of=1))["at"]
    return found


def _stood(client: Client) -> list[float]:
    pose = client.get("cup1", as_of=1).pose
    return [] if pose is None else [round(value, 3) for value in pose.position_m]


# understand, plan, possible


async def _steps(text: str, role: str, agent: Agent) -> tuple[set[str], bool]:
    found = await agent("understand", text=text)
    roles = [step["roles"][role] for step in found["steps"] if role in step["roles"]]
    names = {name for fillers in roles for filler in fillers for name in filler.get("entities", ())}
    return names, bool(found.get("doubts"))


def _understand(text: str, role: str, holds: Callable[[Client], set[str]], *, doubted: bool = False) -> Task:
    return Task("understand", text, partial(_steps, text, role), lambda client: (holds(client), doubted))


async def _ends(first: str, last: str, agent: Agent) -> bool:
    """Return whether a path begins in the place of the first and ends in the place of the last."""
    found = await agent("route", from_=first, to=last)
    ends = (found["places"][0], found["places"][-1])
    within = [{_name(row) for row in (await agent("list", in_=place))["entities"]} for place in ends]
    return found["metres"] > 0 and first in within[0] and last in within[1]


def _plan(first: str, last: str) -> Task:
    wanted = f"how does a robot get from {first} to {last}?"
    return Task("plan", wanted, partial(_ends, first, last), lambda client: True)


async def _could(name: str, predicate: str, value: str, agent: Agent) -> bool:
    return bool((await agent("could", name=name, predicate=predicate, value=value))["possible"])


def _is_consistent(client: Client, name: str, predicate: str, value: str) -> bool:
    """Return whether nothing explains why a statement cannot hold."""
    try:
        client.explain(name, predicate, value, negated=True)
    except errors.Refused:
        return True
    return False


def _possible(name: str, predicate: str, value: str) -> Task:
    wanted = f"could {name} {predicate} {value}?"
    statement = (name, predicate, value)
    return Task(
        "possible", wanted, partial(_could, *statement), lambda client: _is_consistent(client, *statement)
    )


# change, refuse, undo


async def _changes(fields: dict[str, Any], agent: Agent) -> bool:
    return bool((await agent.committed(**fields))["done"])


def _change(wanted: str, holds: Callable[[Client], bool], **fields: Any) -> Task:
    return Task("change", wanted, partial(_changes, {**fields, "reason": wanted}), holds)


async def _refusal(sentence: str, tool: str, fields: dict[str, Any], agent: Agent) -> bool:
    return sentence in await agent.refused(tool, **fields)


def _refuse(wanted: str, sentence: str, tool: str = "propose", **fields: Any) -> Task:
    if tool == "propose":
        fields["reason"] = wanted
    return Task("refuse", wanted, partial(_refusal, sentence, tool, fields), lambda client: True)


async def _impossible(agent: Agent) -> bool:
    fields = {"verb": "set", "name": "door1", "property": "hasReference", "values": ["door1"]}
    found = await agent("propose", **fields, reason="a name for itself")
    return not found["possible"] and bool(found["against"]["said"])


async def _twice(agent: Agent) -> bool:
    token = (await agent("propose", verb="add", class_="Cup", at=_TABLE, reason="seen"))["token"]
    first = await agent("commit", token=token)
    again = await agent("commit", token=token)
    return "was committed before" in again.pop("note") and again == first


async def _back(fields: dict[str, Any], agent: Agent) -> bool:
    done = await agent.committed(**fields, reason="to be undone")
    return bool((await agent("undo", commit=done["commit"]))["undone"] == done["commit"])


def _undo(wanted: str, holds: Callable[[Client], bool], **fields: Any) -> Task:
    return Task("undo", wanted, partial(_back, fields), holds)


def _stands(name: str, other: str) -> Callable[[Client], bool]:
    return lambda client: name in {entity.name for entity in client.list(on=other)}


def _is(name: str, property_: str, value: Any) -> Callable[[Client], bool]:
    return lambda client: client.get(name).properties.get(property_) == value


_TABLE = [8.2, 2.2, 0.74]
_DESK = [8.4, 7.5, 0.74]


def prepare(client: Client) -> None:
    """Make commits 2 to 5, a short history."""
    client.update("cup1", at=(8.2, 2.2, 0.74), reason="to the table")
    client.update("book1", at=(8.2, 2.1, 0.74), reason="to the table")
    client.update("cup1", at=(9.0, 7.42, 0.74), reason="back to the desk")
    client.set("door1", "isOpen", True, reason="a person came in")


TASKS = (
    _find("the cup on the desk", "Cup", on="desk1"),
    _find("the fridge", "Fridge"),
    _find("la tazza", "Cup"),
    _find("the kettle", "Kettle"),
    _find("the television", "Television"),
    _find("the plates on the dining table", "Plate", on="table1"),
    _find("the bed", "Bed"),
    _find("the laptop", "Laptop"),
    _find("il frigorifero", "Fridge"),
    _understand("take the cup on the desk", "Theme", lambda c: _those(c, "Cup", on="desk1")),
    _understand("bring the milk to the kitchen", "Theme", lambda c: _those(c, "Milk")),
    _understand("metti il libro sul tavolo", "Goal", lambda c: _those(c, "Dining_Table")),
    _understand("take the yellow laptop", "Theme", lambda c: set(), doubted=True),
    *map(_number, ("Chair", "Book", "Door", "Window", "Seat")),
    *(_count(f"how many things in {name}?", in_=name) for name in ("kitchen1", "studio1", "bathroom1")),
    *(_count(f"how many things on {name}?", on=name) for name in ("table1", "desk1")),
    _compare("table1", "desk1"),
    _compare("bed1", "couch1"),
    _compare("fridge1", "wardrobe1"),
    _near("Chair", "fridge1"),
    _near("Door", "bed1"),
    _near("Light_Source", "couch1"),
    _more("Door", "Window"),
    _more("Book", "Cup"),
    _plan("bed1", "fridge1"),
    _plan("desk1", "table1"),
    _plan("bathtub1", "couch1"),
    _possible("cup1", "type", "Table"),
    _possible("cup1", "isOn", "desk1"),
    _possible("kitchen1", "isOn", "table1"),
    _why("cup1", "isLocatedIn", "studio1"),
    _why("cup1", "type", "Dishware"),
    _why("cup1", "type", "Breakable_Thing"),
    _why("apple1", "isInside", "bowl1"),
    _why("plate1", "isOn", "table1"),
    _why("laptop1", "isOn", "desk1"),
    _why("chair1", "type", "Seat"),
    _why("table1", "type", "Furniture"),
    _when("cup1", "isOn", "table1"),
    _when("cup1", "isOn", "desk1"),
    _when("book1", "isLocatedIn", "kitchen1"),
    Task("when", "who moved cup1 last, by which commit?", _moved_last, _mover),
    Task("when", "what is otherwise after commit 3 than after commit 1?", _otherwise, _differing),
    Task("when", "where was cup1 after commit 1?", _was_at, _stood),
    _change("the cup is on the table", _stands("cup1", "table1"), verb="update", name="cup1", at=_TABLE),
    _change("the cup is on the desk", _stands("cup1", "desk1"), verb="update", name="cup1", at=_DESK),
    _change("a book is on the desk", _stands("book9", "desk1"), verb="add", class_="Book", name="book9",
            at=[8.2, 7.5, 0.74]),
    _change("its own book is called a diary", lambda c: c.get("book9").preferred_reference == "diary",
            verb="update", name="book9", ref="diary"),
    _change("the door is shut", _is("door1", "isOpen", False), verb="set", name="door1", property="isOpen",
            values=[False]),
    _change("the door is open", _is("door1", "isOpen", True), verb="set", name="door1", property="isOpen",
            values=[True]),
    _change("unset the door's state", lambda c: "isOpen" not in c.get("door1").properties, verb="unset",
            name="door1", property="isOpen"),
    _change("its own book is gone", lambda c: "book9" not in _those(c, "Book"), verb="remove",
            names=["book9"]),
    _refuse("call the cup an ashtray", "only an operator", verb="update", name="cup1", ref="ashtray"),
    _refuse("throw the cup away", "only an operator", verb="remove", names=["cup1"]),
    _refuse("move a chair", "not of a class", verb="update", name="chair1", at=[7.3, 2.4, 0.0]),
    _refuse("move what is not there", "no entity is named", verb="update", name="ghost1", at=_TABLE),
    _refuse("commit with a guessed token", "unknown token", "commit", token="guessed"),
    Task("refuse", "say of a door that its reference is itself", _impossible, lambda client: True),
    Task("refuse", "commit one token twice", _twice, lambda client: len(client.list("Cup")) == 2),
    _undo("a move is taken back", _stands("cup1", "desk1"), verb="update", name="cup1", at=_TABLE),
    _undo("an entity is taken back", lambda c: "book8" not in _those(c, "Book"), verb="add", class_="Book",
          name="book8", at=_TABLE),
    _undo("a state is taken back", lambda c: "isOpen" not in c.get("door1").properties, verb="set",
          name="door1", property="isOpen", values=[False]),
    Task("undo", "what an operator did stays", partial(_refusal, "only your own", "undo", {"commit": 3}),
         lambda client: True),
)  # fmt: skip
