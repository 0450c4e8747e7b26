"""The effects of a change on locations: which objects move along, and which asserted locations become wrong.

Geometry is a function of the poses, so all of this is known before the reasoner sees the change.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import chain, islice
from typing import Final, NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.entities import entity_changes, entity_reading
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.preconditions import subjects
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.contents import Contents
from semmap.nodes.kb_node.relations.facts.asserted_locations import AssertedLocations, filter_location_triples
from semmap.nodes.kb_node.relations.facts.contradictions import fact_of, find_contradiction
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.facts.rules import RULES, About
from semmap.nodes.kb_node.relations.lazy_space import LazySpace
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, wording
from semmap.schemas.commits import Commit, Edit
from semmap.schemas.entities import Entity, carried
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.joints import OPENING
from semmap.schemas.polygons import EXTENT

_FEW = 10
"""Largest number of notes of one kind."""
_MANY = 1000
"""Removed entities that are checked for objects that they leave behind."""
_OPENING = frozenset((v.IS_OPEN, v.OPENNESS, v.JOINT_POSITIONS))
_GEOMETRY = _OPENING.union(
    entity_triples.COORDINATE_PROPERTIES, v.SIZE_XYZ, (v.HAS_POSITION, v.HAS_SIZE, v.HAS_EXTENT, v.MODEL)
)
_SHAPING: Final = (EXTENT, *OPENING)
"""Properties that the shape depends on."""


class RetractedLocations(NamedTuple):
    """Asserted locations that a change makes wrong, with a note on each."""

    triples: tuple[Triple, ...] = ()
    notes: tuple[str, ...] = ()


class Places:
    """The locations of entities, and the assertions about them. Owned by the map."""

    def __init__(
        self,
        entities: Mapping[str, Entity],
        in_order: Callable[[], Iterable[Entity]],
        asserted: Callable[[Term], Iterable[Triple]],
        limits: Callable[[], Thresholds],
        facts: Callable[[], Facts | None] = lambda: None,
        describe_crowds: Callable[[Collection[str] | None], Iterable[str]] = lambda _: (),
    ) -> None:
        """Observe `entities` by name; `asserted(property)` returns the triples of a property.

        `limits()` returns the thresholds of the TBox and `facts()` the relations, if they are maintained.
        `describe_crowds(names)` returns a note on each crowd that contains one of the names.
        """
        self._facts = facts
        self._describe_crowds = describe_crowds
        self._entities = entities
        self._surroundings = LazySpace(in_order, entities.get, limits)
        self._sayings = AssertedLocations(asserted)

    def space(self) -> Space:
        """Return the solids as they are now."""
        facts = self._facts()
        return self._surroundings.space() if facts is None else facts.space

    def with_supported(self, names: Iterable[str]) -> Collection[str]:
        """Return these names and all that is on, inside or in them.

        What is on or inside those is included. Return all names if no relations are maintained.
        """
        facts = self._facts()
        return self._entities.keys() if facts is None else facts.with_contents(names)

    def about(self, name: str) -> Iterator[About]:
        """Yield what an object is inside, on, in and attached to, by importance. Nothing for a place."""
        facts = self._facts()
        if facts is not None:
            yield from facts.of(name)
        elif (solid := (space := self.space()).solids.get(name)) is not None and not solid.is_place:
            for rule in RULES:
                yield from rule.facts(space, solid)

    def crowds(self, names: Collection[str] | None = None) -> tuple[str, ...]:
        """Return notes on crowds, where not all neighbours of an object are considered.

        With `names`, only crowds that contain one of them. Only the first notes are returned, and none if no
        relations are maintained.
        """
        return tuple(islice(self._describe_crowds(names), _FEW))

    def loads(self) -> Contents:
        """Return what objects support now."""
        return Contents(self.space(), self._facts())

    def update(self, names: Iterable[str], removed: Collection[Triple], added: Collection[Triple]) -> None:
        """Update the state for a commit that touched these entities and these triples."""
        self._surroundings.mark_changed(names)
        self._sayings.change(removed, added)

    def load_edits(self, edit: Edit, edits: Iterable[Edit]) -> list[Edit]:
        """Return the edits of the objects that move along with `edit`, except those that `edits` are about.

        Raises BadRequest for an edit that does not move the entity, and the errors of `supported_by`.
        """
        if not edit.places:
            raise errors.BadRequest("--carry requires --at, --yaw or --orientation")
        names = self.supported_by(edit.name, edit.leave, (other.name for other in edits))
        was = self._entities[edit.name].pose
        now = edit.pose_after(was)
        load: list[Edit] = []
        for name in names:
            pose = self._entities[name].pose
            if was is None:
                raise errors.InternalError(f"{edit.name} carries others, and has no pose")
            if pose is None:
                raise errors.InternalError(f"{name} is carried, and has no pose")
            there = carried(pose, was, now)
            load.append(Edit(name=name, at=there.position_m, orientation=there.orientation_wxyz))
        return load

    def supported_by(self, name: str, leave: Iterable[str] = (), besides: Iterable[str] = ()) -> list[str]:
        """Return what an object supports, each support before its load, without `leave` and `besides`.

        Raises UnknownName, also for names in `leave`; Refused for a place or an entity without a position.
        """
        leave = tuple(leave)
        for one in (name, *leave):
            if one not in self._entities:
                meant = errors.did_you_mean(one, self._entities)
                raise errors.UnknownName(f"no entity is named '{one}'{meant}")
        entity = self._entities[name]
        if entity.place:
            raise errors.Refused(f"{name} is a place and cannot carry objects; move the objects in it")
        if entity.pose is None:
            raise errors.Refused(f"{name} has no position, so it supports no objects")
        return self.loads().find_all(name, {*leave, *besides})

    def find_denied_locations(
        self, reasoner: Reasoner, classes: ClassTable, removed: Collection[Triple], added: Collection[Triple]
    ) -> RetractedLocations:
        """Return asserted locations that the geometry denies after a change moves or resizes entities."""
        if not self._sayings:
            return RetractedLocations()
        moved = dict(_moved(self._entities, reasoner, classes, removed, added))
        leaving = set(removed)
        asserted = {t: fact for t, fact in self._sayings.about(moved).items() if t not in leaving}
        if not asserted:
            return RetractedLocations()
        space = self.space()
        triples: list[Triple] = []
        notes: dict[str, None] = {}
        with space.with_changes(moved.values()):
            for triple, fact in asserted.items():
                if (relation := find_contradiction(space, fact)) is not None:
                    triples.append(triple)
                    notes[f"retracted: {relation.text}"] = None
        return RetractedLocations(tuple(triples), truncate_notes(notes))

    def describe_left_behind(self, names: Collection[str]) -> tuple[str, ...]:
        """Return notes on what is on or inside removed entities and stays."""
        leaving = set(names)
        if leaving.issuperset(self._entities):
            return ()
        loads = self.loads()
        notes = (
            note for name in islice(names, _MANY) for note in self._left_behind_notes(name, loads, leaving)
        )
        return tuple(islice(notes, _FEW))

    def _left_behind_notes(self, name: str, loads: Contents, leaving: Collection[str]) -> Iterator[str]:
        inside: dict[str, None] = {}
        on: dict[str, None] = {}
        for other, bearer in loads.find_direct(name):
            (inside if bearer.is_inside else on)[other] = None
        for thing, relation, other in self._sayings.about([name]).values():
            if other == name and relation != "isLocatedIn" and not {thing} & (inside.keys() | on.keys()):
                (inside if relation == "isInside" else on)[thing] = None
        for where, things in (("inside", inside), ("on", on)):
            stay = [thing for thing in things if thing not in leaving and thing in self._entities]
            if stay:
                yield f"{where} {name} {'was' if len(stay) == 1 else 'were'} {wording.few(stay)}"

    def conflict_notes(self, commit: Commit) -> tuple[str, ...]:
        """Return notes on locations that a commit asserts and the geometry denies."""
        asserted = filter_location_triples(commit.inserted)
        if not asserted:
            return ()
        facts = dict.fromkeys(fact for triple in asserted if (fact := fact_of(triple)) is not None)
        space = self.space()
        with space.with_changes(commit.changed, (removed.name for removed in commit.removed)):
            relations = (find_contradiction(space, fact) for fact in facts)
            return truncate_notes(dict.fromkeys(r.text for r in relations if r is not None))


def truncate_notes(notes: Collection[str]) -> tuple[str, ...]:
    """Return the first notes, and how many more there are."""
    first = tuple(islice(notes, _FEW))
    more = len(notes) - len(first)
    return (*first, f"and {more} more of this kind") if more else first


def _moved(
    entities: Mapping[str, Entity],
    reasoner: Reasoner,
    classes: ClassTable,
    removed: Collection[Triple],
    added: Collection[Triple],
) -> Iterator[tuple[str, Entity]]:
    """Yield the entities that a change of triples moves or reshapes, as they will be."""
    own_words = not classes.alignments
    changed = chain(removed, added)
    touched = subjects(t for t in changed if t[1] in _GEOMETRY) if own_words else subjects(removed, added)
    about = _lookup_after(reasoner, removed, added)
    opened = subjects(t for t in chain(removed, added) if t[1] in _OPENING)
    concerned = {
        iri
        for node in reasoner.mentioned(touched)
        for iri in entity_reading.find_owners(reasoner, classes, node)
    }
    for iri in sorted(concerned):
        was = entity_changes.known(entities, iri)
        if was is not None:
            pose, size_m = entity_reading.read_place(about, classes, iri)
            is_reshaped = was.place or iri in opened
            stated = classes.property_table.read_values(about(iri)) if is_reshaped else was.properties
            model = entity_reading.choose_model(was, classes, about(iri), size_m)
            if (pose, size_m, model) != (was.pose, was.size_m, was.model) or any(
                stated.get(name) != was.properties.get(name) for name in _SHAPING
            ):
                now = structs.replace(was, pose=pose, size_m=size_m, model=model, properties=stated)
                yield was.name, now


def _lookup_after(
    reasoner: Reasoner, removed: Iterable[Triple], added: Iterable[Triple]
) -> Callable[[Term], dict[Term, list[Term]]]:
    """Return a lookup of what will be asserted about each subject."""
    leaving: dict[Term, set[Triple]] = {}
    coming: dict[Term, list[Triple]] = {}
    for triple in removed:
        leaving.setdefault(triple[0], set()).add(triple)
    for triple in added:
        coming.setdefault(triple[0], []).append(triple)

    def about(subject: Term) -> dict[Term, list[Term]]:
        known = reasoner.about(subject)
        if subject not in leaving and subject not in coming:
            return known
        without = leaving.get(subject, set())
        asserted = {p: [o for o in objects if (subject, p, o) not in without] for p, objects in known.items()}
        for _, p, o in coming.get(subject, ()):
            asserted.setdefault(p, []).append(o)
        return {p: objects for p, objects in asserted.items() if objects}

    return about
