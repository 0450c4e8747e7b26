"""Fast reading of new entities whose triples have a known pattern, which is analysed once.

A run of triples is regular if it describes one new entity, with each part at most once, and with nodes that
belong only to it. Anything else, or an invalid run, is left to `entity_reading.read_entity`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from itertools import count
from typing import Final, NamedTuple
from weakref import WeakKeyDictionary

from semmap.nodes.kb_node.entities import aligned_values
from semmap.nodes.kb_node.entities.aligned_values import LABELS
from semmap.nodes.kb_node.entities.class_table import ClassTable, Kind
from semmap.nodes.kb_node.entities.entity_reading import make_entity
from semmap.nodes.kb_node.reasoner import Form, Reasoner, UniformRuns
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import REACH_M, Entity, Pose, Provenance
from semmap.schemas.explanations import Term

_EXTENT: Final = frozenset((v.HAS_EXTENT,))
Places = tuple[int, ...]
_Star = tuple[Sequence[Term], Sequence[Term]]
"""The individuals of a run, the entity first, and its other objects."""

_RARE = (v.CONFLICTING_OBSERVATION, v.TRACKED_FROM, v.MODEL, v.OWL_SAME_AS, v.ENTITY_NAME)


class _Text(NamedTuple):
    """A reference: its individual and the index of its text among the other objects."""

    node: int
    place: int


class _Stated(NamedTuple):
    """A property: its values by index, as individuals and among the other objects."""

    property: Term
    nodes: tuple[int, ...]
    places: Places


class Pattern(NamedTuple):
    """The positions of an entity's parts in each run of a shape."""

    kind: Kind
    position: Places | None
    orientation: Places | None
    size: Places | None
    preferred: tuple[_Text, ...]
    alternatives: tuple[_Text, ...]
    labels: tuple[_Stated, ...]
    stated: tuple[_Stated, ...]


class _Irregular(Exception):
    """Raised for a run that is not regular."""


class Patterns:
    """The patterns of known shapes."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[object, Pattern | None] = WeakKeyDictionary()

    def of(self, alike: UniformRuns, star: _Star, reasoner: Reasoner, classes: ClassTable) -> Pattern | None:
        """Return the pattern of all runs of a shape, of which `star` is one, or None if it is not regular."""
        try:
            return self._known[alike.shape]
        except KeyError:
            found = self._known[alike.shape] = _pattern(alike.form, star, reasoner, classes)
            return found


def read_regular(pattern: Pattern, star: _Star, provenance: Provenance, classes: ClassTable) -> Entity | None:
    """Return the entity that a run describes, or None if it is not regular.

    Raises BadRequest for an IRI that cannot be a name.
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
    labels = _terms(pattern.labels, star) if pattern.labels else {}
    return make_entity(
        names[0],
        pattern.kind,
        provenance,
        pose=pose,
        size_m=size,  # type: ignore[arg-type]
        preferred=_texts(pattern.preferred, names, others),
        alternatives=_texts(pattern.alternatives, names, others),
        labels=aligned_values.stated_labels(labels) if labels else (),
        aliases=aligned_values.aliases(labels) if labels else (),
        properties=classes.property_table.read_values(_terms(pattern.stated, star))
        if pattern.stated
        else None,
    )


def _terms(stated: Sequence[_Stated], star: _Star) -> dict[Term, list[Term]]:
    """Return the values by property."""
    names, others = star
    return {
        content.property: [names[i] for i in content.nodes] + [others[i] for i in content.places]
        for content in stated
    }


def _numbers(places: Places | None, others: Sequence[Term]) -> tuple[float, ...] | None:
    """Return the numbers. Raises ValueError for an invalid one."""
    if places is None:
        return None
    found = tuple([float(others[place].split('"', 2)[1]) for place in places])
    for value in found:
        if not -REACH_M <= value <= REACH_M:
            raise ValueError
    return found


def _texts(texts: Sequence[_Text], names: Sequence[Term], others: Sequence[Term]) -> list[str]:
    """Return the texts in the order of the nodes' names."""
    if len(texts) > 1:
        texts = sorted(texts, key=lambda text: names[text.node])
    return [v.lexical(others[text.place]) for text in texts]


