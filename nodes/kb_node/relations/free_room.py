"""Finds room for an object on, in or next to another one, where it touches nothing but its support.

Candidate positions form a grid on the level surfaces of the target. The relations themselves decide whether
a position is on, in or next to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

from semmap.nodes.geometry.polygons import Point, area, clipped, contains, covers
from semmap.nodes.kb_node.relations.geometry.forms import Form, form_of
from semmap.nodes.kb_node.relations.geometry.opening import AS_DRAWN, joint_at
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Shape, Solid, shape_of
from semmap.nodes.kb_node.relations.measuring import containment, places, proximity
from semmap.nodes.kb_node.relations.measuring.arrangement import measure_next_to
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology.model_shapes import Interior, own_size_m
from semmap.schemas import errors, wording
from semmap.schemas.bridge import FindRoom, PlacedObject, Room
from semmap.schemas.entities import Entity, Pose, Quaternion, Size, orientation_from_yaw
from semmap.schemas.relations import Placing, placing_words

_APART_M: Final = 0.02
"""Distance to neighbours."""
_LIFTED_M: Final = 0.004
"""Candidates are tested this far above the surface, so that they do not touch it."""
_STEP_M: Final = 0.02
_LEAST_STEPS: Final = 8
"""Steps along a small surface."""
_MOST_TRIES: Final = 4000
"""Candidates on one surface; a larger surface has a coarser grid."""
_BASE_SHARE: Final = 0.95
"""Share of the base that must be over the surface."""
_UNBOUNDED_M: Final = 2.0
"""How far from an object on open ground a place next to it is searched."""


class _Level(NamedTuple):
    """A level surface: its height and convex outline in the map [m]."""

    height: float
    outline: Sequence[Point]


def find_room(space: Space, query: FindRoom, entity: Entity | None, contents: Iterable[str] = ()) -> Room:
    """Return a free pose of an object on, in or next to another one.

    `entity` is the object in the map, if it is there; where it stands, it takes up no room, and neither do
    its `contents`. Raises Refused if there is no room, with the reason.
    """
    if query.alone:
        space, entity, contents = Space(limits=space.limits), None, ()
    model, size, joints = _find_shape(query, entity)
    if size is None:
        raise errors.Refused(f"the size of {query.name} is unknown, so no room can be found; give a size")
    wide = (size[0] + 2 * _APART_M, size[1] + 2 * _APART_M, size[2])
    before = space.solids.get(query.name)
    with space.with_changes(map(_as_entity, query.others), without=(query.name, *contents)):
        target = space.solids.get(query.target)
        if target is None:
            raise errors.Refused(
                f"{query.target} has no position, so nothing can be placed {placing_words(query.placing)} it;"
                f" first: semmap update {query.target} --at X Y Z"
            )
        search = _Search(space, query.name, target, query.placing)
        if query.stays and before is not None and entity is not None and entity.pose and search.holds(before):
            return Room(pose=entity.pose)
        for orientation in _facing(target) if query.orientation is None else (query.orientation,):
            form, box = form_of(model, size, orientation, joints), form_of("", wide, orientation)
            found = search.find(form, box)
            if found is not None:
                x, y, z = (round(value, 4) + 0.0 for value in found.position)
                pose = Pose(position_m=(x, y, z), orientation_wxyz=orientation)
                return Room(pose=pose, note=search.describe_shut(found))
        raise errors.Refused(search.describe_failure(size))


def _as_entity(other: PlacedObject) -> PlacedEntity:
    return PlacedEntity(
        name=other.name, iri="", pose=other.pose, size_m=other.size_m, place=other.place, model=other.model
    )


def _find_shape(query: FindRoom, entity: Entity | None) -> Shape:
    """Return model, size [m] and joint positions of the object."""
    if entity is not None and query.model is None and query.size_m is None:
        return shape_of(entity)
    model = query.model if query.model is not None else entity.model if entity is not None else ""
    if query.size_m is not None:
        return model, query.size_m, AS_DRAWN
    return model, own_size_m(model), AS_DRAWN


class _Search:
    """The search for one object; remembers why positions were rejected."""

    def __init__(self, space: Space, name: str, target: Solid, placing: Placing) -> None:
        self._space = space
        self._name = name
        self._target = target
        self._placing = placing
        self._levels = [*self._find_levels()]
        self._obstacles: dict[str, None] = {}
        if not self._levels:
            raise errors.Refused(self._describe_impossible())

    def find(self, form: Form, box: Form) -> Solid | None:
        """Return an object of this form at the first free position, or None.

        `box` encloses it with the margin to its neighbours.
        """
        for level in self._levels:
            start = self._target.centre[:2] if self._placing == "next_to" else _middle(level.outline)
            for x, y in _grid(level.outline, start):
                z = level.height - form.bottom
                base = [(x + dx, y + dy) for dx, dy in form.base]
                if not covers(level.outline, base):
                    continue
                if self._placing == "next_to" and self._is_beneath(base):
                    continue
                solid = Solid(self._name, (x, y, z), form, False, True)
                if self._placing == "in" and not self._target.is_place and not self._is_contained(solid):
                    continue
                own, around = (
                    Solid(self._name, (x, y, z + _LIFTED_M), of, False, True) for of in (form, box)
                )
                if self._is_free(own, around) and self.holds(solid):
                    return solid
        return None

    def _find_levels(self) -> Iterator[_Level]:
        """Yield the surfaces to search, the most obvious first."""
        target = self._target
        if target.is_place:
            if self._placing == "in" and target.is_measured:
                yield _Level(target.position[2], target.outline)
        elif self._placing == "on":
            levels = [_Level(support.height, support.outline) for support in target.supports]
            yield from sorted(levels, key=lambda level: (-round(area(level.outline), 2), -level.height))
        elif self._placing == "in":
            for hollow in target.hollows if target.is_upright else ():
                if not hollow.filled:
                    yield from _levels_in(target, hollow)
        else:
            yield from self._levels_beside()

    def _levels_beside(self) -> Iterator[_Level]:
        """Yield the surfaces on which the target itself stands."""
        container, supports, place = self._space.spatial_relations(self._target)
        if container is not None and not container[1].by_edge:
            yield from _levels_in(container[0], containment.hollow_around(self._target, container[0]))
        elif container is not None or supports:  # a fixture in a top is next to objects on this top
            support, made = container or supports[0]
            for surface in support.supports:
                if abs(surface.height - made.height_m) <= self._space.limits.gap_m:
                    yield _Level(surface.height, surface.outline)
        elif place is not None:
            yield _Level(place[0].position[2], place[0].outline)
        else:
            x0, y0, x1, y1 = self._target.bounds
            x0, y0, x1, y1 = x0 - _UNBOUNDED_M, y0 - _UNBOUNDED_M, x1 + _UNBOUNDED_M, y1 + _UNBOUNDED_M
            yield _Level(self._target.bottom, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)])

    def _is_free(self, solid: Solid, around: Solid) -> bool:
        """Return whether an object touches nothing, and nothing but the target is in the margin around it."""
        limits = self._space.limits
        for other in self._space.grid.around(around.bounds, 0.0, around):
            if other.is_place or other.bottom > solid.top or other.top < solid.bottom:
                continue
            is_support = other is self._target and self._placing != "next_to"
            if proximity.touches(solid if is_support else around, other, limits) is not None:
                if not is_support:
                    self._obstacles[other.name] = None
                return False
        return True

    def _is_beneath(self, base: Sequence[Point]) -> bool:
        """Return whether a base is under or over a part of the target, as under a table."""
        return area(clipped(base, self._target.outline)) > 0.0

    def _is_contained(self, solid: Solid) -> bool:
        made = containment.inside(solid, self._target, self._space.limits)
        return made is not None and made.holds

    def holds(self, solid: Solid) -> bool:
        """Return whether the relation to the target holds for an object."""
        space, target = self._space, self._target
        if target.is_place:
            made = places.within(solid, target, space.limits)
            return made is not None and made.share > _BASE_SHARE
        if self._placing == "next_to":
            beside = measure_next_to(space, solid, target)
            return beside is not None and beside.holds
        container, supports, _ = space.spatial_relations(solid)
        if container is not None and container[0] is target:
            return True
        return self._placing == "on" and any(
            support is target and made.share >= _BASE_SHARE for support, made in supports
        )

    def _describe_impossible(self) -> str:
        name = self._target.name
        if self._target.is_place and self._placing != "in":
            return f"{name} is a place; for its floor use --in {name}"
        if not self._target.is_measured:
            return f"the size of {name} is unknown; set it with: semmap update {name} --size X Y Z"
        if not self._target.is_upright:
            return f"{name} is tilted, so nothing can be placed {placing_words(self._placing)} it"
        if self._placing == "in" and self._target.hollows:
            return (
                f"{name} is solid in the simulator, so nothing can be placed in it; place {self._name}"
                f" with --at, then: semmap set {self._name} isInside {name}"
            )
        if self._placing == "in" and self._target.form.shape.interiors:
            return f"{name} is shallow, so things are on it; use --on {name}"
        return f"{name} has no {'interior' if self._placing == 'in' else 'level surface'}"

    def describe_failure(self, size: Size) -> str:
        """Return why there is no room."""
        how = f"{placing_words(self._placing)} {self._target.name}"
        if self._obstacles:
            take = "takes" if len(self._obstacles) == 1 else "take"
            obstacles = wording.few(sorted(self._obstacles), 5)
            return f"there is no room for {self._name} {how}: {obstacles} {take} it up"
        return f"{self._name} ({' x '.join(f'{length:g}' for length in size)} m) does not fit {how}"

    def describe_shut(self, solid: Solid) -> str:
        """Return a note if the object is in a closed interior, else an empty text."""
        target = self._target
        if self._placing != "in" or target.is_place:
            return ""
        behind = containment.hollow_around(solid, target).behind
        form = target.form
        positions = form.joints or (0.0,) * len(form.shape.leaves)
        leaves = [joint_at(leaf, at) for leaf, at in zip(form.shape.leaves, positions, strict=True)]
        is_shut = bool(behind) and not any(leaf.openness for leaf in leaves if leaf.name in behind)
        return f"{target.name} is closed" if is_shut else ""


def _facing(target: Solid) -> tuple[Quaternion, Quaternion]:
    """Return the orientations along the target's axes."""
    (a, _, _), (d, _, _), _ = target.rotation
    yaw = 0.0 if target.is_place else math.atan2(d, a)
    return orientation_from_yaw(yaw), orientation_from_yaw(yaw + math.pi / 2)


