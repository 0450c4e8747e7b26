"""Relations that queries need are measured, and kept as if they had been measured after each commit."""

import random

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.relation_table import PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.sparql.protocol import Placements
from semmap.nodes.kb_node.sparql.triples.dataset import MEASURED, Dataset, Delta
from semmap.nodes.kb_node.sparql.triples.measured_relations import MeasuredRelations, Needs, needs_of
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

DERIVED = PairProperties(
    turtle(
        """
dm:isNear a owl:ObjectProperty ; rdfs:subPropertyOf dm:isClose . dm:touches a owl:ObjectProperty .
dm:isUnder a owl:ObjectProperty . dm:isAbove a owl:ObjectProperty . dm:isOn a owl:ObjectProperty .
"""
    )
)
CUP, CHAIR = v.entity_iri("cup1"), v.entity_iri("chair1")
IS_NEAR, IS_CLOSE, IS_ABOVE, IS_ON = map(v.dm, ("isNear", "isClose", "isAbove", "isOn"))
EVERY = Needs(frozenset(PAIR_RELATIONS))


def placed(name, at, iri=None):
    entity = PlacedEntity.of(thing(name, at))
    return structs.replace(entity, iri=v.bare(v.entity_iri(name)) if iri is None else iri)


class Measured:
    """A dataset with the measured triples of a map."""

    def __init__(self, there, asserted=(), needs=EVERY):
        self.there, self.asserted = {entity.name: entity for entity in there}, set(asserted)
        self.dataset = Dataset(0, asserted)
        placements = Placements(placed=tuple(there), limits=Thresholds())
        self.relations = MeasuredRelations(DERIVED, self.dataset, placements)
        self.need(needs)

    def need(self, needs):
        self._apply(*self.relations.update_needs(needs))

    def commit(self, placed=(), removed=(), retracted=(), inserted=()):
        self.there = {n: e for n, e in self.there.items() if n not in removed} | {e.name: e for e in placed}
        self.asserted = self.asserted - set(retracted) | set(inserted)
        delta = Delta(seq=1, retracted=tuple(retracted), inserted=tuple(inserted))
        self.dataset.apply(delta)
        self._apply(*self.relations.after(delta, placed, removed))

    def _apply(self, removed, added):
        assert set(removed) <= self.triples()
        assert not set(added) & self.triples()
        self.dataset.apply(Delta(seq=1, unmeasured=removed, measured=added))

    def triples(self):
        found = self.dataset.store.quads_for_pattern(None, None, None, MEASURED)
        return {(str(quad.subject), str(quad.predicate), str(quad.object)) for quad in found}


@pytest.mark.parametrize(
    "needs", [EVERY, Needs(frozenset({"isNear"})), Needs(frozenset(), frozenset({"cup1", "table1"}))]
)
@pytest.mark.parametrize("seed", range(2))
def test_each_commit_leads_to_the_triples_of_a_new_measurement(seed, needs):
    dice = random.Random(seed)
    room, table = (
        structs.replace(PlacedEntity.of(one), iri=v.bare(v.entity_iri(one.name))) for one in (ROOM, TABLE)
    )
    measured = Measured([room, table], needs=needs)
    names = ("cup1", "cup2", "chair1", "bowl1")
    most = 0
    for _ in range(30):
        changed, removed = [], []
        for name in dice.sample(names, dice.randrange(3)):
            if name in measured.there and dice.random() < 0.3:
                removed.append(name)
            else:
                at = (dice.choice([0.0, 0.1, 0.7]), dice.choice([0.0, 0.1]), dice.choice([0.0, TOP, 1.3]))
                other = f"http://example.org/{name}" if dice.random() < 0.2 else None
                changed.append(placed(name, at, other))
        stated = [(v.entity_iri(a), IS_NEAR, v.entity_iri(b)) for a in names for b in names if a != b]
        inserted = set(dice.sample(stated, 2)) - measured.asserted
        retracted = {triple for triple in measured.asserted if dice.random() < 0.5}
        measured.commit(changed, removed, retracted, inserted)
        again = Measured(measured.there.values(), measured.asserted, needs)
        assert measured.triples() == again.triples()
        most = max(most, len(measured.triples()))
    assert most > 5


def test_needs_come_and_go():
    measured = Measured([placed("cup1", (0.0, 0.0, 0.0)), placed("cup2", (0.1, 0.0, 0.0))], needs=Needs())
    assert measured.triples() == set()
    measured.need(Needs(frozenset({"isNear"})))
    near = {(s, p, o) for p in (IS_NEAR, IS_CLOSE) for s, o in (("1", "2"), ("2", "1"))}
    found = {(v.entity_iri(f"cup{s}"), p, v.entity_iri(f"cup{o}")) for s, p, o in near}
    assert measured.triples() == found
    measured.need(Needs(names=frozenset({"cup2"})))
    assert measured.triples() >= found
    measured.need(Needs())
    assert measured.triples() == set()


def test_what_is_asserted_is_not_measured_as_well():
    near = (v.entity_iri("cup1"), IS_NEAR, v.entity_iri("cup2"))
    there = [placed("cup1", (0.0, 0.0, 0.0)), placed("cup2", (0.1, 0.0, 0.0))]
    measured = Measured(there, [near])
    assert near not in measured.triples()
    measured.commit(retracted=[near])
    assert near in measured.triples()
    measured.commit(inserted=[near])
    assert near not in measured.triples()


@pytest.mark.parametrize(
    ("patterns", "relations", "names"),
    [
        (None, set(PAIR_RELATIONS), set()),
        ([], set(), set()),
        ([(None, IS_NEAR, None)], {"isNear"}, set()),
        ([(None, IS_CLOSE, None)], {"isNear"}, set()),
        ([(None, IS_ABOVE, None)], {"isAbove", "isUnder"}, set()),
        ([(None, IS_ON, None)], set(), set()),
        ([(None, None, None)], set(PAIR_RELATIONS), set()),
        ([(CUP, IS_NEAR, None)], set(), {"cup1"}),
        ([(None, IS_NEAR, CUP)], set(), {"cup1"}),
        ([(CUP, IS_NEAR, CHAIR)], set(), {"cup1"}),
        ([(CUP, None, None)], set(), {"cup1"}),
        ([(CUP, IS_ON, None)], set(), set()),
        ([(None, IS_NEAR, '"x"')], set(), set()),
        ([("_:b1", IS_NEAR, None)], set(), set()),
        ([(CUP, IS_NEAR, None), (None, IS_CLOSE, None)], {"isNear"}, {"cup1"}),
    ],
)
def test_the_needs_of_a_query(patterns, relations, names):
    found = needs_of(None if patterns is None else frozenset(patterns), DERIVED)
    assert found == Needs(frozenset(relations), frozenset(names))


def test_a_tbox_without_such_properties_needs_no_measurement():
    assert needs_of(None, PairProperties()) == Needs()
    assert needs_of(frozenset({(None, IS_NEAR, None)}), PairProperties()) == Needs()


def test_the_needs_of_several_queries():
    one, other = Needs(frozenset({"isNear"}), frozenset({"cup1"})), Needs(frozenset({"touches"}))
    assert Needs.merge([one, other]) == Needs(frozenset({"isNear", "touches"}), frozenset({"cup1"}))
    assert Needs.merge([]) == Needs()
