"""Run OWL 2 RL conformance cases: `python -m benchmarks.conformance DIR [--json FILE]`.

DIR holds `manifest.json`, a list of `{id, type, premise, conclusion?}` with N-Triples files relative to DIR.
Types are entailment, non-entailment, consistency and inconsistency.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal

import pyoxigraph
from msgspec import Struct
from msgspec.json import decode

from nodes.kb_node.reasoner import Inconsistent, Reasoner
from schemas.explanations import Term, Triple


class Case(Struct, frozen=True):
    """One conformance case; paths are relative to the manifest."""

    id: str
    type: Literal["entailment", "non-entailment", "consistency", "inconsistency"]
    premise: str
    conclusion: str | None = None


class Outcome(Struct, frozen=True):
    """Whether a case passed, and if not what was found instead."""

    id: str
    passed: bool
    why: str


def cases(folder: Path) -> list[Case]:
    """The cases of a folder, in the order of its manifest."""
    return decode((folder / "manifest.json").read_bytes(), type=list[Case])


def run(folder: Path, case: Case) -> Outcome:
    """Run one case."""
    try:
        reasoner = Reasoner(_triples(folder / case.premise))
    except Inconsistent as error:
        return Outcome(case.id, case.type == "inconsistency", error.explanation.text)
    if case.type in ("consistency", "inconsistency"):
        return Outcome(case.id, case.type == "consistency", "no contradiction was found")
    if case.conclusion is None:
        raise ValueError(f"{case.id}: type {case.type} needs a conclusion")
    missing = _missing(reasoner, _triples(folder / case.conclusion))
    why = "the conclusion follows" if missing is None else f"does not follow: {' '.join(missing)}"
    return Outcome(case.id, (missing is None) == (case.type == "entailment"), why)


def _triples(path: Path) -> list[Triple]:
    quads = pyoxigraph.parse(path=str(path), format=pyoxigraph.RdfFormat.N_TRIPLES)
    return [(str(quad.subject), str(quad.predicate), str(quad.object)) for quad in quads]


def _missing(reasoner: Reasoner, wanted: Sequence[Triple]) -> Triple | None:
    """None when the graph follows for some choice of its blank nodes, else a triple beyond reach."""
    deepest = 0

    def search(at: int, chosen: dict[Term, Term]) -> bool:
        nonlocal deepest
        deepest = max(deepest, at)
        return at == len(wanted) or any(
            search(at + 1, extended) for extended in _matches(reasoner, wanted[at], chosen)
        )

    return None if search(0, {}) else wanted[deepest]


def _matches(reasoner: Reasoner, wanted: Triple, chosen: dict[Term, Term]) -> Iterator[dict[Term, Term]]:
    s, p, o = (None if _is_open(term, chosen) else chosen.get(term, term) for term in wanted)
    if s is not None and p is not None and o is not None:
        if reasoner.holds((s, p, o)):
            yield chosen
        return
    for candidates in (reasoner.asserted(s, p, o), reasoner.inferred(s, p, o)):
        for triple in candidates:
            extended = dict(chosen)
            open_terms = ((w, t) for w, t in zip(wanted, triple, strict=True) if _is_open(w, chosen))
            if all(extended.setdefault(word, term) == term for word, term in open_terms):
                yield extended


def _is_open(term: Term, chosen: dict[Term, Term]) -> bool:
    return term.startswith("_:") and term not in chosen


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
