"""Reads entities from triples."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Sequence, Set
from contextlib import suppress
from itertools import islice, product

from msgspec import structs

from semmap.nodes.kb_node.entities import aligned_values, equal_individuals
from semmap.nodes.kb_node.entities.class_table import ClassTable, Kind
from semmap.nodes.kb_node.entities.equal_individuals import About, Objects
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.ontology.model_choice import chosen
from semmap.schemas import errors, polygons
from semmap.schemas.attachments import GRASPING
from semmap.schemas.commits import Star
from semmap.schemas.entities import REACH_M, SAME_AS, Entity, Pose, Provenance, Size, Stated, Tracked, is_name
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.joints import OPENING, SWITCHING

_FEW = 16
_MANY_TRIPLES = 100
"""Triples per subject beyond which looking it up is faster than scanning."""
_MAX_PATH = 8
_SAME_M = 1e-6
"""Positions and sizes that differ by less are the same, in another vocabulary or spelling."""
_IRI = re.compile("<(https?|urn|file):", re.IGNORECASE)
_OF_THE_TBOX = Provenance(commit=0, stamp_ns=0, source="file", reason="the TBox says so")


def about(reasoner: Reasoner, triples: Collection[Triple], new: Set[Term]) -> About:
    """Return a lookup of what is asserted about a subject. `triples` contain everything about `new` ones.

    If these are few among very many triples, they are looked up in the reasoner, too.
    """
    if len(triples) > _MANY_TRIPLES * len(new):
        return reasoner.about
    at_hand: dict[Term, dict[Term, list[Term]]] = {s: {} for s in new}
    for s, p, o in triples:
        asserted = at_hand.get(s)
        if asserted is not None:
            asserted.setdefault(p, []).append(o)
    return lambda subject: at_hand.get(subject) or reasoner.about(subject)


def read_entity(
    reasoner: Reasoner,
    classes: ClassTable,
    iri: Term,
    provenance: Provenance,
    about: About | None = None,
) -> Entity | None:
    """Return the entity that the triples about `iri` describe, or None if it is not an entity.

    Equal individuals are one entity, which has the IRI of one of them; the others give None. All of it gets
    `provenance`. `about` is a lookup to use in place of the reasoner. Raises BadRequest for an entity without
    an IRI that can be its name, or with an invalid number or size.
    """
    types = reasoner.types(iri)
    if types.isdisjoint(classes.spatial):
        return None
    about = about or reasoner.about
    if given := stated_name(about(iri)):
        v.give_name(iri, given)
    if members := reasoner.equals(iri):
        if iri != equal_individuals.choose_primary(members, classes, about):
            return None
        about = equal_individuals.merge(about, members)
    asserted = about(iri)
    if classes.alignments and iri.startswith("_:"):
        return None  # an unnamed part, which clients cannot refer to
    kind = classes.kind(types, frozenset(asserted.get(v.RDF_TYPE, ())))
    if kind is None:
        raise errors.InternalError(f"{iri} is a spatial individual without a class")
    pose, size_m = read_place(about, classes, iri)
    properties = classes.property_table.read_values(asserted)
    if others := equal_individuals.find_other_names(members, iri):
        properties = {**properties, SAME_AS: others}
    return make_entity(
        iri,
        kind,
        provenance,
        pose=pose,
        size_m=size_m,
        preferred=read_references(about, asserted.get(v.HAS_PREFERRED_REFERENCE, ())),
        alternatives=read_references(about, asserted.get(v.HAS_ALTERNATIVE_REFERENCE, ())),
        labels=aligned_values.labels(classes.alignments, about, iri),
        aliases=aligned_values.aliases(asserted),
        conflict="; ".join(sorted(map(_text, asserted.get(v.CONFLICTING_OBSERVATION, ())))),
        tracked=_tracked(iri, asserted.get(v.TRACKED_FROM, ())),
        model=stated_model(asserted),
        properties=properties,
        given_name=given,
    )


def read_place(about: About, classes: ClassTable, iri: Term) -> tuple[Pose | None, Size | None]:
    """Return the pose and size; for a place with a polygon as extent, those of the box around it.

    Raises BadRequest for invalid numbers or an invalid polygon.
    """
    asserted = about(iri)
    size_m = _size(about, iri, asserted.get(v.HAS_SIZE, ()))
    pose = _pose(about, iri, asserted.get(v.HAS_POSITION, ()))
    if classes.alignments:
        size_m = size_m or aligned_values.size(classes.alignments, about, iri)
        pose = pose or aligned_values.pose(classes.alignments, about, iri, size_m)
    if v.HAS_EXTENT in asserted:
        return _around(iri, asserted[v.HAS_EXTENT], pose, size_m)
    return pose, size_m


def require_one_place(about: About, classes: ClassTable, iri: Term, name: str | None = None) -> None:
    """Raise BadRequest for an entity with several poses or sizes, in whatever vocabularies they are.

    `name` is how the message calls it; the default is its name.
    """
    asserted, known = about(iri), classes.alignments
    positions = _find_vectors(about, asserted.get(v.HAS_POSITION, ()), v.COORDINATE_XYZ)
    orientations = _find_vectors(about, asserted.get(v.HAS_POSITION, ()), v.ORIENTATION_WXYZ)
    sizes = _find_vectors(about, asserted.get(v.HAS_SIZE, ()), v.SIZE_XYZ)
    if known:
        _, size_m = read_place(about, classes, iri)
        for found in aligned_values.find_poses(known, about, iri):
            positions.append(aligned_values.bottom_pose(found, size_m).position_m)
        sizes += [found.size_m for found in aligned_values.find_sizes(known, about, iri)]
    for what, vectors in (("positions", positions), ("orientations", orientations), ("sizes", sizes)):
        others = (other for other in vectors[1:] if math.dist(vectors[0], other) > _SAME_M)
        if (other := next(others, None)) is not None:
            both = " and ".join(
                "({})".format(", ".join(f"{x:g}" for x in one)) for one in (vectors[0], other)
            )
            raise errors.BadRequest(f"{name or v.entity_name(iri)} has two {what}: {both}; state one")


def _find_vectors(about: About, nodes: Sequence[Term], properties: Sequence[Term]) -> list[tuple[float, ...]]:
    """Return all complete vectors that the individuals have: one for each combination of valid numbers."""
    found: list[tuple[float, ...]] = []
    for node in nodes:
        asserted = about(node)
        numbers = [list(_read_numbers(asserted.get(p, ()))) for p in properties]
        found += islice(product(*numbers), _FEW)
    return found


def _read_numbers(terms: Iterable[Term]) -> Iterator[float]:
    """Yield the finite numbers of literals."""
    for term in terms:
        with suppress(ValueError):
            if term[0] == '"' and math.isfinite(number := float(v.lexical(term))):
                yield number


def _around(iri: Term, extents: Sequence[Term], pose: Pose | None, size_m: Size | None) -> tuple[Pose, Size]:
    """Return the box around an extent, with the given floor and height. Raises BadRequest."""
    text = min(extents)
    try:
        polygon = polygons.read_wkt(v.lexical(text) if text.startswith('"') else text)
    except errors.BadRequest as error:
        raise errors.BadRequest(f"{v.entity_name(iri)}: {error.text}") from None
    floor_m = pose.position_m[2] if pose is not None else 0.0
    height_m = size_m[2] if size_m is not None else polygons.HEIGHT_M
    at, size = polygons.box_around(polygon, floor_m, height_m)
    return Pose(position_m=at), size


def make_entity(
    iri: Term,
    kind: Kind,
    provenance: Provenance,
    *,
    pose: Pose | None,
    size_m: Size | None,
    preferred: Iterable[str],
    alternatives: Iterable[str],
    labels: Sequence[str] = (),
    aliases: Sequence[str] = (),
    conflict: str = "",
    tracked: Tracked = "",
    model: str = "",
    properties: dict[str, Stated] | None = None,
    given_name: str = "",
) -> Entity:
    """Return an entity with these values, all with `provenance`.

    Its name is that of its IRI, unless another is given. The prefix of a given name does not choose a model.

    Of several preferred references the first in the alphabet is used, and without any the first of `labels`.
    The other labels are aliases. `model` is the stated model, or "" if it follows from class, name and size.
    Raises BadRequest for an IRI that cannot be a name.
    """
    if given_name or v.has_given_name(iri):
        v.give_name(iri, given_name)
    name = _name(iri, kind.class_name)
    stated = properties or {}
    label = min(preferred, default=None) or next(iter(labels), None)
    called = list(alternatives)
    if labels or aliases:
        called += [text for text in dict.fromkeys((*labels, *aliases)) if text not in (label, *called)]
    return Entity(
        name=name,
        class_=kind.class_name,
        iri=v.bare(iri),
        types=kind.types,
        pose=pose,
        size_m=size_m,
        preferred_reference=label,
        alternative_references=tuple(called),
        conflict=conflict,
        tracked=tracked,
        properties=stated,
        joint_provenance=None if stated.keys().isdisjoint(OPENING) else provenance,
        switch_provenance=None if stated.keys().isdisjoint(SWITCHING) else provenance,
        grip_provenance=None if stated.keys().isdisjoint(GRASPING) else provenance,
        place=kind.place,
        fixed=kind.fixed,
        model=model or chosen(kind.model, v.own_name(iri) if given_name else name, size_m),
        provenance=provenance,
        pose_provenance=provenance,
        shape_provenance=provenance,
        reference_provenance=provenance,
    )


def choose_model(known: Entity, classes: ClassTable, asserted: Objects, size_m: Size | None) -> str:
    """Return the model of an entity of the same class with these assertions and this size."""
    class_ = classes.iris.get(known.class_)
    usual = known.model if class_ is None else classes.models[class_]
    return stated_model(asserted) or chosen(usual, v.own_name(v.iri(known.iri)), size_m)


def stated_model(asserted: Objects) -> str:
    """Return the model that is stated for an entity, or ""."""
    terms = asserted.get(v.MODEL, ())
    return _text(min(terms)) if terms else ""


def read_moved(reasoner: Reasoner, known: Entity, provenance: Provenance) -> Entity:
    """Return `known` at its new pose, if nothing but coordinates has changed. Raises BadRequest."""
    iri = v.iri(known.iri)
    about = equal_individuals.about_entity(reasoner, iri)
    asserted = about(iri)
    pose = _pose(about, iri, asserted.get(v.HAS_POSITION, ()))
    if known.place and v.HAS_EXTENT in asserted:
        pose, _ = _around(iri, asserted[v.HAS_EXTENT], pose, known.size_m)
    return structs.replace(known, pose=pose, provenance=provenance)


def read_again(reasoner: Reasoner, classes: ClassTable, known: Entity) -> Entity | None:
    """Read an entity again with its old provenance; None if it is not an entity any more."""
    entity = read_entity(reasoner, classes, v.iri(known.iri), known.provenance)
    if entity is None:
        return None
    return structs.replace(
        entity,
        pose_provenance=known.pose_provenance,
        shape_provenance=known.shape_provenance,
        reference_provenance=known.reference_provenance,
        joint_provenance=entity.joint_provenance and known.joint_provenance,
        switch_provenance=entity.switch_provenance and (known.switch_provenance or entity.switch_provenance),
        grip_provenance=known.grip_provenance or entity.grip_provenance,
    )


def read_tbox_entities(reasoner: Reasoner, classes: ClassTable) -> list[Entity]:
    """Return the entities that a TBox itself describes, and others that `reasoner` holds."""
    iris = {i for c in classes.spatial for i in reasoner.instances(c)}
    read = (read_entity(reasoner, classes, iri, _OF_THE_TBOX) for iri in sorted(iris))
    return [entity for entity in read if entity is not None]


def inherit_provenance(entity: Entity, known: Entity, *, concerned: bool) -> Entity:
    """Return `entity` with the provenance of `known` for all unchanged parts.

    `concerned` means that the commit is about the entity.
    """
    same_shape = (entity.class_, entity.size_m, entity.model, entity.fixed) == (
        known.class_,
        known.size_m,
        known.model,
        known.fixed,
    )
    same_references = (entity.preferred_reference, entity.alternative_references) == (
        known.preferred_reference,
        known.alternative_references,
    )
    asserted = entity.provenance
    same_joints = not (entity.joint_provenance or known.joint_provenance) or all(
        entity.properties.get(name) == known.properties.get(name) for name in OPENING
    )
    same_switches = not (entity.switch_provenance or known.switch_provenance) or all(
        entity.properties.get(name) == known.properties.get(name) for name in SWITCHING
    )
    same_grip = not (entity.grip_provenance or known.grip_provenance) or all(
        entity.properties.get(name) == known.properties.get(name) for name in GRASPING
    )
    return structs.replace(
        entity,
        provenance=asserted if concerned else known.provenance,
        pose_provenance=known.pose_provenance if entity.pose == known.pose else asserted,
        shape_provenance=known.shape_provenance if same_shape else asserted,
        reference_provenance=known.reference_provenance if same_references else asserted,
        joint_provenance=known.joint_provenance if same_joints else asserted,
        switch_provenance=known.switch_provenance if same_switches else asserted,
        grip_provenance=known.grip_provenance if same_grip else asserted,
    )


def _name(iri: Term, class_name: str) -> str:
    """Return the name that the IRI of an entity (http, https, urn or file) stands for. Raises BadRequest."""
    if not iri.startswith("<"):
        raise errors.BadRequest(f"a {class_name} is a blank node; an entity needs an IRI")
    if not _IRI.match(iri):
        raise errors.BadRequest(f"the {class_name} {iri} needs an IRI of http, https, urn or file")
    return v.entity_name(iri)


def find_owners(reasoner: Reasoner, classes: ClassTable, subject: Term) -> set[Term]:
    """Return the individuals that a triple about `subject` may describe: itself and those that refer to it.

    With alignments, also those that refer to these, up to the longest path to a pose or size.
    """
    found = {subject, *find_users(reasoner, subject)}
    if classes.alignments:
        latest = {subject}
        for _ in range(_MAX_PATH):
            pointing = (triple for node in latest for triple in reasoner.asserted(None, None, node))
            latest = {s for s, p, _ in pointing if p in classes.edges} - found
            found |= latest
    return found


def read_entity_triples(
    reasoner: Reasoner,
    classes: ClassTable,
    iri: Term,
    seq: int,
    leaving: Set[Term],
    tbox: frozenset[Triple],
) -> Star:
    """Return the triples about an entity as a message; see `find_entity_triples`. Raises Refused."""
    members = reasoner.equals(iri) or (iri,)
    own, incoming = list[Triple](), list[Triple]()
    for member in sorted(members):
        about_it, referring = find_entity_triples(reasoner, classes, member, leaving, tbox)
        own += about_it
        incoming += [triple for triple in referring if triple[0] not in members]
    suppressed = reasoner.suppressed_about([iri]) if reasoner.has_suppressed else ()
    return Star(
        seq=seq,
        name=v.entity_name(iri),
        iri=iri,
        own=tuple(dict.fromkeys(own)),
        incoming=tuple(dict.fromkeys(incoming)),
        computed=tuple(reasoner.computed(iri)),
        denied=tuple(sorted(triple for triple in suppressed if triple[0] == iri)),
    )


def find_entity_triples(
    reasoner: Reasoner, classes: ClassTable, iri: Term, leaving: Set[Term], tbox: frozenset[Triple]
) -> tuple[list[Triple], list[Triple]]:
    """Return the triples about an entity: its own, and those of others that refer to it.

    Individuals that only the entities in `leaving` use (this one included) count as its own; triples of the
    TBox do not. Raises Refused for an entity of the TBox.
    """
    own = list(reasoner.asserted(iri))
    if not tbox.isdisjoint(own):
        raise errors.Refused(f"{v.entity_name(iri)} is part of the TBox, which commands cannot change")
    nodes = {o for _, p, o in own if p in entity_triples.DESCRIPTION_PROPERTIES} - leaving
    for node in sorted(nodes):
        if all(user in leaving for user in find_users(reasoner, node)):
            own += [t for t in reasoner.asserted(node) if t not in tbox]
    if classes.alignments or any(o.startswith("_:") for _, _, o in own):
        for node in sorted(_find_describing_nodes(reasoner, classes, iri, leaving) - nodes):
            own += [t for t in reasoner.asserted(node) if t not in tbox]
    return own, [t for t in reasoner.asserted(None, None, iri) if t[0] != iri]


def _find_describing_nodes(
    reasoner: Reasoner, classes: ClassTable, iri: Term, leaving: Set[Term]
) -> set[Term]:
    """Return the individuals that describe only this entity, by an alignment or as blank nodes."""
    found: set[Term] = set()
    pending = [iri]
    while pending:
        for p, objects in reasoner.about(pending.pop()).items():
            for o in objects:
                describes = o.startswith("_:") or (p in classes.edges and o.startswith("<"))
                if p == v.RDF_TYPE or not describes or o in found or o in leaving:
                    continue
                if all(s in leaving or s in found or s == o for s, _, _ in reasoner.asserted(None, None, o)):
                    found.add(o)
                    pending.append(o)
    return found


def find_users(reasoner: Reasoner, node: Term) -> Iterable[Term]:
    """Return the individuals that `node` describes; one that uses it twice occurs twice."""
    incoming = list(islice(reasoner.asserted(None, None, node), _FEW))
    if len(incoming) < _FEW:  # reading all is faster than a lookup for each property
        return [s for s, p, _ in incoming if p in entity_triples.DESCRIPTION_PROPERTIES]
    return (s for p in entity_triples.DESCRIPTION_PROPERTIES for s, _, _ in reasoner.asserted(None, p, node))


def _pose(about: About, iri: Term, nodes: Sequence[Term]) -> Pose | None:
    if not nodes:
        return None
    asserted = about(min(nodes))
    position = _numbers(iri, v.COORDINATE_XYZ, asserted)
    if position is None:
        return None
    orientation = _numbers(iri, v.ORIENTATION_WXYZ, asserted)
    if orientation is None:
        return Pose(position_m=position)  # type: ignore[arg-type]
    try:
        return Pose(position_m=position, orientation_wxyz=orientation)  # type: ignore[arg-type]
    except ValueError as error:
        raise errors.BadRequest(f"{v.entity_name(iri)}: {error}") from None


def _size(about: About, iri: Term, nodes: Sequence[Term]) -> tuple[float, float, float] | None:
    if not nodes:
        return None
    size = _numbers(iri, v.SIZE_XYZ, about(min(nodes)))
    if size is not None and min(size) <= 0:
        raise errors.BadRequest(f"{v.entity_name(iri)}: the size {size} must be positive")
    return size  # type: ignore[return-value]


def _numbers(iri: Term, predicates: Sequence[Term], asserted: Objects) -> tuple[float, ...] | None:
    """Return one number per predicate, or None if one is missing."""
    if asserted.keys().isdisjoint(predicates):
        return None
    found: list[float] = []
    for predicate in predicates:
        terms = asserted.get(predicate, ())
        if not terms:
            continue
        term = terms[0] if len(terms) == 1 else min(terms)
        try:
            value = float(term[1 : term.rindex('"')]) if term[0] == '"' else math.nan
        except ValueError:
            value = math.nan
        if not abs(value) <= REACH_M:
            raise errors.BadRequest(
                f"{v.entity_name(iri)}: {v.local_name(predicate)} is {_text(term)}; it must be a number"
                f" from -{REACH_M:g} to {REACH_M:g}"
            )
        found.append(value)
    return tuple(found) if len(found) == len(predicates) else None


def stated_name(asserted: Objects) -> str:
    """Return the name that is stated for an individual, or "". Raises BadRequest if it is not a name."""
    name = _text(min(terms)) if (terms := asserted.get(v.ENTITY_NAME, ())) else ""
    if name and not is_name(name):
        raise errors.BadRequest(f"'{name}' is not a name; use letters, digits, '_', '.' and '-'")
    return name


def _tracked(iri: Term, terms: Sequence[Term]) -> Tracked:
    """Return the source of live poses. Raises BadRequest for an unknown source."""
    if not terms:
        return ""
    source = _text(min(terms))
    if source == "sim":
        return "sim"
    if source == "stream":
        return "stream"
    raise errors.BadRequest(
        f"{v.entity_name(iri)}: trackedFrom is '{source}'; live poses come from sim or stream"
    )


def _text(term: Term) -> str:
    return v.lexical(term) if term[0] == '"' else v.local_name(term)


def read_references(about: About, nodes: Sequence[Term]) -> list[str]:
    """Return the texts of the individuals that hold labels."""
    found: list[str] = []
    for node in sorted(nodes):
        texts = sorted(about(node).get(v.LEXICAL_REFERENCE, ()))
        found += [v.lexical(text) for text in texts if text[0] == '"']
    return found
