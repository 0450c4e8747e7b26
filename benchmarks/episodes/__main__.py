"""`python -m benchmarks.episodes [--changes N] [--json FILE]`: 200 questions about a simulated day."""

from __future__ import annotations

import argparse
import json
import random
import tempfile
import time
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from benchmarks.episodes import blind as blind_wordings
from benchmarks.episodes.blind import BlindAsker
from benchmarks.episodes.day import ACTORS, Day, Record
from benchmarks.episodes.questions import Expected
from benchmarks.table import Row, as_json, lines
from semmap import Client, connect
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import errors
from semmap.testing import own_system

_FOLDER = Path(__file__).parent
_EACH = 20
"""Questions of a kind."""
_BLIND = 7
"""Those of them with blind wordings, at least."""
Wordings = Mapping[str, Mapping[str, Sequence[str]]]
_KINDS = (
    "where", "when", "since", "how_long", "how_often", "who", "changed", "missing", "before_after", "never",
)  # fmt: skip


class Asked(NamedTuple):
    """A question that was asked. `fault` is empty if the answer is right."""

    kind: str
    text: str
    is_blind: bool
    answer: str
    fault: str


def load_wordings() -> Wordings:
    """Return our own wordings by kind and form."""
    return tomllib.loads((_FOLDER / "wordings.toml").read_text("utf-8"))


def ask(client: Client, kind: str, text: str, expected: Expected, *, is_blind: bool) -> Asked:
    """Ask a question, and compare the answer with the record."""
    try:
        found = client.understand(text)
    except errors.SemmapError as error:
        return Asked(kind, text, is_blind, "", f"{type(error).__name__}: {error}")
    if not found.past:
        return Asked(kind, text, is_blind, found.answer, "not read as a question about the past")
    fault = expected.fault(found.past[0], time.time_ns(), is_negated=" never " in text)
    return Asked(kind, text, is_blind, found.answer, fault)


def ask_all(client: Client, record: Record, rng: random.Random) -> list[Asked]:
    """Ask the questions of all kinds: a third of each, at least, in blind wordings."""
    asker = BlindAsker(record, rng)
    own, blind = load_wordings(), blind_wordings.load()
    found = []
    for kind in _KINDS:
        others = [wording for wording in blind if wording.kind == kind]
        others = others if len(others) > _BLIND else [others[i % len(others)] for i in range(_BLIND)]
        for wording in others:
            slots, expected = asker.make_blind(wording)
            found.append(ask(client, kind, wording.text.format(**slots), expected, is_blind=True))
        forms = [(form, text) for form, texts in own[kind].items() for text in texts]
        for number in range(_EACH - len(others)):
            form, text = forms[number % len(forms)]
            question = asker.make(kind, form)
            found.append(ask(client, kind, text.format(**question.slots), question.expected, is_blind=False))
    return found


def rows(asked: Sequence[Asked]) -> list[Row]:
    """Return the share of right answers by kind and by the author of the wordings."""
    made = [_row("all kinds", asked, 0.95)]
    made.append(_row("wordings written blind", [a for a in asked if a.is_blind], None))
    return made + [_row(kind, [a for a in asked if a.kind == kind], None) for kind in _KINDS]


def _row(what: str, asked: Sequence[Asked], reach: float | None) -> Row:
    right = sum(not a.fault for a in asked)
    return Row(f"{what}: right of {len(asked)}", right / max(len(asked), 1), "", reach, more=True)


def main() -> None:
    """Let the day happen, ask, and print the table and the errors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--changes", type=int, default=300, help="changes of the day")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="also write the table to this file")
    given = parser.parse_args()
    endpoint = free_endpoint()
    with (
        tempfile.TemporaryDirectory() as folder,
        own_system(Path(folder), "--no-sim", "--no-record", endpoint=endpoint) as client,
        ExitStack() as stack,
    ):
        clients = {
            name: stack.enter_context(connect(endpoint, agent=agent)) for name, agent in ACTORS.items()
        }
        day = Day(clients, random.Random(given.seed))
        day.prepare()
        record = day.run(given.changes)
        with day.going_on():
            asked = ask_all(client, record, random.Random(given.seed))
    table = rows(asked)
    print(lines(table))
    for one in asked:
        if one.fault:
            blind = " (blind)" if one.is_blind else ""
            print(f"{one.kind}{blind}: {one.text}\n    {one.answer[:300]}\n    {one.fault}")
    if given.json:
        given.json.write_text(json.dumps([as_json(row) for row in table], indent=1))


if __name__ == "__main__":
    main()
