"""Entities read off the shape of their stars: what is where in a run is found out once a shape.

A run is read at sight when it is the star of one new entity, with each part said at most once, in nodes that
are its own. Whatever is not so regular, or makes no sense, is left to `entities.read_entity`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from itertools import count
from typing import Final, NamedTuple
from weakref import WeakKeyDictionary

from semmap.nodes.kb_node.entities.class_table import ClassTable, Kind
from semmap.nodes.kb_node.entities.entity_reading import make_entity
from semmap.nodes.kb_node.reasoner import Alike, Form, Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import REACH_M, Entity, Pose, Provenance
from semmap.schemas.explanations import Term

_EXTENT: Final = frozenset((v.HAS_EXTENT,))
Places = tuple[int, ...]
_Star = tuple[Sequence[Term], Sequence[Term]]
"""The individuals of a run, the entity first, and its other objects."""
"""Which of a run's other objects."""

_RARE = (v.CONFLICTING_OBSERVATION, v.TRACKED_FROM, v.MODEL)


class _Text(NamedTuple):
    """A reference: the individual that has it, and which of the other objects it is."""

    node: int
    place: int


class _Stated(NamedTuple):
    """A property: the individuals and which of the other objects are its values."""

    property: Term
    nodes: tuple[int, ...]
    places: Places


class Pattern(NamedTuple):
    """Where the parts of an entity are in each run of a shape."""

    kind: Kind
    position: Places | None
    orientation: Places | None
    size: Places | None
    preferred: tuple[_Text, ...]
    alternatives: tuple[_Text, ...]
    stated: tuple[_Stated, ...]


class _Irregular(Exception):
    """Not to be read at sight."""


class Patterns:
    """The patterns of the shapes that have been met."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[object, Pattern | None] = WeakKeyDictionary()

    def of(self, alike: Alike, star: _Star, reasoner: Reasoner, classes: ClassTable) -> Pattern | None:
        """Where the parts of an entity are in all stars of a shape, of which this is one.

        None if it is not to be told at sight.
        """
        try:
            return self._known[alike.shape]
        except KeyError:
            found = self._known[alike.shape] = _pattern(alike.form, star, reasoner, classes)
            return found


def read_regular(pattern: Pattern, star: _Star, provenance: Provenance, classes: ClassTable) -> Entity | None:
    """The entity that this is the star of; None if it is not to be told at sight.

    Raises BadRequest for one that cannot be named.
    """
    names, others = star
    try:
        position = _numbers(pattern.position, others)
        size = _numbers(pattern.size, others)
        orientation = _numbers(pattern.orientation, others)
        pose = None
        if position is not None and orientation is not None:
            pose = Pose(position_m=position, orientation_wxyz=orientation)  # type: ignore[arg-type]
        elif position is not None:
            pose = Pose(position_m=position)  # type: ignore[arg-type]
        if size is not None and min(size) <= 0:
            return None
    except ValueError:
        return None
    return make_entity(
        names[0],
        pattern.kind,
        provenance,
        pose=pose,
        size_m=size,  # type: ignore[arg-type]
        preferred=_texts(pattern.preferred, names, others),
        alternatives=_texts(pattern.alternatives, names, others),
        properties=classes.property_table.read_values(
            {
                said.property: [names[i] for i in said.nodes] + [others[i] for i in said.places]
                for said in pattern.stated
            }
        )
        if pattern.stated
        else None,
    )


def _numbers(places: Places | None, others: Sequence[Term]) -> tuple[float, ...] | None:
    """Raises ValueError for one that is none, or is out of bounds."""
    if places is None:
        return None
    found = tuple([float(others[place].split('"', 2)[1]) for place in places])
    for value in found:
        if not -REACH_M <= value <= REACH_M:
            raise ValueError
    return found


def _texts(texts: Sequence[_Text], names: Sequence[Term], others: Sequence[Term]) -> list[str]:
    """In the order of the nodes' names."""
    if len(texts) > 1:
        texts = sorted(texts, key=lambda text: names[text.node])
    return [v.lexical(others[text.place]) for text in texts]