def _pattern(form: Form, star: _Star, reasoner: Reasoner, classes: ClassTable) -> Pattern | None:
    """Return the pattern of all runs like this one, or None if it is not regular."""
    names, others = star
    entity, *nodes = map(reasoner.types, names)
    if entity.isdisjoint(classes.spatial) or not all(map(classes.spatial.isdisjoint, nodes)):
        return None
    content = _RunContent(form, others)
    if content.is_unusual or content.uses(classes.entry_properties) or content.uses(_EXTENT):
        return None
    kind = classes.kind(entity, frozenset(content.classes))
    if kind is None:
        raise errors.InternalError("a spatial individual has no class")
    try:
        coordinates, size = content.node(v.HAS_POSITION), content.node(v.HAS_SIZE)
        return Pattern(
            kind=kind,
            position=content.numbers(coordinates, v.COORDINATE_XYZ),
            orientation=content.numbers(coordinates, v.ORIENTATION_WXYZ),
            size=content.numbers(size, v.SIZE_XYZ),
            preferred=tuple(content.texts(v.HAS_PREFERRED_REFERENCE)),
            alternatives=tuple(content.texts(v.HAS_ALTERNATIVE_REFERENCE)),
            labels=tuple(content.stated(LABELS)),
            stated=tuple(content.stated(classes.property_table.by_iri)),
        )
    except _Irregular:
        return None


class _RunContent:
    """The content of a run about its first individual and the others, by position."""

    def __init__(self, form: Form, others: Sequence[Term]) -> None:
        self._others = others
        self.classes: list[Term] = []
        """The classes asserted for the entity."""
        self._nodes: dict[tuple[int, Term], list[int]] = {}
        self._places: dict[tuple[int, Term], list[int]] = {}
        place = count()
        for subject, p, o in form.tokens:
            if isinstance(o, str):
                self.classes += [o] if subject == 0 else []
            elif o is not None:
                self._nodes.setdefault((subject, p), []).append(o)
            else:
                self._places.setdefault((subject, p), []).append(next(place))

    @property
    def is_unusual(self) -> bool:
        """Return whether it has rare parts: a conflict, tracking, a model or an equal."""
        return any((0, p) in by for p in _RARE for by in (self._nodes, self._places))

    def uses(self, words: Set[Term]) -> bool:
        """Return whether the entity has one of these properties."""
        return any(place == 0 and p in words for by in (self._nodes, self._places) for place, p in by)

    def node(self, predicate: Term) -> int | None:
        """Return the only node that the entity has for a predicate, if any."""
        nodes = self._nodes_by(predicate)
        if len(nodes) > 1:
            raise _Irregular
        return nodes[0] if nodes else None

    def _nodes_by(self, predicate: Term) -> list[int]:
        if (0, predicate) in self._places:
            raise _Irregular  # another entity uses it, too
        return self._nodes.get((0, predicate), [])

    def numbers(self, node: int | None, predicates: Sequence[Term]) -> Places | None:
        """Return the positions of a node's numbers, one per predicate, or None if it has none."""
        if node is None:
            return None
        found = [self._literal(node, predicate) for predicate in predicates]
        if None not in found:
            return tuple(place for place in found if place is not None)
        if any(place is not None for place in found):
            raise _Irregular
        return None

    def texts(self, predicate: Term) -> Iterator[_Text]:
        """Yield the references of the entity for a predicate."""
        for node in self._nodes_by(predicate):
            place = self._literal(node, v.LEXICAL_REFERENCE)
            if place is not None:
                yield _Text(node, place)

    def stated(self, properties: Iterable[Term]) -> Iterator[_Stated]:
        """Yield those of some properties that the entity has."""
        for predicate in properties:
            nodes, places = (by.get((0, predicate), []) for by in (self._nodes, self._places))
            if nodes or places:
                yield _Stated(predicate, tuple(nodes), tuple(places))

    def _literal(self, node: int, predicate: Term) -> int | None:
        """Return the position of a node's only value, or None."""
        places = self._places.get((node, predicate), [])
        if (node, predicate) in self._nodes or len(places) > 1:
            raise _Irregular
        if places and self._others[places[0]][0] != '"':
            raise _Irregular
        return places[0] if places else None
