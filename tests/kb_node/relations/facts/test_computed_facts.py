"""Computed triples and denied assertions: each step leads to those of a map that is read at once."""

import random
from unittest.mock import patch

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.facts import computed_facts
from semmap.nodes.kb_node.relations.facts.computed_facts import ComputedFacts
from semmap.ontology import vocabulary as v
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

EVERY = frozenset(map(v.dm, ("isOn", "isInside", "isLocatedIn", "isAttachedTo", "hasColor")))
NAMES = ("table1", "table2", "cup1", "cup2", "bowl1", "apple1", "clock1", "kitchen1")
IS_ON, SUPPORTS, IS_IN, IS_NEAR = map(v.dm, ("isOn", "supports", "isLocatedIn", "isNear"))


def known_as(entity, iri=None):
    """Return an entity with the IRI that its name has in the map, or with another one."""
    return structs.replace(entity, iri=v.bare(v.entity_iri(entity.name)) if iri is None else iri)


def said(name, property_, other):
    return v.entity_iri(name), property_, v.entity_iri(other)


class Followed:
    """A map, its asserted triples, and the computed facts that follow its changes."""

    def __init__(self, entities=(), asserted=(), properties=EVERY):
        self.properties = properties
        self.there = {entity.name: entity for entity in entities}
        self.asserted = set(asserted)
        self.computed = ComputedFacts(properties)
        for _ in self.computed.facts.fill_steps(self.there.values()):
            pass
        first = self.computed.begin(self.there.get, self.asserted)
        self.triples, self.denied = set(first.come), set(first.denied)
        assert (first.gone, first.undenied) == ((), set())

    def change(self, changed=(), removed=(), retracted=(), inserted=()):
        """Apply a step, and check it."""
        before = dict(self.there)
        step = self.computed.after(changed, [*removed], before.get, retracted, inserted)
        self.there = {n: e for n, e in before.items() if n not in removed} | {e.name: e for e in changed}
        self.asserted = self.asserted - set(retracted) | set(inserted)
        assert not set(step.come) & set(step.gone)
        assert not step.denied & self.denied
        assert step.undenied <= self.denied
        self.triples = self.triples - set(step.gone) | set(step.come)
        self.denied = self.denied - step.undenied | step.denied
        return step


def random_entity(dice, name):
    if name == "kitchen1":
        extent = dice.choice([2.0, 6.0])
        return known_as(thing(name, (0.0, 0.0, 0.0), size=(extent, extent, 2.5), place=True))
    at = (dice.choice([0.0, 0.1, 2.0]), dice.choice([0.0, 0.2]), dice.choice([0.0, 0.0, TOP, TOP + 0.02]))
    entity = thing(name, None if dice.random() < 0.1 else at)
    if dice.random() < 0.3:
        entity = structs.replace(entity, size_m=None)
    return known_as(entity, f"http://example.org/{name}" if dice.random() < 0.1 else None)


def random_triple(dice):
    return said(dice.choice(NAMES), dice.choice([IS_ON, SUPPORTS, IS_IN, IS_NEAR]), dice.choice(NAMES))


@pytest.mark.parametrize("properties", [EVERY, EVERY - {IS_IN}], ids=["all properties", "not all"])
@pytest.mark.parametrize("many", [1, 32])
@pytest.mark.parametrize("seed", range(2))
def test_each_step_leads_to_the_triples_of_the_whole_map(seed, many, properties):
    dice, denials = random.Random(seed), 0
    with patch.object(computed_facts, "_MANY", many):
        followed = Followed([known_as(thing("table1", (0.0, 0.0, 0.0)))], properties=properties)
        for _ in range(50):
            names = dice.sample(NAMES, dice.randrange(4))
            removed = [n for n in names if n in followed.there and dice.random() < 0.3]
            changed = [random_entity(dice, n) for n in names if n not in removed]
            inserted = {random_triple(dice) for _ in range(dice.randrange(3))} - followed.asserted
            retracted = {t for t in followed.asserted if dice.random() < 0.2}
            followed.change(changed, removed, retracted, inserted)
            whole = Followed(followed.there.values(), followed.asserted, properties)
            assert followed.triples == whole.triples
            assert followed.denied == whole.denied == followed.computed.denied
            assert followed.computed.of(NAMES, followed.there.get) == whole.triples
            denials += len(followed.denied)
    assert denials


CUP = known_as(thing("cup1", (0.0, 0.0, TOP)))
HOME = [known_as(ROOM), known_as(TABLE), CUP]
ON, LOCATED = said("cup1", IS_ON, "table1"), said("cup1", IS_IN, "kitchen1")


