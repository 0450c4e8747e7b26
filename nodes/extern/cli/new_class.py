"""A new class for a kind of object that the TBox lacks: its name and its declaration. Pure."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import NamedTuple

from semmap.schemas.entities import ClassInfo
from semmap.schemas.errors import BadRequest

ABOVE = "Object"
"""The class above new ones."""


class NewClass(NamedTuple):
    """A class: its name, and its declaration in Turtle."""

    name: str
    turtle: str


def class_name(words: str) -> str:
    """Return `Power_Drill` for the words `power drill`. Raises BadRequest for words that make no name."""
    parts = re.findall(r"[^\W_]+", words)
    name = "_".join(part[0].upper() + part[1:] for part in parts)
    if not re.match(r"[^\W\d]", name):
        raise BadRequest(f"'{words}' cannot be the name of a class; a name begins with a letter")
    return name


def find_class(words: str, classes: Iterable[ClassInfo]) -> str | None:
    """Return the class with this name or label, ignoring case and spaces; None if there is none."""
    wanted = _plain(words)
    for row in classes:
        if wanted in {_plain(word) for word in (row.name, *row.labels.values(), *row.also)}:
            return row.name
    return None


def declare_class(words: str, classes: Iterable[ClassInfo]) -> NewClass:
    """Return a class below `Object` that is called by these words. Raises BadRequest."""
    above = next((row.iri for row in classes if row.name == ABOVE), None)
    if above is None:
        raise BadRequest(
            f"the TBox has no class {ABOVE} to put a new class below; declare '{words}' in a file and add it:"
            " semmap load --tbox --extend FILE"
        )
    name = class_name(words)
    namespace = above.removesuffix(ABOVE)
    label = json.dumps(" ".join(words.split()), ensure_ascii=False)
    return NewClass(
        name,
        f"<{namespace}{name}> a <http://www.w3.org/2002/07/owl#Class> ;\n"
        f"    <http://www.w3.org/2000/01/rdf-schema#subClassOf> <{above}> ;\n"
        f"    <http://www.w3.org/2000/01/rdf-schema#label> {label}@en .\n",
    )


def _plain(words: str) -> str:
    return "".join(c for c in words.casefold() if c.isalnum())
