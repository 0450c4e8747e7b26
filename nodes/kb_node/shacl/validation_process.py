"""The process that validates a map against shapes of unknown origin, within limits of memory and time.

`ShapeValidator` starts it. Besides a document, a pattern of a shape may take very long to match.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from msgspec import Struct, msgpack

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.inert_statements import count_inert, inert_note
from semmap.nodes.kb_node.reasoner import GivenFacts, Reasoner
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.runtime.isolated_process import IsolatedProcess, program, serve
from semmap.schemas import errors, wording
from semmap.schemas.explanations import Triple

_LABEL: Final = "shape"
"""Prefix of the blank nodes of a document, which differ from those of the TBox."""
_MOST_FAILURES: Final = 5
"""The maximum number of notes on shapes that were not evaluated."""
_LONGEST_NOTE: Final = 1000
LIMIT_S: Final = 60.0
"""Limit of the CPU time of a validation. Any client may request one, and others wait for it."""
MOST_RESULTS: Final = 1000
"""The maximum number of results in a reply."""


class Request(Struct, frozen=True):
    """The facts of a map, with its TBox and the shapes in both, and a document with more shapes."""

    asserted: list[Triple]
    computed: list[Triple]
    content: bytes = b""
    filename: str = ""


class Validation(Struct, frozen=True):
    """The number of shapes with a target, and what violates them."""

    shapes: int = 0
    results: list[Result] = []
    count: int = 0
    """The number of all results; `results` has the first ones."""
    notes: list[str] = []
    is_complete: bool = True
    """Whether all shapes of the map and its TBox were evaluated. `notes` has the reasons if not."""
    error: str = ""


class ShapeValidator(IsolatedProcess):
    """Validates one map at a time. The process starts with the first."""

    remedy = "use fewer or simpler shapes"

    def __init__(self, command: Sequence[str] = program(__name__), *, cpu_s: float = LIMIT_S) -> None:
        """Create it; `command` is the program of the process."""
        super().__init__(command, cpu_s=cpu_s)

    def validate(self, facts: GivenFacts, content: bytes, filename: str) -> Validation:
        """Return the violations of the shapes in the map, its TBox and a document. Any thread may call this.

        Raises BadFile for a document that is not valid, and for shapes that exceed a limit.
        """
        request = Request(list(facts.asserted), list(facts.computed), content, filename)
        reply = self.exchange(msgpack.encode(request), filename or "validation with SHACL")
        validation = msgpack.decode(reply, type=Validation)
        if validation.error:
            raise errors.BadFile(validation.error)
        return validation


def answer(content: bytes) -> bytes:
    """Return the encoded reply to an encoded request."""
    request = msgpack.decode(content, type=Request)
    try:
        return msgpack.encode(validate(request))
    except errors.BadFile as error:
        return msgpack.encode(Validation(error=error.text))


def validate(request: Request) -> Validation:
    """Return the violations of the shapes of a request. Raises BadFile for a document that is not valid."""
    from semmap.nodes.kb_node.shacl.shapes import Shapes  # pySHACL takes half a second to import

    reasoner = Reasoner.of(GivenFacts(request.asserted, request.computed))
    results, notes, failures = list[Result](), list[str](), list[str]()
    count = 0
    try:
        own = Shapes(request.asserted, "the map")
        results += own.validate(reasoner, failed=failures.append)
        count += len(own) - len(failures)
    except errors.BadFile as error:
        failures.append(error.text)
    if request.content:
        name = request.filename or "the file"
        triples = rdf.read(request.content, request.filename, label_prefix=_LABEL).triples
        shapes = Shapes(triples, name)
        if not len(shapes):
            raise errors.BadFile(
                f"{name}: no SHACL shapes with a target; add sh:targetClass or another target"
            )
        results += shapes.validate(reasoner)
        count += len(shapes)
        if unsupported := inert_note(count_inert(triples)):
            notes.append(f"{name}: {unsupported}")
    notes += [not_evaluated(text) for text in failures[:_MOST_FAILURES]]
    if (more := len(failures) - _MOST_FAILURES) > 0:
        notes.append(not_evaluated(f"{more} more"))
    if len(results) > MOST_RESULTS:
        total = wording.counted(len(results), "violation")
        notes.append(f"the first {MOST_RESULTS} of {total} are listed; use fewer shapes to list others")
    return Validation(
        shapes=count,
        results=results[:MOST_RESULTS],
        count=len(results),
        notes=notes,
        is_complete=not failures,
    )


def not_evaluated(reason: str) -> str:
    """Return a note on shapes that were not evaluated."""
    return errors.shortened(f"shapes not evaluated: {reason}", _LONGEST_NOTE)


if __name__ == "__main__":
    serve(answer)
