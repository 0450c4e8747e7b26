"""The overview: the number of entities per class and place, in less than 2 000 characters for any map."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

from semmap.nodes.extern.mcp.answers import attribute_text
from semmap.schemas.entities import Entity
from semmap.schemas.replies import SystemStatus

BUDGET: Final = 1800
"""The maximum length of the overview, so that the whole reply stays below 2 000 characters."""
_LONGEST_REFERENCE: Final = 40


def overview(
    status: SystemStatus, entities: Sequence[Entity], where: Mapping[str, Mapping[str, Sequence[str]]]
) -> dict[str, Any]:
    """Return the places with their contents, the other entities, and problems. `where` has places under `in`.

    An object in several places is counted in the smallest of them. If the overview is too long, the rarest
    classes and the places with the fewest objects are left out.
    """
    places = {e.name: e for e in entities if e.place}
    things = [e for e in entities if not e.place]
    held: dict[str, Counter[str]] = {name: Counter() for name in places}
    elsewhere: Counter[str] = Counter()
    for thing in things:
        inside = [places[name] for name in where.get(thing.name, {}).get("in", ()) if name in places]
        smallest = min(inside, key=_area_m2, default=None)
        (elsewhere if smallest is None else held[smallest.name])[thing.class_] += 1
    fullest = sorted(held, key=lambda name: (-held[name].total(), name))
    for classes, most in ((12, 40), (8, 20), (5, 14), (3, 10), (2, 6), (1, 4), (0, 3)):
        shown = {
            "entities": len(entities),
            "things": len(things),
            "places": [_place(places[name], held[name], classes) for name in fullest[:most]],
            **({"more_places": len(fullest) - most} if len(fullest) > most else {}),
            **({"elsewhere": _counts(elsewhere, classes)} if elsewhere else {}),
            **({"problems": [text[:120] for text in status.problems[:3]]} if status.problems else {}),
            "further": "list in=PLACE or class=CLASS, get name=NAME",
        }
        if len(json.dumps(shown, ensure_ascii=False, separators=(",", ":"))) <= BUDGET:
            break
    return shown


def _place(place: Entity, held: Counter[str], classes: int) -> dict[str, Any]:
    reference = place.preferred_reference or ""
    is_telling = reference.casefold() not in ("", place.class_.casefold().replace("_", " "))
    named = attribute_text(reference[:_LONGEST_REFERENCE], place.reference_provenance) if is_telling else {}
    return {"name": place.name, "class": place.class_, **named, "holds": _counts(held, classes)}


def _counts(held: Counter[str], most: int) -> str:
    """Return the counts as text: `12: 4 Chair, 2 Cup, 6 others`."""
    ranked = sorted(held.items(), key=lambda item: (-item[1], item[0]))
    first = ranked if len(ranked) <= most + 1 else ranked[:most]
    shown = [f"{count} {class_[:40]}" for class_, count in first]
    if rest := held.total() - sum(count for _, count in first):
        shown.append(f"{rest} others")
    return f"{held.total()}: {', '.join(shown)}" if held else "0"


def _area_m2(place: Entity) -> float:
    return float("inf") if place.size_m is None else place.size_m[0] * place.size_m[1]
