"""Selection of entities by location: on, in, near, within, nearest."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence, Set
from contextlib import suppress
from functools import partial
from itertools import chain
from typing import Final, NamedTuple

from semmap.nodes.kb_node.relations.facts.pair_facts import are_near
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring import places, proximity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.support import find_contents
from semmap.schemas import errors, wording
from semmap.schemas.entities import Entity, Pose, Size
from semmap.schemas.relations import Where, position_in

_POINT: Final[Size] = (1e-6, 1e-6, 1e-6)
"""The size that stands for a position without extent [m]."""
_ARTICLES: Final = frozenset(("the", "a", "an", "il", "lo", "la", "i", "gli", "le", "un", "uno", "una"))


class Targets(NamedTuple):
    """The entity names that each word of a `Where` resolves to. None if the word is missing or a position."""

    on: frozenset[str] | None
    in_: frozenset[str] | None
    near: frozenset[str] | None
    to: frozenset[str] | None


def select_entities(
    space: Space,
    entities: Sequence[Entity],
    where: Where,
    candidates: Iterable[Entity],
    left_out: Set[Fact] = frozenset(),
) -> list[Entity]:
    """Return the entities among `entities` that satisfy `where`, nearest first if that is requested.

    Words are resolved among `candidates`. Facts in `left_out` do not count. Raises UnknownName, BadRequest,
    and Refused if nothing can be on or in the targets.
    """
    require_complete(where)
    targets = resolve_words(where, tuple(candidates))
    require_possible(space, targets, where.within)
    return filter_entities(space, entities, where, targets, left_out)


def require_complete(where: Where) -> None:
    """Raise BadRequest for conditions that need another one."""
    if where.within is not None and where.near is None and where.to is None:
        raise errors.BadRequest("within (--within) requires near (--near NAME)")
    if where.near is not None and where.within is None and position_in(where.near) is not None:
        raise errors.BadRequest(f"--near with a position requires a distance: --near {where.near} --within M")
    if (where.nearest is None) != (where.to is None):
        raise errors.BadRequest("nearest and to (--nearest N, --to NAME) go together: the N nearest to NAME")


def require_possible(space: Space, targets: Targets, within_m: float | None = None) -> None:
    """Raise Refused if nothing can be on, in or near any of the targets."""
    _require_supporting(_find_placed(space, targets.on, "on"))
    _require_containing(space, _find_placed(space, targets.in_, "in"))
    near = _find_placed(space, targets.near, "near")
    if near and within_m is None and all(solid.is_place for solid in near):
        raise errors.Refused(
            f"{_describe_places(near)}: near holds between objects only; use in (--in) for what is in"
            " there, or give a distance (--near PLACE --within M)"
        )


def _find_placed(space: Space, names: Iterable[str] | None, how: str) -> list[Solid]:
    """Return the solids of the targets that have a position, by name. Raises Refused if none has one."""
    if names is None:
        return []
    found = [space.solids[name] for name in sorted(names) if name in space.solids]
    if not found:
        has = "has" if len(unplaced := sorted(names)) == 1 else "have"
        raise errors.Refused(
            f"{wording.few(unplaced, 5)} {has} no position, so what is {how} there is unknown"
        )
    return found


def _require_supporting(solids: Sequence[Solid]) -> None:
    if not solids:
        return
    if all(solid.is_place for solid in solids):
        raise errors.Refused(f"{_describe_places(solids)}: objects are in a place, not on it; use in (--in)")
    if not any(solid.has_parts for solid in solids):
        raise errors.Refused(
            f"the size of {_format_names(solids)} is unknown, so what is on it is unknown; set a size:"
            " semmap update NAME --size X Y Z"
        )


def _require_containing(space: Space, solids: Sequence[Solid]) -> None:
    if not solids or any(solid.hollows or (solid.is_place and solid.is_measured) for solid in solids):
        return
    if any(relation == "isInside" for solid in solids for relation, _, _ in find_contents(space, solid)):
        return  # a fixture is let into it
    if all(solid.is_place for solid in solids):
        raise errors.Refused(
            f"the extent of {_format_names(solids)} is unknown, so what is in there is unknown"
        )
    raise errors.Refused(
        f"nothing can be in {_format_names(solids)}: it has no known hollow and is not a place"
    )


def _format_names(solids: Sequence[Solid]) -> str:
    return wording.few([solid.name for solid in solids], 5)


def _describe_places(solids: Sequence[Solid]) -> str:
    return f"{_format_names(solids)} {'is a place' if len(solids) == 1 else 'are places'}"


def filter_entities(
    space: Space,
    entities: Sequence[Entity],
    where: Where,
    targets: Targets,
    left_out: Set[Fact] = frozenset(),
) -> list[Entity]:
    """Return the entities among `entities` that satisfy `where`. Facts in `left_out` do not count."""
    found = [entity for entity in entities if entity.name in space.solids]
    if targets.on is not None:
        carriers = targets.on
        found = [e for e in found if is_on(space, space.solids[e.name], carriers, left_out)]
    if targets.in_ is not None:
        holders = targets.in_
        found = [e for e in found if is_in(space, space.solids[e.name], holders, left_out)]
    if (others := _find_ends(space, where.near, targets.near)) is not None:
        is_near = _make_distance_test(where.within) if where.within is not None else partial(are_near, space)
        found = [
            e for e in found if any(is_near(space.solids[e.name], o) for o in others if o.name != e.name)
        ]
    if (ends := _find_ends(space, where.to, targets.to)) is not None and where.nearest is not None:
        found = _select_nearest(space, found, ends, where)
    return found


def _find_ends(space: Space, word: str | None, names: Iterable[str] | None) -> list[Solid] | None:
    """Return the solids of the targets by name, or a point if the word is a position."""
    if word is not None and (at := position_in(word)) is not None:
        point = PlacedEntity(name="", iri="", pose=Pose(position_m=at), size_m=_POINT, place=False, model="")
        return [found] if (found := solid_of(point)) is not None else []
    if names is None:
        return None
    return [space.solids[name] for name in sorted(names) if name in space.solids]


def resolve_words(where: Where, candidates: Sequence[Entity]) -> Targets:
    """Return the targets of all words. Raises UnknownName."""
    on, in_, near, to = where.words
    return Targets(
        None if on is None else resolve_word(candidates, on),
        None if in_ is None else resolve_word(candidates, in_),
        *(
            None if word is None or position_in(word) else resolve_word(candidates, word)
            for word in (near, to)
        ),
    )


def resolve_word(candidates: Sequence[Entity], word: str) -> frozenset[str]:
    """Return the entities that a word refers to: by name, else by label, else by class. Raises UnknownName.

    A class in its exact spelling (`Table`) takes precedence over a label (`table`). A leading article is
    ignored unless it is part of a label.
    """
    if any(word == e.name for e in candidates):
        return frozenset((word,))
    if names := [e.name for e in candidates if word in e.other_names]:
        return frozenset(names)
    if names := [e.name for e in candidates if word in e.types]:
        return frozenset(names)
    folded = word.casefold().replace("_", " ")
    for words_of in (
        lambda e: (e.name, *e.other_names),
        lambda e: tuple(filter(None, (e.preferred_reference, *e.alternative_references))),
        lambda e: e.types,
    ):
        names = [
            e.name for e in candidates if any(folded == w.casefold().replace("_", " ") for w in words_of(e))
        ]
        if names:
            return frozenset(names)
    article, _, noun = folded.partition(" ")
    if article in _ARTICLES and noun:
        with suppress(errors.UnknownName):
            return resolve_word(candidates, noun)
    words = ((e.name, *e.other_names, e.preferred_reference or "", e.class_) for e in candidates)
    all_words = sorted(set(chain.from_iterable(words)))
    known = {word.casefold(): word for word in all_words}.values()  # of Table and table, table
    raise errors.UnknownName(
        f"no entity has the name, label or class '{word}'{errors.suggestion(word, known, 'list')}"
    )


def resolve_single(candidates: Sequence[Entity], word: str) -> str:
    """Return the one entity that a word refers to. Raises UnknownName, BadRequest for several."""
    names = sorted(resolve_word(candidates, word))
    if len(names) > 1:
        raise errors.BadRequest(f"'{word}' is ambiguous: {wording.few(names, 5)}; name one of them")
    return names[0]


def find_single(candidates: Sequence[Entity], word: str) -> str | None:
    """Return the one entity that a word refers to, or None for no entity. Raises BadRequest for several."""
    try:
        return resolve_single(candidates, word)
    except errors.UnknownName:
        return None


def is_on(space: Space, solid: Solid, carriers: Set[str], left_out: Set[Fact]) -> bool:
    """Return whether a solid is on a carrier, directly or not: the SPARQL path `(isOn|isInside)*/isOn`."""
    seen, waiting = {solid}, [solid]
    while waiting:
        upper = waiting.pop()
        container, supports, _ = space.spatial_relations(upper)
        if left_out:
            supports = tuple(s for s in supports if (upper.name, "isOn", s[0].name) not in left_out)
            if container is not None and (upper.name, "isInside", container[0].name) in left_out:
                container = None
        if any(support.name in carriers for support, _ in supports):
            return True
        below = [support for support, _ in (*filter(None, (container,)), *supports) if support not in seen]
        waiting += below
        seen.update(below)
    return False


def is_in(space: Space, solid: Solid, holders: Set[str], left_out: Set[Fact]) -> bool:
    """Return whether a solid is in one of these places or, at any depth, inside one of these containers."""
    for name in holders:
        other = space.solids.get(name)
        if other is not None and other.is_place and other is not solid:
            made = places.within(solid, other, space.limits)
            if made is not None and made.holds and (solid.name, "isLocatedIn", name) not in left_out:
                return True
    seen = {solid.name}
    while (container := space.spatial_relations(solid).container) is not None and container[
        0
    ].name not in seen:
        if (solid.name, "isInside", container[0].name) in left_out:
            return False
        solid = container[0]
        if solid.name in holders:
            return True
        seen.add(solid.name)
    return False


def _make_distance_test(metres: float) -> Callable[[Solid, Solid], bool]:
    return lambda solid, other: not solid.is_place and proximity.gap(solid, other) <= metres


def _select_nearest(space: Space, found: list[Entity], targets: list[Solid], where: Where) -> list[Entity]:
    """Return the entities nearest to the targets by the distance of their boxes, without places."""
    to = {target.name for target in targets}
    if not targets:
        raise errors.Refused(f"{where.to} has no position")
    distance: dict[str, float] = {}
    for entity in found:
        solid = space.solids[entity.name]
        if not solid.is_place and entity.name not in to:
            distance[entity.name] = min(proximity.gap(solid, target) for target in targets)
    limit = where.within if where.within is not None else math.inf
    there = [e for e in found if distance.get(e.name, math.inf) <= limit and e.name in distance]
    return sorted(there, key=lambda e: (distance[e.name], e.name))[: where.nearest]
