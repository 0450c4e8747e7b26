"""Determines which entities match a description."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from semmap.nodes.language.lexicon.describing import Language
from semmap.nodes.language.reference_resolution.description import (
    Affords,
    Among,
    AnyOf,
    Called,
    Description,
    FromViewer,
    Has,
    Not,
    Of,
    OneOf,
    Order,
    Owned,
    Quality,
    Related,
    Restriction,
    Sized,
    State,
    Unknown,
)
from semmap.nodes.language.reference_resolution.map_geometry import MapGeometry
from semmap.nodes.language.reference_resolution.map_index import Item, MapIndex
from semmap.schemas import errors

_ALIKE: Final = 1.25
"""The smallest ratio of sizes at which one object counts as big and another as small."""
_IN_VIEW_RAD: Final = math.radians(60.0)
"""Objects further to the side are not counted from the left, if enough are in front of the viewer."""
_NEAR_M: Final = 2.0
"""Objects up to this distance from the viewer are near; people call within reach *next to me*."""
_BESIDE_M: Final = 1.0
_SELF_M: Final = 0.01
"""An object at this distance from the viewer is the viewer."""
_TIE_M: Final = 0.015
"""Distances and heights that differ by less count as equal."""
_INTO: Final = ("connects", "separates")
"""An object that leads into a place also counts as in it: the kitchen door."""
_CHEAPEST_FIRST: Final = (
    (Unknown, OneOf),
    (Quality, State, Owned, Called, Affords),
    (FromViewer, Sized),
    (Of,),
    (Among, Related),
    (Has,),
)
_COST: Final = {kind: cost for cost, kinds in enumerate(_CHEAPEST_FIRST) for kind in kinds}

Names = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Scope:
    """The referents of `it` and `one` in an embedded phrase."""

    it: Names = ()
    one: Description | None = None


@dataclass(frozen=True, slots=True)
class Resolved:
    """The entities that match a description, sorted by its order.

    `kind` are all entities that the noun may denote, and `failed` is the first restriction that none of them
    meets. `is_tied` means that several are equally first.
    """

    description: Description
    names: Names
    kind: Names
    failed: Restriction | None = None
    is_tied: bool = False


@dataclass(frozen=True, slots=True)
class Resolver:
    """Resolves descriptions in one map; *my* refers to the entity named `asker`."""

    index: MapIndex
    geometry: MapGeometry
    language: Language
    asker: str | None = None
    _memory: dict[tuple[Description, Scope], Resolved] = field(default_factory=dict)

    def resolve(self, description: Description, scope: Scope = Scope()) -> Resolved:
        """Return the entities that match a description."""
        key = (description, scope if _refers(description, "it", "one") else Scope())
        if key not in self._memory:
            self._memory[key] = self._resolve(description, scope)
        return self._memory[key]

    def _resolve(self, description: Description, scope: Scope) -> Resolved:
        if description.head == "it":
            return Resolved(description, scope.it, scope.it)
        if description.head == "one" and scope.one is not None:
            description = replace(
                description, head=scope.one.head, key=scope.one.key, noun=scope.one.noun, is_alternative=False
            )
        if (key := self.index.several_of(description.key, self.language)) != description.key:
            description = replace(description, key=key, is_plural=True)
        kind = self._kind(description, scope)
        names = kind
        failed = None
        for restriction in sorted(description.restrictions, key=_cost):
            fitting = tuple(name for name in names if self.fits(name, restriction, description, kind, scope))
            if names and not fitting and failed is None:
                failed = restriction
            names = fitting
        if len(names) > 1 and description.is_definite and not description.is_plural:
            names = self._smallest_of_the_small(names, description)
            names = self._nearest_in_the_stack(names, description)
            if description.head == "noun" and description.order is None:
                exact = (
                    name for name in names if self.index.is_exact_match(name, description.key, self.language)
                )
                names = tuple(exact) or names
        is_tied = False
        if description.order is not None and names:
            names, is_tied = self._ordered(names, description.order, description)
        return Resolved(description, names, kind, failed, is_tied)

    def _kind(self, description: Description, scope: Scope) -> Names:
        """Return all entities that the noun may denote; for *a bottle of water* also the water."""
        if description.head == "one" and not description.restrictions and description.order is None:
            return ()  # the description is empty
        if description.head != "noun":
            return tuple(sorted(name for name, item in self.index.items.items() if not item.is_place))
        found = self.index.find_by_noun(description.key, self.language)
        for restriction in description.restrictions:
            if isinstance(restriction, Of) and restriction.is_content:
                content = self.resolve(restriction.other, scope)
                if not any(self._is_of(self.index.items[name], content) for name in found):
                    found = {**found, **dict.fromkeys(content.kind)}
        return tuple(sorted(found))

    def fits(
        self, name: str, restriction: Restriction, description: Description, kind: Names, scope: Scope
    ) -> bool:
        """Return whether an entity meets a restriction; sizes are compared with those of `kind`."""
        item = self.index.items[name]
        inner = Scope((name,), description)

        def meant(other: Description) -> Resolved:
            self.require_speaker(other)
            return self.resolve(other, scope if other.head == "it" else inner)

        match restriction:
            case Unknown():
                return False
            case Quality(_, values):
                return not values.isdisjoint(item.all_values)
            case State(_, property_name, value):
                return self._is_in_state(item, property_name, value)
            case Called(_, key):
                return name in self.index.nouns[self.language].exact.get(key, ())
            case OneOf(_, names):
                return name in names
            case FromViewer(_, relation):
                return self._is_from_viewer(name, relation)
            case Affords(_, affordances):
                return not affordances.isdisjoint(self.index.affords(item))
            case Owned(_, by):
                return self._is_owned(item, by, scope)
            case Sized(_, axis, sign):
                return self._stands_out(name, axis, sign, kind)
            case Related(_, relation, others):
                return self._is_related(name, relation, list(map(meant, others)))
            case Has(_, other):
                found = meant(other).names
                says_where = _refers(other, "it")
                supports = (says_where or self._supports(name, load) for load in found)
                return any(supports) if other.number is None else sum(supports) >= other.number
            case Among(_, other):
                return name in meant(other).names
            case Of(_, other):
                return self._is_of(item, meant(other))
            case Not(restriction=inside):
                return self._can_be_negated(item, inside, scope) and not self.fits(
                    name, inside, description, kind, scope
                )
            case AnyOf(restrictions=inside):
                return any(self.fits(name, one, description, kind, scope) for one in inside)

    def _can_be_negated(self, item: Item, restriction: Restriction, scope: Scope) -> bool:
        """Return whether a restriction can be negated: its words and the property's value are known."""
        match restriction:
            case State(_, property_name, bool()) if property_name != "holding":
                return property_name in item.values
            case Among(_, other) if other.is_definite and other.head == "noun" and not other.is_plural:
                return bool(self.resolve(other, scope).names)
            case Related(others=others) if any(
                other.is_definite and other.head == "noun" and not self.resolve(other, scope).kind
                for other in others
            ):
                return False
        return not _is_unknown(restriction)

    def _is_in_state(self, item: Item, property_name: str, value: bool | str) -> bool:
        if property_name == "holding":
            return self.geometry.holds_anything(item.name) == value
        if property_name == "standing":
            return not item.is_place and self.geometry.is_on_floor(item.name)
        if property_name == "within":
            holders = self.index.members.get(str(value), {})
            return any(self.geometry.related("isInside", item.name, holder) for holder in holders)
        return value in item.values.get(property_name, frozenset())

    def _is_owned(self, item: Item, by: Description | None, scope: Scope) -> bool:
        owners = item.values.get("isOwnedBy", frozenset())
        if by is not None:
            whole = self.resolve(by, scope)
            own = item.name in whole.names  # Anna is not one of Anna's things
            return not own and (not owners.isdisjoint(whole.names) or self._is_of(item, whole))
        return bool(owners) if self.asker is None else self.asker in owners

    def require_speaker(self, description: Description) -> None:
        """Raise BadRequest if a description contains *my* and there is no speaker."""
        if self.asker is None and any(
            isinstance(r, Owned) and r.by is None for r in description.restrictions
        ):
            raise errors.BadRequest("the owner 'my' requires a speaker; add --for PERSON")

    def _is_from_viewer(self, name: str, relation: str) -> bool:
        """Return whether an entity is beside, before or behind the viewer. Raises BadRequest without one."""
        bearing = self.geometry.bearing(name)
        away = self.geometry.distance_from_viewer(name)
        if not math.isfinite(away) or away < _SELF_M:  # the viewer is not near itself
            return False
        match relation:
            case "isBehind":
                return abs(bearing) > math.pi / 2
            case "isInFrontOf":
                return abs(bearing) <= _IN_VIEW_RAD
            case "isLeftOf":
                return 0 < bearing < math.pi
            case "isRightOf":
                return -math.pi < bearing < 0
        return away <= (_BESIDE_M if relation == "isNextTo" else _NEAR_M)

    def _is_related(self, name: str, relation: str, others: Sequence[Resolved]) -> bool:
        found = [tuple(n for n in other.names if n != name) for other in others]
        if relation == "isUnder" and any(self.geometry.related("isOn", other, name) for other in found[0]):
            return True
        if relation == "isAbove" and any(
            self._are_alike(name, other) and self.geometry.related("isOn", name, other) for other in found[0]
        ):
            return True  # the upper of two boxes
        if relation == "isBetween":
            pairs = [(a, b) for a in found[0] for b in found[-1] if a != b]
            if all(other.description.is_definite and not other.description.is_plural for other in others):
                pairs.sort(key=lambda pair: (self.geometry.distance(*pair), pair))
                pairs = pairs[:1]  # of several sinks the one beside the counter
            return any(name in self.geometry.between(*pair) for pair in pairs)
        return any(
            self.geometry.related(relation, name, other) or self._is_asserted(relation, name, other)  # type: ignore[arg-type]
            for other in found[0]
        )

    def _is_asserted(self, relation: str, name: str, other: str) -> bool:
        """Return whether places are asserted to be adjacent, or an object to lead into a place."""
        one, two = self.index.items[name], self.index.items[other]
        if relation == "isInside":
            return two.is_place and any(other in one.values.get(name, ()) for name in _INTO)
        adjacent = one.values.get("isAdjacentTo", frozenset()), two.values.get("isAdjacentTo", frozenset())
        return relation in ("isNextTo", "isNear") and (other in adjacent[0] or name in adjacent[1])

    def _supports(self, name: str, other: str) -> bool:
        """Return whether `other` is on or in `name`, or both stand side by side on the floor."""
        if self._is_asserted("isInside", other, name) or any(
            self.geometry.related(how, other, name) for how in ("isOn", "isInside")
        ):
            return True
        items, geometry = self.index.items, self.geometry
        if items[name].is_place or items[other].is_place or not geometry.related("isNextTo", name, other):
            return False
        return geometry.is_on_floor(name) and geometry.is_on_floor(other)

    def _is_of(self, item: Item, others: Resolved) -> bool:
        """Return whether an item belongs to one of `others`: its place, owner, whole, support or content."""
        related = self.geometry.related
        for name in others.names:
            other = self.index.items[name]
            if name == item.name:
                return "Person" not in other.types  # Anna is not one of the things that belong to Anna
            if name in item.all_values or item.name in other.all_values:
                return True
            if self.index.parts.is_part(item.name, name):
                return True
            if other.is_place:
                if related("isInside", item.name, name):
                    return True
            elif "isOwnedBy" not in item.values and (
                related("isOn", item.name, name)
                or related("isInside", item.name, name)
                or related("isInside", name, item.name)
            ):
                return True
        return False

    # Big, small, first, nearest

    def _measure(self, name: str, axis: str) -> float | None:
        if axis == "mass":
            return self.index.items[name].number("mass")
        size = self.geometry.size(name)
        if size is None:
            return None
        return {"volume": math.prod(size), "tallness": size[2], "length": max(size[:2])}[axis]

    def _stands_out(self, name: str, axis: str, sign: int, kind: Names) -> bool:
        """Return whether an object is big (or small) among its kind: the sizes are split into two groups."""
        own = self._measure(name, axis)
        if own is None:
            return False
        sizes = [size for other in kind if (size := self._measure(other, axis)) is not None]
        least, most = min(sizes), max(sizes)
        if most < _ALIKE * least:
            return True
        middle = math.sqrt(least * most)
        return own > middle if sign < 0 else own < middle

    def _smallest_of_the_small(self, names: Names, description: Description) -> Names:
        """Of several small things, return those that are small compared with the others, if there are any."""
        for restriction in description.restrictions:
            if isinstance(restriction, Sized):
                axis, sign = restriction.axis, restriction.sign
                names = tuple(n for n in names if self._stands_out(n, axis, sign, names)) or names
        return names

    def _nearest_in_the_stack(self, names: Names, description: Description) -> Names:
        """Return the nearest of things above or below one of their kind: the drawer above the open one."""
        for restriction in description.restrictions:
            if not isinstance(restriction, Related) or restriction.relation not in ("isAbove", "isUnder"):
                continue
            others = self.resolve(restriction.others[0], Scope(names, description)).names
            if len(others) == 1 and self._are_alike(names[0], others[0]):
                heights = {n: abs(self._height(n) - self._height(others[0])) for n in names}
                names = tuple(n for n in names if heights[n] <= min(heights.values()) + _TIE_M)
        return names

    def _height(self, name: str) -> float:
        position = self.geometry.position(name)
        return math.inf if position is None else position[2]

    def _are_alike(self, name: str, other: str) -> bool:
        return self.index.items[name].class_name == self.index.items[other].class_name

    def _ordered(self, names: Names, order: Order, description: Description) -> tuple[Names, bool]:
        """Those that come first; all that tie for it, and whether they do."""
        values = self._values(names, order)
        if values is None:
            return names, len(names) > 1
        known = sorted((name for name in names if math.isfinite(values[name])), key=lambda n: (values[n], n))
        if order.sign < 0:
            known.reverse()
        if order.axis == "mass" and len(known) < len(names):  # one of unknown mass may be the heaviest
            return names, len(names) > 1
        if not known:
            return (), False
        if order.sign == 0:
            middle = known[(len(known) - 1) // 2 : len(known) // 2 + 1]
            return tuple(middle), len(middle) > 1
        start = order.place - 1 if order.place > 0 else len(known) + order.place
        if order.place < 0 and order.count > 1:
            start = len(known) - order.count
        if description.is_plural and order.count == 1 and order.place == 1:
            return tuple(known), False
        chosen = known[max(start, 0) : start + order.count] if start >= 0 else []
        if not chosen or len(chosen) < order.count:
            return (), False
        tie = _TIE_M if order.axis in ("distance", "height", "") else 1e-3 * abs(values[chosen[0]])
        last = values[chosen[-1]]
        tied = [name for name in known if name not in chosen and abs(values[name] - last) <= tie]
        return (tuple(sorted({*chosen, *tied})), True) if tied else (tuple(chosen), False)

    def _values(self, names: Iterable[str], order: Order) -> dict[str, float] | None:
        """Return the value of each name on the order's axis; None if the axis is undefined."""
        geometry, axis = self.geometry, order.axis
        if axis == "" and not geometry.has_viewer:
            return None
        if axis in ("across", ""):
            bearings = {name: geometry.bearing(name) for name in names}
            seen = sum(abs(bearing) <= _IN_VIEW_RAD for bearing in bearings.values())
            are_seen = seen >= max(abs(order.place), order.count)
            return {
                name: math.inf if are_seen and abs(bearing) > _IN_VIEW_RAD else -bearing
                for name, bearing in bearings.items()
            }
        if axis == "height":
            return {name: at[2] if (at := geometry.position(name)) else math.inf for name in names}
        if axis == "distance":
            if order.to is None:
                return {name: geometry.distance_from_viewer(name) for name in names}
            targets = self.resolve(order.to).names
            return {
                name: min((geometry.distance(name, t) for t in targets if t != name), default=math.inf)
                for name in names
            }
        return {n: math.inf if (size := self._measure(n, axis)) is None else size for n in names}


@functools.lru_cache(1024)
def _refers(description: Description, *heads: str) -> bool:
    """Return whether a phrase in the description has one of these heads, such as *it*."""
    return description.head in heads or any(
        _refers(inner, *heads) for inner in _embedded(description.restrictions)
    )


def _embedded(restrictions: Iterable[Restriction]) -> Iterator[Description]:
    for restriction in restrictions:
        match restriction:
            case Related(others=others):
                yield from others
            case Has(other=other) | Of(other=other) | Among(other=other):
                yield other
            case Owned(by=by) if by is not None:
                yield by
            case Not(restriction=inside):
                yield from _embedded((inside,))
            case AnyOf(restrictions=inside):
                yield from _embedded(inside)


def _is_unknown(restriction: Restriction) -> bool:
    """Return whether the restriction contains an unknown word."""
    match restriction:
        case Unknown():
            return True
        case Not(restriction=inside):
            return _is_unknown(inside)
        case AnyOf(restrictions=inside):
            return any(map(_is_unknown, inside))
    return any(any(map(_is_unknown, inner.restrictions)) for inner in _embedded((restriction,)))


def _cost(restriction: Restriction) -> int:
    if isinstance(restriction, Not):
        return _cost(restriction.restriction)
    if isinstance(restriction, AnyOf):
        return max(map(_cost, restriction.restrictions))
    return _COST[type(restriction)]
