"""Entities, facts, commits and the overview of a map as short JSON objects."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

import msgspec

from semmap.nodes.extern.cli.output.sparql_formats import format_term
from semmap.nodes.extern.mcp.answers import (
    attribute_text,
    format_author,
    format_time,
    pose_fields,
    round_metres,
)
from semmap.nodes.extern.mcp.hints import translate_hints
from semmap.ontology import vocabulary as v
from semmap.schemas import changes
from semmap.schemas.entities import Entity
from semmap.schemas.episodes import Episode, PastAnswer
from semmap.schemas.explanations import Term
from semmap.schemas.language import Candidate, Understood
from semmap.schemas.map_history import Difference
from semmap.schemas.relations import Described, Relation
from semmap.schemas.replies import LoggedCommit, SystemStatus
from semmap.schemas.sparql import Row

PLACED: Final = {"isOn": "on", "isInside": "inside", "isLocatedIn": "in"}
"""The location relations, and their field names in a row."""
_FEW_NAMES: Final = 10
_FEW_EPISODES: Final = 10
OVERVIEW_BUDGET: Final = 1800
"""The maximum length of the overview, so that the whole reply stays below 2 000 characters."""
_LONGEST_REFERENCE: Final = 40


def entity(found: Entity, where: Mapping[str, list[str]]) -> dict[str, Any]:
    """Return an entity as a row of a list. `where` has what it is on, inside and in."""
    return {
        "name": found.name,
        "class": found.class_,
        **pose_fields(found.pose),
        **where,
        **called(found),
        **({} if found.in_space else {"in_space": False}),
    }


def called(found: Entity) -> dict[str, Any]:
    """Return the label with its author, if there is one."""
    if not found.preferred_reference:
        return {}
    return attribute_text(found.preferred_reference, found.reference_provenance)


def described(found: Described) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the main data of an entity, and its other facts as items."""
    head: dict[str, Any] = {"name": found.name, "class": found.class_, **pose_fields(found.pose)}
    if found.live is not None:  # the pose is the last committed one
        is_stale = {"stale": True} if found.live.stale else {}
        head["live"] = {**pose_fields(found.live.pose), "age_s": round(found.live.age_s, 1), **is_stale}
    if found.size_m is not None:
        head["size"] = round_metres(found.size_m)
    if found.body is not None and found.body.status not in ("present", "none", "unknown"):
        head["body"] = found.body.status
    head |= {kind: True for kind in ("place", "fixed") if getattr(found, kind)}
    if not found.in_space:
        head["in_space"] = False
    head["changed"] = {
        "commit": found.provenance.commit,
        "by": format_author(found.provenance.source, found.provenance.agent),
        "when": format_time(found.provenance.stamp_ns),
    }
    return head, list(_facts(found))


def _facts(found: Described) -> Iterator[dict[str, Any]]:
    for relation in found.whereabouts:
        yield {"where": relation.text}
    for relation in found.denied:
        yield {"not_so": relation.text}
    for text in found.withheld:
        yield {"withheld": translate_hints(text)}
    if found.on_nothing:
        yield {"where": found.on_nothing}
    for types in _by_tens(found.types):
        yield {"types": types}
    by = found.reference_provenance
    for reference in (found.preferred_reference, *found.alternative_references):
        if reference:
            yield {"called": attribute_text(reference, by)}
    for name, stated in found.properties.items():
        values = stated if isinstance(stated, tuple) else (stated,)
        yield {"property": name, "said": [changes.value_in_words(value) for value in values]}
    for name, referring in found.referred_by.items():
        yield from ({"referred_by": names, "property": name} for names in _by_tens(referring))
    if found.conflict:
        yield {"conflict": attribute_text(found.conflict, "perception")}


