"""Conversion of an ABox to columns, and back without applying rules."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import Adjacency
from semmap.nodes.kb_node.reasoner.abox.columns import Claimed, Columns, KindSaid
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind, bits, mask_of
from semmap.nodes.kb_node.reasoner.explain.reasons import Applied, Claim, Edge, Member
from semmap.nodes.kb_node.reasoner.terms import is_named


def columns_of(abox: ABox, *, schema: bytes, size: int) -> Columns | None:
    """Return the columns of an ABox, which may change afterwards.

    Returns None if it has equal nodes or conclusions of SWRL rules.

    `schema` is the digest of the schema, `size` the number of asserted triples.
    """
    if not _is_plain(abox):
        return None
    store = abox.store
    kinds = {kind: number for number, kind in enumerate(dict.fromkeys(store.kind))}
    return Columns(
        schema=schema,
        size=size,
        classes=list(abox.schema.classes),
        properties=[axioms.term for axioms in abox.schema.axioms],
        kinds=[_encode_kind(abox, kind) for kind in kinds],
        reasons=[
            (edge, [_encode_claim(claim) for claim in reason.claims])
            for edge, reason in sorted(abox.reasons.items(), key=lambda item: item[1].order)
        ],
        terms=list(store.terms),
        kind=array("i", map(kinds.__getitem__, store.kind)),
        places=store.places[:],
        subject=array("i", store.subject),
        predicate=array("i", store.predicate),
        object=array("i", store.object),
        source=bytes(store.source),
        out=_links(store.out),
        into=_links(store.into),
    )


def fill(abox: ABox, columns: Columns) -> bool:
    """Load columns into an ABox that has only the conclusions of its schema.

    Returns False and changes nothing if the columns mention classes or properties of another schema.
    """
    schema, store = abox.schema, abox.store
    unknown = [term for term in columns.classes if schema.find_class(term) is None]
    unknown += [term for term in columns.properties if schema.find_property(term) is None]
    if not _is_plain(abox) or not all(map(is_named, unknown)):
        return False  # only the schema creates names that are not IRIs
    classes = [schema.cls(term) for term in columns.classes]
    properties = [schema.property_by_name(term) for term in columns.properties]
    kinds = [_decode_kind(abox, kind, classes) for kind in columns.kinds]
    for kind in abox.kinds:
        del kind.nodes[:]
    store.fill(columns, [*map(kinds.__getitem__, columns.kind)], properties)
    abox.reasons.clear()
    abox.reasons_by_edge.clear()
    abox.reasons_by_node.clear()
    for edge, claims in columns.reasons:
        decoded = tuple(_decode_claim(claim, classes, properties) for claim in claims)
        abox.reasons[edge] = abox.conclude(decoded, edge=edge)
    return True


def _is_plain(abox: ABox) -> bool:
    if abox.schema.rules and any(isinstance(c, Applied) for r in abox.reasons.values() for c in r.claims):
        return False  # such reasons are not encoded
    is_pending = abox.changed_kinds or abox.fresh or abox.dirty
    return not (abox.equals or abox.spellings or abox.has_unknown_equals or is_pending)


def _links(side: Adjacency) -> tuple[array[int], ...]:
    return side.heads[:], side.after[:], side.before[:], side.group[:]


def _encode_kind(abox: ABox, kind: Kind) -> KindSaid:
    return KindSaid(
        given=sorted(kind.given),
        classes=list(bits(kind.mask)),
        excluded=None if kind.excluded is None else list(bits(kind.excluded)),
        ill_typed=kind is abox.kinds.ill_typed,
        told=[abox.schema.classes[cls] for cls in abox.kinds.given(kind)],
    )


def _decode_kind(abox: ABox, encoded: KindSaid, classes: Sequence[int]) -> Kind:
    if encoded.ill_typed:
        return abox.kinds.ill_typed
    given, mask = (map(classes.__getitem__, numbers) for numbers in (encoded.given, encoded.classes))
    excluded = None if encoded.excluded is None else mask_of(map(classes.__getitem__, encoded.excluded))
    return abox.kinds.find_or_create(frozenset(given), mask_of(mask), excluded)


def _encode_claim(claim: Claim) -> Claimed:
    match claim:
        case Member(node, cls):
            return node, cls
        case Edge(edge, None):
            return (edge,)
        case Edge(edge, (prop, backwards)):
            return edge, prop, int(backwards)
    raise AssertionError("columns do not support equal nodes")


def _decode_claim(claim: Claimed, classes: Sequence[int], properties: Sequence[int]) -> Claim:
    if len(claim) == 2:
        return Member(claim[0], classes[claim[1]])
    edge, *role = claim
    return Edge(edge, (properties[role[0]], bool(role[1])) if role else None)