def _pattern(form: Form, star: _Star, reasoner: Reasoner, classes: ClassTable) -> Pattern | None:
    """The pattern of all stars that are alike this one; None for an irregular one."""
    names, others = star
    entity, *nodes = map(reasoner.types, names)
    if entity.isdisjoint(classes.spatial) or not all(map(classes.spatial.isdisjoint, nodes)):
        return None
    said = _RunContent(form, others)
    if said.is_unusual or said.uses(classes.entry_properties) or said.uses(_EXTENT):
        return None
    kind = classes.kind(entity, frozenset(said.classes))
    if kind is None:
        raise errors.InternalError("a spatial individual has no class")
    try:
        coordinates, size = said.node(v.HAS_POSITION), said.node(v.HAS_SIZE)
        return Pattern(
            kind=kind,
            position=said.numbers(coordinates, v.COORDINATE_XYZ),
            orientation=said.numbers(coordinates, v.ORIENTATION_WXYZ),
            size=said.numbers(size, v.SIZE_XYZ),
            preferred=tuple(said.texts(v.HAS_PREFERRED_REFERENCE)),
            alternatives=tuple(said.texts(v.HAS_ALTERNATIVE_REFERENCE)),
            stated=tuple(said.stated(classes)),
        )
    except _Irregular:
        return None


class _RunContent:
    """What a star says of its first individual and of the others, by place."""

    def __init__(self, form: Form, others: Sequence[Term]) -> None:
        self._others = others
        self.classes: list[Term] = []
        """Those asserted of the entity."""
        self._nodes: dict[tuple[int, Term], list[int]] = {}
        self._places: dict[tuple[int, Term], list[int]] = {}
        place = count()
        for subject, p, o in form.words:
            if isinstance(o, str):
                self.classes += [o] if subject == 0 else []
            elif o is not None:
                self._nodes.setdefault((subject, p), []).append(o)
            else:
                self._places.setdefault((subject, p), []).append(next(place))

    @property
    def is_unusual(self) -> bool:
        """Whether it says what few entities do: perception against it, tracking, a model."""
        return any((0, p) in by for p in _RARE for by in (self._nodes, self._places))

    def uses(self, words: Set[Term]) -> bool:
        """Whether the entity says anything by one of these properties."""
        return any(place == 0 and p in words for by in (self._nodes, self._places) for place, p in by)

    def node(self, predicate: Term) -> int | None:
        """The only node that the entity has by a predicate, if it has any."""
        nodes = self._nodes_by(predicate)
        if len(nodes) > 1:
            raise _Irregular
        return nodes[0] if nodes else None

    def _nodes_by(self, predicate: Term) -> list[int]:
        if (0, predicate) in self._places:
            raise _Irregular  # it is somebody else's, too
        return self._nodes.get((0, predicate), [])

    def numbers(self, node: int | None, predicates: Sequence[Term]) -> Places | None:
        """Where a node's numbers are, if it has any: then one for each predicate."""
        if node is None:
            return None
        found = [self._literal(node, predicate) for predicate in predicates]
        if None not in found:
            return tuple(place for place in found if place is not None)
        if any(place is not None for place in found):
            raise _Irregular
        return None

    def texts(self, predicate: Term) -> Iterator[_Text]:
        """The references that the entity has by a predicate."""
        for node in self._nodes_by(predicate):
            place = self._literal(node, v.LEXICAL_REFERENCE)
            if place is not None:
                yield _Text(node, place)

    def stated(self, classes: ClassTable) -> Iterator[_Stated]:
        """The other properties of the entity."""
        for predicate in classes.property_table.by_iri:
            nodes, places = (by.get((0, predicate), []) for by in (self._nodes, self._places))
            if nodes or places:
                yield _Stated(predicate, tuple(nodes), tuple(places))

    def _literal(self, node: int, predicate: Term) -> int | None:
        """Where the only value of a node is; None if it has none."""
        places = self._places.get((node, predicate), [])
        if (node, predicate) in self._nodes or len(places) > 1:
            raise _Irregular
        if places and self._others[places[0]][0] != '"':
            raise _Irregular
        return places[0] if places else None
