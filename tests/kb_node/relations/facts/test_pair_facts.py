"""Facts of pairs: the stored ones equal those of a full search."""

import random
from itertools import permutations

import pytest
from msgspec import structs

from benchmarks.relations.situations import about_y
from semmap.nodes.kb_node.relations.facts.pair_facts import PairFacts, measure_pair
from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.nodes.kb_node.relations.measuring import crowds
from semmap.nodes.kb_node.relations.measuring.crowds import MOST
from semmap.nodes.kb_node.relations.measuring.relation_table import MIRRORED, PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import explain_relation
from semmap.ontology import vocabulary as v
from tests.depth import tries
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

EVERY = frozenset(PAIR_RELATIONS)
SUB, INVERSE = v.iri(v.RDFS + "subPropertyOf"), v.iri(v.OWL + "inverseOf")


def some_things(dice):
    made = [ROOM, TABLE, thing("table2", (1.7, 0.2, 0.0)), thing("shelf1", (-2.0, 0.0, 0.0), "bookshelf")]
    made += [thing(f"chair{k}", (dice.uniform(-2, 2), dice.uniform(-2, 2), 0.0)) for k in range(3)]
    made += [thing("board1", (0.8, 1.5, 0.0), "box", size=(2.2, 0.3, 0.1))]
    made += [
        thing(f"plank{k}", (0.3 * k - 1.0, 1.3, 0.001), "", size=(0.02, 0.2, 0.9), turn=about_y(-15.0))
        for k in range(3)
    ]
    made += [thing(f"post{k}", (0.3 * k - 1.25, 1.3, 0.0), "", size=(0.04, 0.3, 1.0)) for k in range(3)]
    return made + [
        thing(f"cup{k}", (dice.uniform(-0.5, 0.5), dice.uniform(-0.3, 0.3), TOP)) for k in range(6)
    ]


def facts(pairs, there):
    names = [entity.name for entity in there]
    return {
        (a, r, b)
        for a in names
        for b in names
        for r in PAIR_RELATIONS
        if (a < b or r not in MIRRORED) and pairs.holds(a, r, b)
    }


def rebuilt(there, whole=EVERY, some=()):
    pairs = PairFacts(Space(there))
    pairs.set_scope(whole, some)
    return facts(pairs, there)


@pytest.mark.parametrize("seed", range(tries(6)))
@pytest.mark.parametrize(
    ("whole", "some"),
    [
        (EVERY, ()),
        (("isNextTo",), ()),
        (("isLeaningAgainst",), ()),
        ((), ("table1", "cup3")),
        (("isNear",), ("cup1",)),
    ],
)
def test_stored_pairs_equal_a_full_search(seed, whole, some):
    dice = random.Random(seed)
    there = {entity.name: entity for entity in some_things(dice)}
    pairs = PairFacts(Space(there.values()))
    pairs.set_scope(whole, some)
    known = facts(pairs, there.values())
    spots = [entity.pose.position_m for entity in there.values() if not entity.place]
    for _ in range(tries(40)):
        name = dice.choice([name for name in there if name not in ("kitchen1",)])
        if name.startswith("cup") and dice.random() < 0.1:
            del there[name]
            changed = pairs.update((), [name])
        else:
            x, y, z = dice.choice(spots)
            at = (x + dice.choice([0.0, 0.1, 0.4]), y, z)
            pose = structs.replace(there[name].pose, position_m=at)
            there[name] = structs.replace(there[name], pose=pose)
            changed = pairs.update([there[name]])
        now = rebuilt(there.values(), whole, some)
        assert facts(pairs, there.values()) == now
        assert {f for f in known - now if {f[0], f[2]} <= there.keys()} <= changed.gone <= known - now
        assert changed.come == now - known
        known = now


def test_a_smaller_scope_keeps_fewer_facts():
    there = some_things(random.Random(1))
    pairs = PairFacts(Space(there))
    pairs.set_scope(EVERY, ())
    pairs.set_scope(("isNear",), ("cup1",))
    assert facts(pairs, there) == rebuilt(there, ("isNear",), ("cup1",))
    pairs.set_scope(("isNear", "touches"), ())
    assert facts(pairs, there) == rebuilt(there, ("isNear", "touches"))
    pairs.set_scope((), ())
    assert facts(pairs, there) == set()