def _levels_in(outer: Solid, hollow: Interior) -> Iterator[_Level]:
    """Yield the floor of a hollow and the boards in it, the lowest first."""
    outline = outer.outline_of(hollow)
    low = outer.to_map(hollow.low)[2]
    high = low + hollow.high[2] - hollow.low[2]
    levels = [_Level(low, outline)]
    for support in outer.supports:
        if low + _LIFTED_M < support.height < high and len(board := clipped(support.outline, outline)) > 2:
            levels.append(_Level(support.height, board))
    yield from sorted(levels, key=lambda level: level.height)


def _middle(outline: Sequence[Point]) -> Point:
    xs, ys = zip(*outline, strict=True)
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2


def _grid(outline: Sequence[Point], start: Point) -> list[Point]:
    """Return points within a convex outline, along its first side, nearest to `start` first."""
    (ax, ay), (bx, by) = outline[0], outline[1]
    length = math.hypot(bx - ax, by - ay) or 1.0
    ux, uy = (bx - ax) / length, (by - ay) / length
    along = [(x - start[0]) * ux + (y - start[1]) * uy for x, y in outline]
    across = [(y - start[1]) * ux - (x - start[0]) * uy for x, y in outline]
    side = math.sqrt(area(outline))
    step = max(side / math.sqrt(_MOST_TRIES), min(_STEP_M, side / _LEAST_STEPS))
    points = [
        (start[0] + i * step * ux - j * step * uy, start[1] + i * step * uy + j * step * ux)
        for i in range(math.ceil(min(along) / step), math.floor(max(along) / step) + 1)
        for j in range(math.ceil(min(across) / step), math.floor(max(across) / step) + 1)
    ]
    inside = [point for point in points if contains(outline, point)]
    return sorted(inside, key=lambda point: math.dist(point, start))
