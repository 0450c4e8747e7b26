"""Writes entities as triples: converts edits to removed and added triples.

It is the counterpart of `entity_reading`. It runs in the knowledge base, so an edit does not require reading
the triples first and cannot be outdated, and free names for new individuals are found here.

Values in the vocabulary of an alignment are updated in that vocabulary, so that other programs can read an
export as before. New values use semmap's own vocabulary.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set

from msgspec import structs

from semmap.nodes.kb_node.entities import (
    aligned_values,
    entity_reading,
    equal_individuals,
    implied_values,
)
from semmap.nodes.kb_node.entities.aligned_values import LABELS
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.entities.equal_individuals import Objects
from semmap.nodes.kb_node.entities.property_table import EQUALITY, STRUCTURAL, Property
from semmap.nodes.kb_node.entities.property_values import is_same_value, to_text
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Edit, NewEntity, Statement
from semmap.schemas.entities import Entity, Pose, Size
from semmap.schemas.explanations import Term, Triple


class Draft:
    """A change of triples in preparation. Removed triples do not count for later additions."""

    def __init__(
        self,
        reasoner: Reasoner,
        classes: ClassTable,
        tbox: frozenset[Triple],
        entities: Mapping[str, Entity],
        find_other: Callable[[str], Term | None] = lambda word: None,
    ) -> None:
        """Create an empty draft. `entities` are those of the map by name.

        `find_other(word)` finds individuals that are not in space by their name or IRI.
        """
        self.retract: dict[Triple, None] = {}
        self.insert: list[Triple] = []
        self._reasoner = reasoner
        self._classes = classes
        self._tbox = tbox
        self._entities = entities
        self._find_other = find_other
        self._new: set[Term] = set()
        self._known_classes: dict[str, Term] = {}
        self._equals: Set[Term] = frozenset()
        """The individuals that the entity that is being edited is, if they are several."""

    def remove(self, leaving: Iterable[Entity]) -> None:
        """Remove entities with all triples that describe only them or refer to them.

        Raises Refused for an entity of the TBox.
        """
        iris = [member for entity in leaving for member in self._members(entity)]
        together = frozenset(iris)
        for iri in iris:
            own, incoming = entity_reading.find_entity_triples(
                self._reasoner, self._classes, iri, together, self._tbox
            )
            self.retract.update(dict.fromkeys(own))
            self.retract.update(dict.fromkeys(incoming))

    def add(self, new: NewEntity) -> None:
        """Add a new entity. Raises NameTaken, UnknownClass."""
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
                self._insert((iri, prop.iri, term) for term in terms)
        if new.tracked:
            self.insert.append((iri, v.TRACKED_FROM, v.literal(new.tracked)))
        for word in new.affordances:
            self.insert.append((iri, v.HAS_AFFORDANCE, v.dm(word)))

    def edit(self, entity: Entity, edit: Edit) -> None:
        """Change an entity. Individuals that describe it are reused unless others use them, too.

        Raises BadRequest for an invalid pose, property or value, UnknownClass, UnknownName for an individual
        that does not exist, PreconditionFailed, NameTaken, and Refused for an entity of the TBox.
        """
        iri, members = v.iri(entity.iri), self._members(entity)
        self._equals = frozenset(members if len(members) > 1 else ())
        asserted = equal_individuals.about_entity(self._reasoner, iri)(iri)
        if not self._tbox.isdisjoint([(iri, p, o) for p, objects in asserted.items() for o in objects]):
            raise errors.Refused(f"{entity.name} is part of the TBox, which commands cannot change")
        if edit.only_if:
            self._require(entity.name, asserted, edit.only_if)
        if edit.unset or edit.set:
            self._state(entity, asserted, edit)
        if edit.places or (edit.size is not None and entity.pose is not None and self._classes.alignments):
            pose, size_m = edit.pose_after(entity.pose), edit.size or entity.size_m
            for one, nodes in self._holders(entity, v.HAS_POSITION, aligned_values.find_poses):
                self._place(one, nodes, pose, size_m)
        if edit.class_iri is not None and v.iri(edit.class_iri) != self._classes.iris.get(entity.class_):
            class_iri = self._class(edit.class_iri, in_space=entity.in_space)
            self._retract(
                (iri, v.RDF_TYPE, o) for o in asserted.get(v.RDF_TYPE, ()) if o != v.OWL_NAMED_INDIVIDUAL
            )
            self._insert([(iri, v.RDF_TYPE, class_iri)])
        if edit.size is not None:
            for one, nodes in self._holders(entity, v.HAS_SIZE, aligned_values.find_sizes):
                self._resize(one, nodes, edit.size)
        if edit.ref is not None and edit.ref != entity.preferred_reference:
            nodes = asserted.get(v.HAS_PREFERRED_REFERENCE, ())
            (node,) = self._references(entity, v.HAS_PREFERRED_REFERENCE, nodes, ["preferred_reference"])
            self._insert(entity_triples.preferred_reference(iri, node, edit.ref))
        kept = self._keep_labels(entity, asserted, edit)
        if edit.alt is not None and edit.alt != entity.alternative_references:
            alt = [text for text in edit.alt if text not in kept]
            nodes = asserted.get(v.HAS_ALTERNATIVE_REFERENCE, ())
            names = [f"alternative_reference_{i}" for i in range(1, len(alt) + 1)]
            found = self._references(entity, v.HAS_ALTERNATIVE_REFERENCE, nodes, names)
            for node, text in zip(found, alt, strict=True):
                self._insert(entity_triples.alternative_reference(iri, node, text))
        if edit.conflict is not None and edit.conflict != entity.conflict:
            known = asserted.get(v.CONFLICTING_OBSERVATION, ())
            self._retract((iri, v.CONFLICTING_OBSERVATION, o) for o in known)
            if edit.conflict:
                self._insert([(iri, v.CONFLICTING_OBSERVATION, v.literal(edit.conflict))])
        if edit.tracked is not None and edit.tracked != entity.tracked:
            self._retract((iri, v.TRACKED_FROM, o) for o in asserted.get(v.TRACKED_FROM, ()))
            if edit.tracked:
                self._insert([(iri, v.TRACKED_FROM, v.literal(edit.tracked))])
        if edit.rename is not None and edit.rename != entity.name:
            self._rename(entity, edit.rename)

    def _members(self, entity: Entity) -> Collection[Term]:
        """Return the individuals that are an entity: that of its IRI, and its equals."""
        iri = v.iri(entity.iri)
        return self._reasoner.equals(iri) or (iri,)

    def _holders(
        self, entity: Entity, edge: Term, find: Callable[..., Iterable[object]]
    ) -> list[tuple[Entity, Sequence[Term]]]:
        """Return the individuals of an entity that have a pose or a size, and the nodes that hold it.

        `find` finds those of alignments. Without any, it is the individual of the entity's IRI.
        """
        about = self._reasoner.about
        members = self._equals or {v.iri(entity.iri)}
        having = [
            iri
            for iri in sorted(members)
            if edge in about(iri) or any(True for _ in find(self._classes.alignments, about, iri))
        ]
        return [
            (structs.replace(entity, iri=v.bare(iri)), about(iri).get(edge, ()))
            for iri in having or [v.iri(entity.iri)]
        ]

    def _keep_labels(self, entity: Entity, asserted: Objects, edit: Edit) -> set[str]:
        """Remove labels (`rdfs:label` and the like) that are not among new aliases, and return the others.

        The preferred label after the edit stays.
        """
        if edit.alt is None:
            return set()
        labels = [(p, o) for p in LABELS for o in asserted.get(p, ()) if o.startswith('"')]
        stay = {entity.preferred_reference if edit.ref is None else edit.ref, *edit.alt}
        self._retract((v.iri(entity.iri), p, o) for p, o in labels if v.lexical(o) not in stay)
        return {v.lexical(o) for _, o in labels}.intersection(edit.alt)

    def _rename(self, entity: Entity, name: str) -> None:
        """Replace the last part of an entity's IRI in all triples about it and all that refer to it.

        The individuals that hold its pose, size and labels keep their names.
        """
        iri = v.iri(entity.iri)
        new = f"{iri[: -1 - len(v.last_part(iri))]}{name}>"
        if name in self._entities:
            raise errors.NameTaken(f"the name '{name}' is taken; see: semmap get {name}")
        if new in self._new or self._is_described(new):
            raise errors.NameTaken(
                f"the name '{name}' is taken by an individual that is not an entity; use another name"
            )
        if entity.in_space:
            self._require_primary(entity, new, name)
        asserted = {*self._reasoner.asserted(iri), *self._reasoner.asserted(None, None, iri)}
        triples = sorted(
            t for t in (*asserted, *self.insert) if iri in (t[0], t[2]) and t not in self.retract
        )
        self.retract.update(dict.fromkeys(asserted))
        self.insert = [t for t in self.insert if iri not in (t[0], t[2])]
        self._insert(
            (new if s == iri else s, p, new if o == iri else o)
            for s, p, o in triples
            if (s, p) != (iri, v.ENTITY_NAME)
        )
        self._new.add(new)

    def _require_primary(self, entity: Entity, new: Term, name: str) -> None:
        """Raise Refused if an equal individual would give an entity its name after its IRI becomes `new`."""
        iri, about = v.iri(entity.iri), self._reasoner.about
        members = {new if member == iri else member for member in self._members(entity)}
        primary = equal_individuals.choose_primary(
            members, self._classes, lambda member: about(iri if member == new else member)
        )
        if primary != new:
            raise errors.Refused(
                f"{entity.name} is the same as {v.entity_name(primary)}, which would give it its name instead"
                f" of {name}; to label it: semmap update {entity.name} --ref TEXT"
            )

    def _require(self, name: str, asserted: Objects, only_if: Sequence[Statement]) -> None:
        """Raise PreconditionFailed unless each property has one of the values, or none if none is given."""
        for prop, terms in self._typed(only_if, name, asserted):
            known = asserted.get(prop.iri, ())
            if not any(is_same_value(one, other) for one in known for other in terms) and (known or terms):
                now = " and ".join(to_text(term) for term in sorted(known)) or "not set"
                wanted = " or ".join(map(to_text, terms)) or "unset"
                raise errors.PreconditionFailed(f"{name}: {prop.name} is {now}, not {wanted}")

    def _state(self, entity: Entity, asserted: Objects, edit: Edit) -> None:
        """Remove values of properties, then add others.

        Raises BadRequest for a value that is both set and unset, and for several values of a functional
        property.
        """
        iri = v.iri(entity.iri)
        wanted = list(self._typed(edit.set, entity.name, asserted))
        left: dict[Term, list[Term]] = {}
        for prop, terms in self._typed(edit.unset, entity.name, asserted):
            for term in terms:
                if any(
                    prop.iri == other.iri and any(is_same_value(term, o) for o in new)
                    for other, new in wanted
                ):
                    raise errors.BadRequest(
                        f"{prop.name} {to_text(term)} is both set and unset; give one of the two"
                    )
            known = left.get(prop.iri, list(asserted.get(prop.iri, ())))
            left[prop.iri] = [k for k in known if terms and not any(is_same_value(k, term) for term in terms)]
        for prop, terms in wanted:
            given = [term for other, new in wanted if other.iri == prop.iri for term in new]
            if prop.functional and not all(is_same_value(given[0], term) for term in given):
                raise errors.BadRequest(f"{prop.name} has one value at most; give one")
            known = left.get(prop.iri, list(asserted.get(prop.iri, ())))
            new = [term for term in terms if not any(is_same_value(k, term) for k in known)]
            left[prop.iri] = [*([] if prop.functional and new else known), *new]
        left.update(implied_values.imply_joint_values(left, asserted))
        left.update(implied_values.imply_attachment_values(left, asserted))
        for property_, now in left.items():
            before = asserted.get(property_, ())
            self._retract((iri, property_, term) for term in before if term not in now)
            self._insert((iri, property_, term) for term in now if term not in before)

    def _typed(
        self, statements: Sequence[Statement], name: str, used: Iterable[Term] = ()
    ) -> Iterator[tuple[Property, list[Term]]]:
        """Yield the properties and values that are meant. `used` are the properties of the entity now.

        Raises BadRequest, UnknownName.
        """
        table = self._classes.property_table
        for statement in statements:
            try:
                prop = table.find(statement.property, name)
            except errors.BadRequest:
                own = table.by_iri.keys() | STRUCTURAL.keys() | EQUALITY
                foreign = (p for p in used if p not in own)
                if statement.property not in map(v.local_name, foreign):
                    raise
                raise errors.BadRequest(
                    f"property '{statement.property}' is not part of the TBox, only of the map; to declare"
                    " it, load its ontology with --tbox --extend, or its map with --tbox-from-abox"
                ) from None
            yield (
                prop,
                [
                    table.term(prop, text, self._individual, self._entities, self._find_other)
                    for text in statement.values
                ],
            )

    def _individual(self, name: str) -> Term | None:
        """Return the individual of the map with this name, or None."""
        entity = self._entities.get(name) or next(
            (e for e in self._entities.values() if e.properties and name in e.other_names), None
        )
        iri = v.iri(entity.iri) if entity is not None else v.entity_iri(name)
        return iri if iri in self._new or self._is_described(iri) else None

    def _place(self, entity: Entity, nodes: Sequence[Term], pose: Pose, size_m: Size | None) -> None:
        about = self._reasoner.about
        aligned = list(aligned_values.find_poses(self._classes.alignments, about, v.iri(entity.iri)))
        asserted = aligned[0] if aligned and not nodes else None
        for other in aligned if asserted is None else aligned[1:]:  # maps of older versions may have several
            if self._is_own_path(other.nodes):
                self._retract(aligned_values.value_triples(other, about))
            else:
                self._detach(other.nodes, other.words.path, other.words.position)
        if asserted is not None and self._is_own_path(asserted.nodes):
            self._change(aligned_values.pose_triples(asserted, pose, size_m, about))
            return
        if asserted is not None:
            self._detach(asserted.nodes, asserted.words.path, asserted.words.position)
        numbers = entity_triples.COORDINATE_PROPERTIES
        node = self._numbers(entity, v.HAS_POSITION, nodes, "coordinates", numbers)
        if list(nodes) == [node]:
            self._insert(entity_triples.coordinates(node, pose))
        else:
            self._insert(entity_triples.position(v.iri(entity.iri), node, pose))

    def _resize(self, entity: Entity, nodes: Sequence[Term], size_m: Size) -> None:
        iri, about = v.iri(entity.iri), self._reasoner.about
        asserted = None if nodes else aligned_values.find_size(self._classes.alignments, about, iri)
        if asserted is not None and self._is_own_path(asserted.nodes):
            self._change(aligned_values.size_triples(asserted, size_m, about))
            return
        if asserted is not None:
            self._detach(asserted.nodes, asserted.words.path, asserted.words.x)
        node = self._numbers(entity, v.HAS_SIZE, nodes, "size", v.SIZE_XYZ)
        self._insert(entity_triples.size(iri, node, size_m))

    def _is_own_path(self, nodes: Sequence[Term]) -> bool:
        """Return whether the individuals between an entity and its pose or size describe nothing else."""
        return all(s in nodes for node in nodes[1:] for s, _, _ in self._reasoner.asserted(None, None, node))

    def _detach(self, nodes: Sequence[Term], path: Sequence[Term], last: Term) -> None:
        """Remove the link from an entity to values that it shares with others."""
        for s, p, o in zip(nodes, (*path, last), (*nodes[1:], None), strict=True):
            self._retract(self._reasoner.asserted(s, p, o))
            if o is not None and not self._is_own_path((s, o)):
                return

    def _numbers(
        self, entity: Entity, edge: Term, nodes: Sequence[Term], word: str, numbers: Sequence[Term]
    ) -> Term:
        """Return the individual for new numbers: the present one if it is not shared, or a new one."""
        iri = v.iri(entity.iri)
        if len(nodes) == 1 and self._is_own(nodes[0]):
            asserted = self._reasoner.about(nodes[0])
            self._retract((nodes[0], p, o) for p in numbers for o in asserted.get(p, ()))
            return nodes[0]
        self._remove_nodes(iri, edge, nodes)
        return self._free(entity.name, word)

    def _references(
        self, entity: Entity, edge: Term, nodes: Sequence[Term], words: Sequence[str]
    ) -> list[Term]:
        """Return the individuals for new texts in order: those that only this entity uses, then new ones."""
        own = [node for node in sorted(nodes) if self._is_own(node)]
        kept = own[: len(words)]
        for node in kept:
            texts = self._reasoner.about(node).get(v.LEXICAL_REFERENCE, ())
            self._retract((node, v.LEXICAL_REFERENCE, o) for o in texts)
        self._remove_nodes(v.iri(entity.iri), edge, [node for node in nodes if node not in kept])
        new = [self._free(entity.name, word) for word in words[len(kept) :]]
        return sorted((*kept, *new))

    def _remove_nodes(self, iri: Term, edge: Term, nodes: Iterable[Term]) -> None:
        """Remove individuals from an entity, with what only it used."""
        for node in nodes:
            self._retract([(iri, edge, node)])
            if self._is_own(node):
                self._retract(t for t in self._reasoner.asserted(node) if t not in self._tbox)

    def _is_own(self, node: Term) -> bool:
        """Return whether an individual describes exactly one entity, once."""
        users = list(entity_reading.find_users(self._reasoner, node))
        return len(users) == 1 or (len(users) > 1 and self._equals >= set(users))

    def _free(self, name: str, word: str) -> Term:
        """Return the default name for an individual that describes an entity, or the next free one."""
        node, number = v.entity_iri(f"{name}_{word}"), 1
        while self._taken({node}):
            number += 1
            node = v.entity_iri(f"{name}_{word}_{number}")
        self._new.add(node)
        return node

    def _taken(self, terms: set[Term]) -> set[Term]:
        """Return the terms that are in use after the removals, or are new in this draft."""
        made_up = terms & self._new
        known = self._reasoner.mentioned(terms)
        return made_up | {term for term in known if any(self._staying(term))} if known else made_up

    def _staying(self, term: Term) -> Iterator[Triple]:
        for pattern in ((term, None, None), (None, None, term)):
            yield from (t for t in self._reasoner.asserted(*pattern) if t not in self.retract)

    def _is_described(self, term: Term) -> bool:
        return any(t not in self.retract for t in self._reasoner.asserted(term))

    def _class(self, iri: str, *, in_space: bool = True) -> Term:
        """Return the term of a class of things in space, or of others; one object for all entities of it.

        Raises UnknownClass, because the TBox may have been replaced since the class was looked up.
        """
        if (term := self._known_classes.get(iri)) is None:
            term = v.iri(iri)
            if term not in self._classes.names or (term in self._classes.spatial) != in_space:
                kind = "spatial" if in_space else "non-spatial"
                raise errors.UnknownClass(f"the TBox has no {kind} class <{iri}>")
            self._known_classes[iri] = term
        return term

    def _retract(self, triples: Iterable[Triple]) -> None:
        """Remove triples. What is removed of an individual is removed of those that are the same, too."""
        triples = list(triples)
        self.retract.update(dict.fromkeys(triples))
        for s, p, o in triples if self._equals else ():
            if s in self._equals:
                same = ((member, p, o) for member in self._equals)
                self.retract.update(dict.fromkeys(t for t in same if any(self._reasoner.asserted(*t))))

    def _change(self, changes: tuple[list[Triple], list[Triple]]) -> None:
        self._retract(changes[0])
        self._insert(changes[1])

    def _insert(self, triples: Iterable[Triple]) -> None:
        self.insert += triples
