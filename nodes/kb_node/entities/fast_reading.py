"""Entities read off the shape of their stars: what is where in a run is found out once a shape.

A run is read at sight when it is the star of one new entity, with each part said at most once, in nodes that
are its own. Whatever is not so regular, or makes no sense, is left to `entities.read_entity`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from itertools import count
from typing import Final, NamedTuple
from weakref import WeakKeyDictionary

from nodes.kb_node.entities.class_table import ClassTable, Kind
from nodes.kb_node.entities.entity_reading import entity_of
from nodes.kb_node.reasoner import Alike, Reasoner, Run
from ontology import vocabulary as v
from schemas.entities import REACH_M, Entity, Pose, Provenance
from schemas.explanations import Term

_EXTENT: Final = frozenset((v.HAS_EXTENT,))
Places = tuple[int, ...]
"""Which of a run's other objects."""

_OF_FEW = (v.CONFLICTING_OBSERVATION, v.TRACKED_FROM, v.MODEL)


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

    def of(self, alike: Alike, reasoner: Reasoner, classes: ClassTable) -> Pattern | None:
        """Where the parts of an entity are in all runs of a shape; None if it is not to be told at sight."""
        try:
            return self._known[alike.shape]
        except KeyError:
            found = self._known[alike.shape] = _pattern(alike.run, reasoner, classes)
            return found


def read_at_sight(pattern: Pattern, run: Run, provenance: Provenance, classes: ClassTable) -> Entity | None:
    """The entity that a run is the star of; None if it is not to be told at sight.

    Raises BadRequest for one that cannot be named.
    """
    names, others = run.individuals, run.others
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
    return entity_of(
        names[0],
        pattern.kind,
        provenance,
        pose=pose,
        size_m=size,  # type: ignore[arg-type]
        preferred=_texts(pattern.preferred, names, others),
        alternatives=_texts(pattern.alternatives, names, others),
        properties=classes.stated.stated(
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


def _pattern(run: Run, reasoner: Reasoner, classes: ClassTable) -> Pattern | None:
    """The pattern of all runs that are alike this one; None for an irregular one."""
    are_entities = [not reasoner.types(term).isdisjoint(classes.spatial) for term in run.individuals]
    if not are_entities[0] or any(are_entities[1:]):
        return None
    said = _Said(run)
    if said.is_out_of_the_ordinary or said.speaks(classes.first_words) or said.speaks(_EXTENT):
        return None
    kind = classes.kind(reasoner.types(said.entity), frozenset(said.classes))
    assert kind is not None
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


class _Said:
    """What a run says of its first individual and of the others, by place."""

    def __init__(self, run: Run) -> None:
        self._others = run.others
        self.entity = run.individuals[0]
        self.classes: list[Term] = []
        """Those asserted of the entity."""
        self._nodes: dict[tuple[int, Term], list[int]] = {}
        self._places: dict[tuple[int, Term], list[int]] = {}
        place = count()
        places = run.places
        for s, p, o in run.triples:
            subject = places[s]
            if p == v.RDF_TYPE:
                self.classes += [o] if subject == 0 else []
            elif o in places:
                self._nodes.setdefault((subject, p), []).append(places[o])
            else:
                self._places.setdefault((subject, p), []).append(next(place))

    @property
    def is_out_of_the_ordinary(self) -> bool:
        """Whether it says what few entities do: perception against it, tracking, a model."""
        return any((0, p) in by for p in _OF_FEW for by in (self._nodes, self._places))

    def speaks(self, words: Set[Term]) -> bool:
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
        for predicate in classes.stated.by_iri:
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