def test_an_object_on_another_is_not_near_it():
    space = Space([TABLE, thing("cup1", (0.0, 0.0, TOP)), thing("chair1", (0.9, 0.0, 0.0))])
    cup, table, chair = (space.solids[name] for name in ("cup1", "table1", "chair1"))
    assert {name for name, made in measure_pair(space, cup, table) if made.holds} == {"touches"}
    assert "isNear" in {name for name, made in measure_pair(space, table, chair) if made.holds}


def test_a_board_on_a_narrower_post_is_above_it_in_facts_and_explanations():
    things = [
        thing("post1", (0.0, 0.0, 0.0), "", size=(0.1, 0.1, 0.5)),
        thing("board1", (0.0, 0.0, 0.5), "", size=(0.6, 0.6, 0.02)),
        thing("cup1", (0.0, 0.0, 0.52)),
    ]
    space, stored = Space(things), PairFacts(Space(things))
    stored.set_scope(EVERY, ())
    assert stored.holds("board1", "isAbove", "post1")
    for one, other in permutations([entity.name for entity in things], 2):
        for relation in PAIR_RELATIONS:
            explained = explain_relation(space, one, relation, other)
            assert explained.holds == stored.holds(one, relation, other), explained.text


def test_implied_properties_of_a_tbox_are_included():
    close, around = v.dm("isClose"), v.dm("isAround")
    derived = PairProperties(
        [
            (v.dm("isNear"), v.RDF_TYPE, v.iri(v.OWL + "ObjectProperty")),
            (v.dm("isNear"), SUB, close),
            (around, INVERSE, close),
            (v.dm("isNextTo"), SUB, v.dm("isNear")),
        ]
    )
    assert derived.sources == dict.fromkeys((v.dm("isNear"), close, around), frozenset({"isNear"}))
    found = set(derived.triples(("a", "isNear", "b"), {"a": "<a>", "b": "<b>"}))
    assert found == {(s, p, o) for p in derived.sources for s, o in (("<a>", "<b>"), ("<b>", "<a>"))}


def test_a_tbox_without_the_properties_has_no_facts():
    assert PairProperties([(v.dm("isOn"), v.RDF_TYPE, v.iri(v.OWL + "ObjectProperty"))]).sources == {}


def crowd(dice, count):
    spread = [(dice.uniform(-0.4, 0.4), dice.uniform(-0.3, 0.3), TOP) for _ in range(count)]
    return [ROOM, TABLE, *(thing(f"cup{k}", at) for k, at in enumerate(spread))]


def test_comparisons_in_a_crowd_are_bounded():
    dice = random.Random(3)
    there = crowd(dice, 700)
    space = Space(there)
    pairs = PairFacts(space)
    near = pairs.set_scope(("isNear",), ()).come
    told = {name for name, _, other in near for name in (name, other)}
    assert told
    assert all(space.counts(space.solids[name]) for name in told)
    assert len(told) <= 4 * MOST + 1  # four cells meet on the table
    aside = next(name for name, solid in space.solids.items() if not space.counts(solid))
    assert pairs.update([thing(aside, (0.0, 0.0, TOP), size=(0.2, 0.2, 0.2))]).come


@pytest.mark.parametrize("seed", range(3))
def test_stored_pairs_of_a_crowd_equal_a_full_search(seed, monkeypatch):
    monkeypatch.setattr(crowds, "MOST", 8)
    dice = random.Random(seed)
    there = {entity.name: entity for entity in crowd(dice, 24)}
    pairs = PairFacts(Space(there.values()))
    pairs.set_scope(EVERY, ())
    for _ in range(tries(30)):
        name = f"cup{dice.randrange(24)}"
        if name in there and dice.random() < 0.3:
            del there[name]
            pairs.update((), [name])
        else:
            size = (dice.uniform(0.05, 0.3), 0.08, 0.1)
            there[name] = thing(name, (dice.uniform(-0.4, 0.4), dice.uniform(-0.3, 0.3), TOP), size=size)
            pairs.update([there[name]])
        assert facts(pairs, there.values()) == rebuilt(there.values())
