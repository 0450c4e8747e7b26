"""Entities as triples: what is wanted of them becomes the triples that go and those that come.

The counterpart of `entity_reading`. It runs where the triples are, so an intent needs no look at them
beforehand, finds free names for the individuals of a star by itself, and cannot be out of date.

What is said in the words of an alignment is said anew in these words, where it stands, so that others read an
export as before. What nobody has said yet is said in semmap's own words.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from semmap.nodes.kb_node.entities import aligned, entity_reading, gripping, opening
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.entities.entity_reading import Objects
from semmap.nodes.kb_node.entities.property_table import Property
from semmap.nodes.kb_node.entities.property_values import same, spoken
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Edit, NewEntity, Statement
from semmap.schemas.entities import Entity, Pose, Size
from semmap.schemas.explanations import Term, Triple


class Draft:
    """A change of triples in the making. What it takes away counts as gone for what it adds later."""

    def __init__(
        self,
        reasoner: Reasoner,
        classes: ClassTable,
        tbox: frozenset[Triple],
        entities: Mapping[str, Entity],
    ) -> None:
        """`entities` are those of the map by name."""
        self.retract: dict[Triple, None] = {}
        self.insert: list[Triple] = []
        self._reasoner = reasoner
        self._classes = classes
        self._tbox = tbox
        self._entities = entities
        self._new: set[Term] = set()
        self._known_classes: dict[str, Term] = {}

    def remove(self, leaving: Iterable[Entity]) -> None:
        """Entities go, with all that is only theirs and all that others say of them.

        Raises Refused for an entity of the TBox.
        """
        iris = [v.iri(entity.iri) for entity in leaving]
        together = frozenset(iris)
        for iri in iris:
            own, incoming = entity_reading.star_of(self._reasoner, self._classes, iri, together, self._tbox)
            self.retract.update(dict.fromkeys(own))
            self.retract.update(dict.fromkeys(incoming))

    def add(self, new: NewEntity) -> None:
        """A new entity. Raises NameTaken, UnknownClass."""
        class_iri, iri = self._class(new.class_iri), v.entity_iri(new.name)
        suffix, number = "", 1
        while True:
            triples = entity_triples.describe(
                new.name,
                class_iri,
                pose=new.pose,
                size_m=new.size,
                preferred=new.ref,
                alternatives=new.alt,
                suffix=suffix,
            )
            subjects = {s for s, _, _ in triples}
            taken = self._taken(subjects)
            if iri in taken and (iri in self._new or self._is_described(iri)):
                raise errors.NameTaken(f"the name '{new.name}' is taken; see: semmap get {new.name}")
            if taken <= {iri}:
                break
            number += 1
            suffix = f"_{number}"
        self._new |= subjects
        self.insert += triples
        if new.set:
            for prop, terms in self._typed(new.set, new.name):
                self._come((iri, prop.iri, term) for term in terms)
        if new.tracked:
            self.insert.append((iri, v.TRACKED_FROM, v.literal(new.tracked)))
        for word in new.affordances:
            self.insert.append((iri, v.HAS_AFFORDANCE, v.dm(word)))

    def edit(self, entity: Entity, edit: Edit) -> None:
        """What is given of an entity changes, in the individuals of its star unless others use them, too.

        Raises BadRequest for a pose that is none, and for a property or value that is none; UnknownClass;
        UnknownName for an individual that does not exist; PreconditionFailed; Refused for an entity of the
        TBox.
        """
        iri = v.iri(entity.iri)
        said = self._reasoner.about(iri)
        if not self._tbox.isdisjoint([(iri, p, o) for p, objects in said.items() for o in objects]):
            raise errors.Refused(f"{entity.name} is part of the TBox, which no command changes")
        if edit.only_if:
            self._require(entity.name, said, edit.only_if)
        if edit.unset or edit.set:
            self._state(entity, said, edit)
        if edit.places or (edit.size is not None and entity.pose is not None and self._classes.alignments):
            self._place(
                entity, said.get(v.HAS_POSITION, ()), edit.pose_after(entity.pose), edit.size or entity.size_m
            )
        if edit.class_iri is not None and v.iri(edit.class_iri) != self._classes.iris.get(entity.class_):
            class_iri = self._class(edit.class_iri)
            self._go((iri, v.RDF_TYPE, o) for o in said.get(v.RDF_TYPE, ()) if o != v.OWL_NAMED_INDIVIDUAL)
            self._come([(iri, v.RDF_TYPE, class_iri)])
        if edit.size is not None:
            self._resize(entity, said.get(v.HAS_SIZE, ()), edit.size)
        if edit.ref is not None and edit.ref != entity.preferred_reference:
            nodes = said.get(v.HAS_PREFERRED_REFERENCE, ())
            (node,) = self._references(entity, v.HAS_PREFERRED_REFERENCE, nodes, ["preferred_reference"])
            self._come(entity_triples.preferred_reference(iri, node, edit.ref))
        if edit.alt is not None and edit.alt != entity.alternative_references:
            nodes = said.get(v.HAS_ALTERNATIVE_REFERENCE, ())
            names = [f"alternative_reference_{i}" for i in range(1, len(edit.alt) + 1)]
            found = self._references(entity, v.HAS_ALTERNATIVE_REFERENCE, nodes, names)
            for node, text in zip(found, edit.alt, strict=True):
                self._come(entity_triples.alternative_reference(iri, node, text))
        if edit.conflict is not None and edit.conflict != entity.conflict:
            known = said.get(v.CONFLICTING_OBSERVATION, ())
            self._go((iri, v.CONFLICTING_OBSERVATION, o) for o in known)
            if edit.conflict:
                self._come([(iri, v.CONFLICTING_OBSERVATION, v.literal(edit.conflict))])
        if edit.tracked is not None and edit.tracked != entity.tracked:
            self._go((iri, v.TRACKED_FROM, o) for o in said.get(v.TRACKED_FROM, ()))
            if edit.tracked:
                self._come([(iri, v.TRACKED_FROM, v.literal(edit.tracked))])

    def _require(self, name: str, said: Objects, only_if: Sequence[Statement]) -> None:
        """Raises PreconditionFailed unless each property has one of these values (none, if none is given)."""
        for prop, terms in self._typed(only_if, name):
            known = said.get(prop.iri, ())
            if not any(same(one, other) for one in known for other in terms) and (known or terms):
                now = " and ".join(spoken(term) for term in sorted(known)) or "not set"
                wanted = " or ".join(map(spoken, terms)) or "unset"
                raise errors.PreconditionFailed(f"{name}: {prop.name} is {now}, not {wanted}")

    def _state(self, entity: Entity, said: Objects, edit: Edit) -> None:
        """Properties lose values, and then get others, which may be the same where all were taken back.

        Raises BadRequest for a value that is both given and taken back, and for several of a functional one.
        """
        iri = v.iri(entity.iri)
        wanted = list(self._typed(edit.set, entity.name))
        left: dict[Term, list[Term]] = {}
        for prop, terms in self._typed(edit.unset, entity.name):
            for term in terms:
                if any(prop.iri == other.iri and any(same(term, o) for o in new) for other, new in wanted):
                    raise errors.BadRequest(
                        f"{prop.name} {spoken(term)} is both set and unset; give one of the two"
                    )
            known = left.get(prop.iri, list(said.get(prop.iri, ())))
            left[prop.iri] = [k for k in known if terms and not any(same(k, term) for term in terms)]
        for prop, terms in wanted:
            given = [term for other, new in wanted if other.iri == prop.iri for term in new]
            if prop.functional and not all(same(given[0], term) for term in given):
                raise errors.BadRequest(f"{prop.name} has one value at most; give one")
            known = left.get(prop.iri, list(said.get(prop.iri, ())))
            new = [term for term in terms if not any(same(k, term) for k in known)]
            left[prop.iri] = [*([] if prop.functional and new else known), *new]
        left.update(opening.implied(left, said))
        left.update(gripping.implied(left, said))
        for property_, now in left.items():
            before = said.get(property_, ())
            self._go((iri, property_, term) for term in before if term not in now)
            self._come((iri, property_, term) for term in now if term not in before)

    def _typed(self, statements: Sequence[Statement], name: str) -> Iterator[tuple[Property, list[Term]]]:
        """The properties and values that are meant. Raises BadRequest, UnknownName."""
        table = self._classes.stated
        for statement in statements:
            prop = table.find(statement.property, name)
            yield (
                prop,
                [table.term(prop, text, self._individual, self._entities) for text in statement.values],
            )

    def _individual(self, name: str) -> Term | None:
        """The individual of the map with this name, if there is one."""
        entity = self._entities.get(name)
        iri = v.iri(entity.iri) if entity is not None else v.entity_iri(name)
        return iri if iri in self._new or self._is_described(iri) else None

    def _place(self, entity: Entity, nodes: Sequence[Term], pose: Pose, size_m: Size | None) -> None:
        about = self._reasoner.about
        said = None if nodes else aligned.said_pose(self._classes.alignments, about, v.iri(entity.iri))
        if said is not None and self._is_own_way(said.nodes):
            self._change(aligned.pose_triples(said, pose, size_m, about))
            return
        if said is not None:
            self._leave(said.nodes, said.words.path, said.words.position)
        numbers = entity_triples.COORDINATE_PROPERTIES
        node = self._numbers(entity, v.HAS_POSITION, nodes, "coordinates", numbers)
        if list(nodes) == [node]:
            self._come(entity_triples.coordinates(node, pose))
        else:
            self._come(entity_triples.position(v.iri(entity.iri), node, pose))

    def _resize(self, entity: Entity, nodes: Sequence[Term], size_m: Size) -> None:
        iri, about = v.iri(entity.iri), self._reasoner.about
        said = None if nodes else aligned.said_size(self._classes.alignments, about, iri)
        if said is not None and self._is_own_way(said.nodes):
            self._change(aligned.size_triples(said, size_m, about))
            return
        if said is not None:
            self._leave(said.nodes, said.words.path, said.words.x)
        node = self._numbers(entity, v.HAS_SIZE, nodes, "size", v.SIZE_XYZ)
        self._come(entity_triples.size(iri, node, size_m))

    def _is_own_way(self, nodes: Sequence[Term]) -> bool:
        """Do the individuals between an entity and its pose or size describe nothing else?"""
        return all(s in nodes for node in nodes[1:] for s, _, _ in self._reasoner.asserted(None, None, node))

    def _leave(self, nodes: Sequence[Term], path: Sequence[Term], last: Term) -> None:
        """An entity no longer has what it shares with others; the others keep it."""
        for s, p, o in zip(nodes, (*path, last), (*nodes[1:], None), strict=True):
            self._go(self._reasoner.asserted(s, p, o))
            if o is not None and not self._is_own_way((s, o)):
                return

    def _numbers(
        self, entity: Entity, edge: Term, nodes: Sequence[Term], word: str, numbers: Sequence[Term]
    ) -> Term:
        """The individual for new numbers: the one that is there, if nobody else uses it, or a new one."""
        iri = v.iri(entity.iri)
        if len(nodes) == 1 and self._is_own(nodes[0]):
            said = self._reasoner.about(nodes[0])
            self._go((nodes[0], p, o) for p in numbers for o in said.get(p, ()))
            return nodes[0]
        self._drop(iri, edge, nodes)
        return self._free(entity.name, word)

    def _references(
        self, entity: Entity, edge: Term, nodes: Sequence[Term], words: Sequence[str]
    ) -> list[Term]:
        """The individuals for new texts, in order: those of which nobody else makes use, then new ones."""
        own = [node for node in sorted(nodes) if self._is_own(node)]
        kept = own[: len(words)]
        for node in kept:
            texts = self._reasoner.about(node).get(v.LEXICAL_REFERENCE, ())
            self._go((node, v.LEXICAL_REFERENCE, o) for o in texts)
        self._drop(v.iri(entity.iri), edge, [node for node in nodes if node not in kept])
        new = [self._free(entity.name, word) for word in words[len(kept) :]]
        return sorted((*kept, *new))

    def _drop(self, iri: Term, edge: Term, nodes: Iterable[Term]) -> None:
        """An entity no longer has these individuals; what only it used goes."""
        for node in nodes:
            self._go([(iri, edge, node)])
            if self._is_own(node):
                self._go(t for t in self._reasoner.asserted(node) if t not in self._tbox)

    def _is_own(self, node: Term) -> bool:
        """Is it in the star of one entity only, and once?"""
        return len(list(entity_reading.users(self._reasoner, node))) == 1

    def _free(self, name: str, word: str) -> Term:
        """The usual name of an individual of a star, or the next one that is not in use."""
        node, number = v.entity_iri(f"{name}_{word}"), 1
        while self._taken({node}):
            number += 1
            node = v.entity_iri(f"{name}_{word}_{number}")
        self._new.add(node)
        return node

    def _taken(self, terms: set[Term]) -> set[Term]:
        """Those of which something is said that does not go, or that this change has made up."""
        made_up = terms & self._new
        known = self._reasoner.mentioned(terms)
        return made_up | {term for term in known if any(self._staying(term))} if known else made_up

    def _staying(self, term: Term) -> Iterator[Triple]:
        for pattern in ((term, None, None), (None, None, term)):
            yield from (t for t in self._reasoner.asserted(*pattern) if t not in self.retract)

    def _is_described(self, term: Term) -> bool:
        return any(t not in self.retract for t in self._reasoner.asserted(term))

    def _class(self, iri: str) -> Term:
        """The term of a class, one object for all who are of it.

        Raises UnknownClass. The TBox may have been replaced since the class was looked up.
        """
        if (term := self._known_classes.get(iri)) is None:
            if (term := v.iri(iri)) not in self._classes.spatial:
                raise errors.UnknownClass(f"the TBox has no class <{iri}> of things in space")
            self._known_classes[iri] = term
        return term

    def _go(self, triples: Iterable[Triple]) -> None:
        self.retract.update(dict.fromkeys(triples))

    def _change(self, changes: tuple[list[Triple], list[Triple]]) -> None:
        self._go(changes[0])
        self._come(changes[1])

    def _come(self, triples: Iterable[Triple]) -> None:
        self.insert += triples