def _by_tens(names: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    for start in range(0, len(names), _FEW_NAMES):
        yield names[start : start + _FEW_NAMES]


def candidate(found: Candidate, by: str) -> dict[str, Any]:
    """Return an entity that matches a description; its label and reasons quote the authors `by`."""
    quoted = {"called": found.called, "reasons": found.reasons}
    return {"name": found.entity, "class": found.class_, "said": quoted, "by": by}


def understood(found: Understood, by: Callable[..., str]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the head and the steps of a command. `by` returns the authors that texts quote."""
    head: dict[str, Any] = {"language": found.language, "mood": found.mood}
    if found.doubts:
        head["doubts"] = [attribute_text(text, by(text)) for text in found.doubts]
    if found.unknown:
        head["unknown_verbs"] = list(found.unknown)
    if found.question:
        head["question_to_ask_back"] = attribute_text(found.question, by(found.question))
    if found.answer:
        head["answer"] = attribute_text(found.answer, by(found.answer))
    if found.past:
        head["past"] = [_past_answer(one) for one in found.past]
    return head, [msgspec.to_builtins(step) for step in found.steps]


def _past_answer(found: PastAnswer) -> dict[str, Any]:
    """Return an answer about the past with the times of its evidence; its text is in the head."""
    made: dict[str, Any] = msgspec.to_builtins(found)
    del made["text"]
    if found.times_ns:
        made["times"] = [format_time(ns) for ns in made.pop("times_ns")]
    evidence = [_episode(episode) for episode in found.evidence[:_FEW_EPISODES]]
    rest = len(found.evidence) - len(evidence)
    return {**made, "evidence": evidence, **({"more_evidence": rest} if rest else {})}


def _episode(found: Episode) -> dict[str, Any]:
    """Return an event or a time in which something was so, which may quote a text of its author."""
    return {
        "subject": found.subject,
        "said": found.what,
        "from": format_time(found.since_ns),
        **({"to": format_time(found.until_ns)} if found.until_ns is not None else {}),
        **({"commits": [seq for seq in (found.since, found.until) if seq]} if found.since else {}),
        **({"by": found.by} if found.by else {}),
    }


def relation(found: Relation) -> dict[str, Any]:
    """Return a computed relation."""
    row: dict[str, Any] = {"relation": found.relation, "other": found.object, "fact": found.text}
    if found.and_object is not None:
        row["and"] = found.and_object
    return row if found.holds else {**row, "holds": False}


def commit(found: LoggedCommit) -> dict[str, Any]:
    """Return a commit of the history; its reason and changes are texts of its author."""
    by_name: dict[str, list[changes.Change]] = {}
    for change in found.changes:
        by_name.setdefault(change.name, []).append(change)
    shown = [f"{name}: {changes.in_words(of)}" for name, of in list(by_name.items())[:_FEW_NAMES]]
    touched = [*found.changed, *found.removed]
    rest = len(touched) - len(shown)
    return {
        "commit": found.seq,
        "when": format_time(found.stamp_ns),
        "by": format_author(found.source, found.agent),
        **({"verb": found.verb} if found.verb else {}),
        **({"undoes": found.undoes} if found.undoes else {}),
        "said": {"reason": found.reason, "changes": shown},
        **({"and_others": rest} if rest > 0 else {}),
    }


def difference(found: Difference) -> Iterator[dict[str, Any]]:
    """Yield the changed entities: their asserted changes, and their computed relations."""
    names = dict.fromkeys([*(c.name for c in found.changes), *(r.subject for r in found.relations)])
    for name in sorted(names):
        of = [change for change in found.changes if change.name == name]
        measured = [relation.text for relation in found.relations if relation.subject == name]
        yield {
            "name": name,
            **({"said": changes.in_words(of)} if of else {}),
            **({"facts": measured} if measured else {}),
        }


def solution(row: Row) -> list[Any]:
    """Return a row of a query result: prefixed IRIs, numbers, truth values, and texts in `said`."""
    return [_value(term) for term in row]


def _value(term: Term | None) -> Any:
    if term is None:
        return None
    if not term.startswith('"'):
        return format_term(term)
    kind, lexical = v.local_name(v.datatype_of(term)), v.lexical(term)
    if kind == "boolean":
        return lexical in ("true", "1")
    if kind in ("float", "double", "decimal", "integer", "int", "long", "nonNegativeInteger"):
        return _number(lexical)
    return {"said": lexical}


def _number(lexical: str) -> Any:
    for read in (int, float):
        try:
            number = read(lexical)
        except ValueError:
            continue
        return number if abs(number) < float("inf") else {"said": lexical}
    return {"said": lexical}


def places_of(rows: Iterable[Row]) -> dict[str, dict[str, list[str]]]:
    """Group rows (entity, relation, other) by entity: what it is `on`, `inside` and `in`, sorted by name."""
    found: dict[str, dict[str, list[str]]] = {}
    for subject, predicate, other in sorted((s or "", p or "", o or "") for s, p, o in rows):
        kind = PLACED.get(v.local_name(predicate))
        if kind is not None and other:
            found.setdefault(v.entity_name(subject), {}).setdefault(kind, []).append(v.entity_name(other))
    return found


def overview(
    status: SystemStatus, entities: Sequence[Entity], contents: Mapping[str, Sequence[Entity]]
) -> dict[str, Any]:
    """Return the places with their contents, the other entities, and problems. `contents` is by place.

    An object in several places is counted in each, as `list` does. If the overview is too long, the rarest
    classes and the places with the fewest objects are left out.
    """
    places = {e.name: e for e in entities if e.place}
    things = [e for e in entities if not e.place]
    held = {name: Counter(e.class_ for e in contents.get(name, ()) if not e.place) for name in places}
    inside = {thing.name for found in contents.values() for thing in found}
    elsewhere = Counter(thing.class_ for thing in things if thing.name not in inside)
    fullest = sorted(held, key=lambda name: (-held[name].total(), name))
    for classes, most in ((12, 40), (8, 20), (5, 14), (3, 10), (2, 6), (1, 4), (0, 3)):
        shown = {
            "entities": len(entities),
            "things": len(things),
            "places": [_place(places[name], held[name], classes) for name in fullest[:most]],
            **({"more_places": len(fullest) - most} if len(fullest) > most else {}),
            **({"elsewhere": _counts(elsewhere, classes)} if elsewhere else {}),
            **({"problems": [text[:120] for text in status.problems[:3]]} if status.problems else {}),
            "further": "list in=PLACE (with its parts, as holds) or class=CLASS, get name=NAME",
        }
        if len(json.dumps(shown, ensure_ascii=False, separators=(",", ":"))) <= OVERVIEW_BUDGET:
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
