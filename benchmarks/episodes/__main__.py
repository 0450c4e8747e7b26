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

from benchmarks.episodes.day import ACTORS, Day, Record
from benchmarks.episodes.questions import Asker, Question
from benchmarks.table import Row, as_json, lines
from semmap import Client, connect
from semmap.nodes.extern.testing import free_endpoint
from semmap.schemas import errors
from semmap.testing import own_system

_FOLDER = Path(__file__).parent
_EACH = 20
"""Questions of a kind; every third of them has a blind wording."""
Wordings = Mapping[str, Mapping[str, Sequence[str]]]
_KINDS = (
    "where", "when", "since", "how_long", "how_often", "who", "changed", "missing", "before_after", "never",
)  # fmt: skip


class Asked(NamedTuple):
    """A question that was asked. `fault` is empty if the answer is right."""

    question: Question
    text: str
    is_blind: bool
    answer: str
    fault: str


def load_wordings(name: str) -> Wordings:
    """Return the wordings of a file by kind and form."""
    wordings: Wordings = tomllib.loads((_FOLDER / name).read_text("utf-8"))
    return wordings


def ask(client: Client, question: Question, wording: str, *, is_blind: bool) -> Asked:
    """Ask a question in a wording, and compare the answer with the record."""
    text = wording.format(**question.slots)
    try:
        found = client.understand(text)
    except errors.SemmapError as error:
        return Asked(question, text, is_blind, "", f"{type(error).__name__}: {error}")
    if not found.past:
        return Asked(question, text, is_blind, found.answer, "not read as a question about the past")
    is_negated = " never " in text
    fault = question.expected.fault(found.past[0], time.time_ns(), is_negated=is_negated)
    return Asked(question, text, is_blind, found.answer, fault)


def ask_all(client: Client, record: Record, rng: random.Random) -> list[Asked]:
    """Ask the questions of all kinds."""
    asker = Asker(record, rng)
    own, blind = load_wordings("wordings.toml"), load_wordings("blind_wordings.toml")
    found = []
    for kind in _KINDS:
        for number in range(_EACH):
            is_blind = number % 3 == 2
            wordings = (blind if is_blind else own)[kind]
            pairs = [(form, text) for form, texts in wordings.items() for text in texts]
            form, wording = pairs[(number // 3 if is_blind else number - number // 3) % len(pairs)]
            found.append(ask(client, asker.make(kind, form), wording, is_blind=is_blind))
    return found


def rows(asked: Sequence[Asked]) -> list[Row]:
    """Return the share of right answers by kind and by the author of the wordings."""
    made = [_row("all kinds", asked, 0.95)]
    made.append(_row("wordings written blind", [a for a in asked if a.is_blind], None))
    return made + [_row(kind, [a for a in asked if a.question.kind == kind], None) for kind in _KINDS]


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
        asked = ask_all(client, record, random.Random(given.seed))
    table = rows(asked)
    print(lines(table))
    for one in asked:
        if one.fault:
            blind = " (blind)" if one.is_blind else ""
            print(f"{one.question.kind}{blind}: {one.text}\n    {one.answer[:300]}\n    {one.fault}")
    if given.json:
        given.json.write_text(json.dumps([as_json(row) for row in table], indent=1))


if __name__ == "__main__":
    main()