@pytest.fixture
def followed():
    return Followed(HOME)


def test_the_triples_of_some_subjects(followed):
    of, find = followed.computed.of, followed.there.get
    assert of(["cup1"], find) == {ON, LOCATED}
    assert of(["table1", "missing"], find) == {said("table1", IS_IN, "kitchen1")}
    assert of([], find) == set()
    assert of(["cup1"], lambda name: None if name == "table1" else find(name)) == {LOCATED}


def test_a_tbox_without_these_properties_has_no_computed_triples():
    assert ComputedFacts({v.dm("hasColor")}).is_idle
    assert not ComputedFacts({IS_ON}).is_idle
    assert Followed(HOME, properties={v.dm("hasColor")}).triples == set()
    assert Followed(HOME, properties={IS_ON}).triples == {ON}


def test_another_label_changes_nothing_and_is_not_measured(followed):
    facts = followed.computed.facts
    with patch.object(facts, "update", wraps=facts.update) as update:
        step = followed.change([structs.replace(CUP, preferred_reference="my cup")])
    assert [*map(len, step)] == [0, 0, 0, 0]
    assert [call.args for call in update.call_args_list] == [([], [])]


def test_another_iri_replaces_the_triples(followed):
    step = followed.change([known_as(CUP, "http://example.org/cup1")])
    other = "<http://example.org/cup1>"
    assert set(step.gone) == {ON, LOCATED}
    assert set(step.come) == {(other, p, o) for _, p, o in (ON, LOCATED)}


@pytest.mark.parametrize(
    ("retracted", "changed", "come"),
    [
        ([ON], [], {ON}),  # it is computed from now on
        ([said("cup1", IS_ON, "cup2")], [], set()),
        ([said("cup1", IS_NEAR, "table1")], [], set()),
        ([("<http://example.org/cup1>", IS_ON, ON[2])], [], set()),
        ([ON], [known_as(thing("cup1", (2.0, 2.0, 0.0)))], set()),
    ],
)
def test_a_retracted_triple_that_is_computed_comes(retracted, changed, come):
    followed = Followed(HOME, retracted)
    assert set(followed.change(changed, retracted=retracted).come) == come


def test_an_assertion_is_denied_while_the_poses_contradict_it(followed):
    far = known_as(thing("cup1", (2.0, 2.0, 0.0)))
    wrong = said("table1", SUPPORTS, "cup1")
    assert followed.change(inserted=[wrong]).denied == set()
    assert followed.change([far]).denied == {wrong}
    assert followed.change([structs.replace(far, preferred_reference="mine")]).undenied == set()
    assert followed.change([CUP]).undenied == {wrong}
    assert followed.change([far]).denied == {wrong}
    assert followed.change(retracted=[wrong]).undenied == {wrong}
    assert followed.denied == set()


def test_an_assertion_about_another_individual_of_that_name_is_not_denied(followed):
    other = ("<http://example.org/cup1>", IS_ON, v.entity_iri("table1"))
    far = known_as(thing("cup1", (2.0, 2.0, 0.0)))
    assert followed.change([far], inserted=[other]).denied == set()
    assert followed.change([known_as(far, "http://example.org/cup1")]).denied == {other}


def test_what_stands_on_a_moved_object_may_be_denied(followed):
    in_room = said("cup1", IS_ON, "tray1")
    tray = known_as(thing("tray1", (0.0, 0.0, TOP)))
    cup = known_as(thing("cup1", (0.0, 0.0, TOP + 0.03)))
    followed.change([tray, cup], inserted=[in_room])
    assert followed.denied == set()
    moved = followed.change([structs.replace(tray, pose=known_as(thing("tray1", (2.0, 2.0, 0.0))).pose)])
    assert moved.denied == {in_room}


def test_a_plan_without_heights_denies_no_support():
    flat = [structs.replace(one, size_m=None) for one in (HOME[1], known_as(thing("cup1", (2.0, 2.0, 0.0))))]
    wrong = said("cup1", IS_ON, "table1")
    followed = Followed([], [wrong])
    for _ in followed.computed.facts.fill_steps(flat):
        pass
    followed.computed.placed()
    followed.there = {entity.name: entity for entity in flat}
    assert followed.change([known_as(thing("book1", (-2.0, -2.0, 0.0)))]).denied == {wrong}
    assert followed.change(removed=["book1"]).undenied == {wrong}
