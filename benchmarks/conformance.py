"""Run OWL 2 RL conformance cases: `python -m benchmarks.conformance DIR [--json FILE]`.

DIR holds `manifest.json`, a list of `{id, type, premise, conclusion?}` with N-Triples files relative to DIR.
Types are entailment, non-entailment, consistency and inconsistency. What no rule derives is decided by
`nodes/kb_node/reasoner/entailment`: by refutation, for generic individuals, with names for what must exist.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Literal

import pyoxigraph
from msgspec import Struct
from msgspec.json import decode

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner, entails
from semmap.nodes.kb_node.reasoner.entailment import contradictory
from semmap.schemas.explanations import Triple


class Case(Struct, frozen=True):
    """A conformance case; paths are relative to the manifest."""

    id: str
    type: Literal["entailment", "non-entailment", "consistency", "inconsistency"]
    premise: str
    conclusion: str | None = None


class Outcome(Struct, frozen=True):
    """Whether a case passed, or the actual result."""

    id: str
    passed: bool
    why: str


def cases(folder: Path) -> list[Case]:
    """Return the cases of a folder, in the order of its manifest."""
    return decode((folder / "manifest.json").read_bytes(), type=list[Case])


def run(folder: Path, case: Case) -> Outcome:
    """Run one case."""
    try:
        reasoner = Reasoner(_triples(folder / case.premise))
    except Inconsistent as error:
        passed = case.type in ("inconsistency", "entailment")  # from a contradiction everything follows
        return Outcome(case.id, passed, error.explanation.text)
    if case.type in ("consistency", "inconsistency"):
        found = contradictory(reasoner)
        why = "what must exist contradicts the rest" if found else "no contradiction was found"
        return Outcome(case.id, found == (case.type == "inconsistency"), why)
    if case.conclusion is None:
        raise ValueError(f"{case.id}: type {case.type} needs a conclusion")
    follows = entails(reasoner, _triples(folder / case.conclusion))
    why = "the conclusion follows" if follows else "no proof of the conclusion was found"
    return Outcome(case.id, follows == (case.type == "entailment"), why)


def _triples(path: Path) -> list[Triple]:
    quads = pyoxigraph.parse(path=str(path), format=pyoxigraph.RdfFormat.N_TRIPLES)
    return [(str(quad.subject), str(quad.predicate), str(quad.object)) for quad in quads]


def main(folder: Path, json_file: Path | None = None) -> None:
    """Run all cases of a folder, print those that fail, and write the outcomes as JSON."""
    started = time.perf_counter()
    outcomes = [run(folder, case) for case in cases(folder)]
    for outcome in outcomes:
        if not outcome.passed:
            print(f"{outcome.id}: {outcome.why}")
    passed = sum(outcome.passed for outcome in outcomes)
    print(f"{passed} of {len(outcomes)} passed in {time.perf_counter() - started:.1f} s")
    if json_file:
        rows = [{"id": o.id, "passed": o.passed, "why": o.why} for o in outcomes]
        json_file.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    main(arguments.folder, arguments.json)
