"""What a change of the map means for where things are: what it carries along, and what it has to say of that.

Poses are data, and geometry is a function of them: so all of this is known before the reasoner sees a change.
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
from semmap.nodes.kb_node.relations.carrying import Loads
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.facts.rules import RULES, About
from semmap.nodes.kb_node.relations.facts.said import denial, fact_of
from semmap.nodes.kb_node.relations.facts.sayings import Sayings, of_places
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.surroundings import Surroundings
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, wording
from semmap.schemas.commits import Commit, Edit
from semmap.schemas.entities import Entity, carried
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.joints import OPENING
from semmap.schemas.polygons import EXTENT

_FEW = 10
"""Sentences of one kind."""
_MANY = 1000
"""Of those that leave, so many are looked at for what they leave behind."""
_OPENING = frozenset((v.IS_OPEN, v.OPENNESS, v.JOINT_POSITIONS))
_GEOMETRY = _OPENING.union(
    entity_triples.COORDINATE_PROPERTIES, v.SIZE_XYZ, (v.HAS_POSITION, v.HAS_SIZE, v.HAS_EXTENT, v.MODEL)
)
_SHAPING: Final = (EXTENT, *OPENING)
"""Properties that its shape depends on."""


class TakenBack(NamedTuple):
    """What was said of a place and is denied by a change, with a sentence on each."""

    triples: tuple[Triple, ...] = ()
    notes: tuple[str, ...] = ()


class Places:
    """Where the things of a map are, and what was said of that. Owned by the map."""

    def __init__(
        self,
        entities: Mapping[str, Entity],
        in_order: Callable[[], Iterable[Entity]],
        asserted: Callable[[Term], Iterable[Triple]],
        limits: Callable[[], Thresholds],
        facts: Callable[[], Facts | None] = lambda: None,
        told_crowds: Callable[[Collection[str] | None], Iterable[str]] = lambda _: (),
    ) -> None:
        """`entities` by name, as they change; `asserted(property)` are the triples of one.

        `limits()` are the thresholds of the TBox, `facts()` the relations, if somebody keeps them, and
        `told_crowds(names)` has a sentence on each crowd, of which these names are.
        """
        self._facts = facts
        self._told_crowds = told_crowds
        self._entities = entities
        self._surroundings = Surroundings(in_order, entities.get, limits)
        self._sayings = Sayings(asserted)

    def space(self) -> Space:
        """The solids as they are now."""
        facts = self._facts()
        return self._surroundings.space() if facts is None else facts.space

    def upward(self, names: Iterable[str]) -> Collection[str]:
        """These, what is on, inside or in them, and what is on or inside that; all, where nothing is kept."""
        facts = self._facts()
        return self._entities.keys() if facts is None else facts.upward(names)

    def about(self, name: str) -> Iterator[About]:
        """What a thing is inside, on, in and attached to, what counts most first; nothing of a place."""
        facts = self._facts()
        if facts is not None:
            yield from facts.of(name)
        elif (solid := (space := self.space()).solids.get(name)) is not None and not solid.is_place:
            for rule in RULES:
                yield from rule.facts(space, solid)

    def crowds(self, names: Collection[str] | None = None) -> tuple[str, ...]:
        """A sentence on each spot where so many things are that not all are looked at; the first of them.

        With `names`, only where one of these is. Nothing where no relations are kept.
        """
        return tuple(islice(self._told_crowds(names), _FEW))

    def loads(self) -> Loads:
        """What things bear now."""
        return Loads(self.space(), self._facts())

    def take(self, names: Iterable[str], gone: Collection[Triple], come: Collection[Triple]) -> None:
        """A commit touched these entities, and triples went and came."""
        self._surroundings.touch(names)
        self._sayings.change(gone, come)

    def load_of(self, edit: Edit, edits: Iterable[Edit]) -> list[Edit]:
        """The edits of what goes along with an edit that carries; not of what `edits` are about themselves.

        Raises BadRequest for one that moves nothing, and what `borne_by` raises.
        """
        if not edit.places:
            raise errors.BadRequest("--carry is for moving: add --at, --yaw or --orientation")
        names = self.borne_by(edit.name, edit.leave, (other.name for other in edits))
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

    def borne_by(self, name: str, leave: Iterable[str] = (), besides: Iterable[str] = ()) -> list[str]:
        """What a thing bears, what bears before what is borne; not what is to be left, or `besides`.

        Raises UnknownName for names to be left, too; Refused for a place or what has no position.
        """
        leave = tuple(leave)
        for one in (name, *leave):
            if one not in self._entities:
                meant = errors.did_you_mean(one, self._entities)
                raise errors.UnknownName(f"no entity is named '{one}'{meant}")
        entity = self._entities[name]
        if entity.place:
            raise errors.Refused(f"{name} is a place, which carries nothing; move the things in it")
        if entity.pose is None:
            raise errors.Refused(f"{name} has no position yet, so nothing stands on it to be carried")
        return self.loads().all_of(name, {*leave, *besides})

    def taken_back(
        self, reasoner: Reasoner, classes: ClassTable, gone: Collection[Triple], come: Collection[Triple]
    ) -> TakenBack:
        """What was said of the places of those that a change moves or resizes, and geometry then denies."""
        if not self._sayings:
            return TakenBack()
        moved = dict(_moved(self._entities, reasoner, classes, gone, come))
        leaving = set(gone)
        said = {t: fact for t, fact in self._sayings.about(moved).items() if t not in leaving}
        if not said:
            return TakenBack()
        space = self.space()
        triples: list[Triple] = []
        notes: dict[str, None] = {}
        with space.supposing(moved.values()):
            for triple, fact in said.items():
                if (relation := denial(space, fact)) is not None:
                    triples.append(triple)
                    notes[f"taken back: {relation.text}"] = None
        return TakenBack(tuple(triples), at_most(notes))

    def left_behind(self, names: Collection[str]) -> tuple[str, ...]:
        """What stands on those that leave, or is inside them, and stays: a sentence on each; the first."""
        leaving = set(names)
        if leaving.issuperset(self._entities):
            return ()
        loads = self.loads()
        notes = (note for name in islice(names, _MANY) for note in self._left_by(name, loads, leaving))
        return tuple(islice(notes, _FEW))

    def _left_by(self, name: str, loads: Loads, leaving: Collection[str]) -> Iterator[str]:
        inside: dict[str, None] = {}
        on: dict[str, None] = {}
        for other, bearer in loads.directly_on(name):
            (inside if bearer.is_inside else on)[other] = None
        for thing, relation, other in self._sayings.about([name]).values():
            if other == name and relation != "isLocatedIn" and not {thing} & (inside.keys() | on.keys()):
                (inside if relation == "isInside" else on)[thing] = None
        for where, things in (("inside", inside), ("on", on)):
            stay = [thing for thing in things if thing not in leaving and thing in self._entities]
            if stay:
                yield f"{where} {name} {'was' if len(stay) == 1 else 'were'} {wording.few(stay)}"

    def doubts(self, commit: Commit) -> tuple[str, ...]:
        """What a commit says of places that geometry denies as things stand after it; the first of it."""
        said = of_places(commit.inserted)
        if not said:
            return ()
        facts = dict.fromkeys(fact for triple in said if (fact := fact_of(triple)) is not None)
        space = self.space()
        with space.supposing(commit.changed, (gone.name for gone in commit.removed)):
            relations = (denial(space, fact) for fact in facts)
            return at_most(dict.fromkeys(r.text for r in relations if r is not None))


def at_most(notes: Collection[str]) -> tuple[str, ...]:
    """The first sentences of a kind, and how many more there are."""
    first = tuple(islice(notes, _FEW))
    more = len(notes) - len(first)
    return (*first, f"and {more} more of this kind") if more else first


def _moved(
    entities: Mapping[str, Entity],
    reasoner: Reasoner,
    classes: ClassTable,
    gone: Collection[Triple],
    come: Collection[Triple],
) -> Iterator[tuple[str, Entity]]:
    """The entities that a change of triples puts elsewhere or gives another shape, as they will be."""
    own_words = not classes.alignments
    changed = chain(gone, come)
    touched = subjects(t for t in changed if t[1] in _GEOMETRY) if own_words else subjects(gone, come)
    about = _about_after(reasoner, gone, come)
    opened = subjects(t for t in chain(gone, come) if t[1] in _OPENING)
    concerned = {
        iri for node in reasoner.mentioned(touched) for iri in entity_reading.owners(reasoner, classes, node)
    }
    for iri in sorted(concerned):
        was = entity_changes.known(entities, iri)
        if was is not None:
            pose, size_m = entity_reading.read_place(about, classes, iri)
            is_reshaped = was.place or iri in opened
            stated = classes.stated.stated(about(iri)) if is_reshaped else was.properties
            model = entity_reading.model_of(was, classes, about(iri), size_m)
            if (pose, size_m, model) != (was.pose, was.size_m, was.model) or any(
                stated.get(name) != was.properties.get(name) for name in _SHAPING
            ):
                now = structs.replace(was, pose=pose, size_m=size_m, model=model, properties=stated)
                yield was.name, now


def _about_after(
    reasoner: Reasoner, gone: Iterable[Triple], come: Iterable[Triple]
) -> Callable[[Term], dict[Term, list[Term]]]:
    """What will be asserted of each subject."""
    leaving: dict[Term, set[Triple]] = {}
    coming: dict[Term, list[Triple]] = {}
    for triple in gone:
        leaving.setdefault(triple[0], set()).add(triple)
    for triple in come:
        coming.setdefault(triple[0], []).append(triple)

    def about(subject: Term) -> dict[Term, list[Term]]:
        known = reasoner.about(subject)
        if subject not in leaving and subject not in coming:
            return known
        without = leaving.get(subject, set())
        said = {p: [o for o in objects if (subject, p, o) not in without] for p, objects in known.items()}
        for _, p, o in coming.get(subject, ()):
            said.setdefault(p, []).append(o)
        return {p: objects for p, objects in said.items() if objects}

    return about
