"""What whoever runs a system should know of its TBox; it is told once."""

from __future__ import annotations

from collections.abc import Iterable

from nodes.kb_node.documents import ontology_files
from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.reasoner import Reasoner
from schemas.explanations import Triple

_FEW = 5


def notes(tbox: Iterable[Triple], reasoner: Reasoner, classes: ClassTable) -> tuple[str, ...]:
    """One sentence each on what is missing, on what has no effect, and on what makes changes slow."""
    return tuple(
        note
        for note in (_missing(ontology_files.missing_imports(tbox)), _not_in_space(classes), _slow(reasoner))
        if note
    )


def _missing(imports: tuple[str, ...]) -> str:
    if not imports:
        return ""
    few = " and ".join(filter(None, (", ".join(imports[:_FEW]), _more(len(imports) - _FEW))))
    return f"{_count(len(imports), 'import')} not found, and the TBox holds without: {few}"


def _not_in_space(classes: ClassTable) -> str:
    if classes.spatial:
        return ""
    return "no class is known to be of things in space, so nothing of it is an entity with a position"


def _slow(reasoner: Reasoner) -> str:
    if reasoner.is_compiled:
        return ""
    return "not incremental: every change is worked out from nothing"


def _more(count: int) -> str:
    return f"{count} more" if count > 0 else ""


def _count(number: int, what: str) -> str:
    return f"1 {what} was" if number == 1 else f"{number} {what}s were"
