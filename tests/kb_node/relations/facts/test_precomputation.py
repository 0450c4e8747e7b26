"""Facts computed by another process equal those computed after the commit."""

import sys
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.facts.precomputation import Precomputation
from semmap.nodes.kb_node.relations.facts.precompute import compute_facts
from semmap.nodes.kb_node.relations.facts.precompute_messages import (
    ClassModel,
    ExpectedEntities,
    ExpectedEntity,
    PrecomputeRequest,
)
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas import codec
from semmap.schemas.entities import orientation_from_yaw
from tests.kb_node.relations.entities import TABLE, TOP, thing

FAR = Thresholds(gap_m=0.1)
MODELS = ["table", "cup", "book", "tray", "fridge", "box"]
AT = st.tuples(
    st.sampled_from([-0.3, 0.0, 0.1, 0.4, 2.0]),
    st.sampled_from([0.0, 0.1, 2.0]),
    st.sampled_from([0.0, TOP, TOP + 0.02, TOP + 0.08, 1.5]),
)
WORLDS = st.lists(
    st.tuples(
        st.sampled_from(MODELS),
        AT,
        st.sampled_from([None, 0.0, 0.7]),
        st.sampled_from([None, (0.5, 0.5, 0.5)]),
        st.booleans(),
    ),
    min_size=1,
    max_size=12,
)


def world(rows):
    return [
        thing(f"{model}{i}", at, model, yaw=yaw or 0.0, size=size or (0.3, 0.2, 0.4), place=place)
        for i, (model, at, yaw, size, place) in enumerate(rows)
    ]


def coming(entities):
    """Return the expected entities, with the models of their classes."""
    looks = list(dict.fromkeys(ClassModel(entity.model, entity.place, entity.fixed) for entity in entities))
    return ExpectedEntities(
        looks,
        [
            ExpectedEntity(
                f"<{entity.iri}>",
                looks.index(ClassModel(entity.model, entity.place, entity.fixed)),
                tuple(f'"{value!r}"^^<float>' for value in entity.pose.position_m),
                entity.pose.orientation_wxyz,
                entity.size_m,
            )
            for entity in entities
        ],
    )


def looking(entities):
    """Return the entities with their chosen models."""
    return [
        structs.replace(e, model=placed.model)
        for e, placed in zip(entities, coming(entities).placed(), strict=True)
    ]


def foreseen(there, entities, limits=FAR):
    return PrecomputeRequest(limits, tuple(map(PlacedEntity.of, there)), coming(entities))


def state(facts):
    return (
        set(facts),
        facts.by_rule(),
        [{name: set(of) for name, of in kept.about.items()} for kept in facts._rule_facts],
        set(facts.space.solids),
    )


class AtOnce:
    """A precomputation that runs in this process."""

    def __init__(self, said):
        self._found = compute_facts(codec.decode(codec.encode(said), PrecomputeRequest))

    def facts(self, came):
        return self._found.match(came)

    def give_up(self):
        pass


@pytest.fixture
def many():
    """Use arrays for a single entity already."""
    with patch("semmap.nodes.kb_node.relations.facts.place_facts.MANY", 1):
        yield


@settings(deadline=None, max_examples=100)
@given(WORLDS, WORLDS)
def test_facts_are_the_same_with_and_without_a_process(there, rows):
    there, wanted = [structs.replace(e, name=f"old_{e.name}") for e in world(there)], world(rows)
    come = looking(wanted)
    with patch("semmap.nodes.kb_node.relations.facts.place_facts.MANY", 1):
        alone, helped = Facts(FAR), Facts(FAR)
        for facts in (alone, helped):
            facts.update(there)
        helped.set_precomputation(AtOnce(foreseen(there, wanted)))
        with patch.object(
            Facts, "_compute_in_steps", side_effect=AssertionError("the facts were already computed")
        ):
            changed = helped.update(come)
        assert changed == alone.update(come)
        assert state(helped) == state(alone)


(CUP,) = looking([thing("cup1", (0.0, 0.0, TOP), size=(0.08, 0.08, 0.1))])
ON = {("cup1", "isOn", "table1")}


def test_a_separate_process_computes_the_facts(many):
    facts, beats = Facts(FAR), []
    facts.update([TABLE])
    facts.set_precomputation(Precomputation(foreseen([TABLE], [CUP]), lambda: beats.append(1)))
    with patch.object(
        Facts, "_compute_in_steps", side_effect=AssertionError("the facts were already computed")
    ):
        assert facts.update([CUP]).come == ON
    assert beats


@pytest.mark.parametrize(
    "came",
    [
        [structs.replace(CUP, pose=structs.replace(CUP.pose, position_m=(0.1, 0.0, TOP)))],
        [structs.replace(CUP, pose=structs.replace(CUP.pose, orientation_wxyz=orientation_from_yaw(1.0)))],
        [structs.replace(CUP, size_m=(0.08, 0.08, 0.11))],
        [structs.replace(CUP, model="bowl")],
        [CUP, thing("cup2", (0.2, 0.0, TOP))],
        [],
    ],
)
def test_an_unexpected_commit_is_computed_in_this_process(many, came):
    facts = Facts(FAR)
    facts.update([TABLE])
    wrong = Facts(FAR)
    wrong.update([TABLE])
    wrong.set_precomputation(AtOnce(foreseen([TABLE], [CUP])))
    assert wrong.update(came) == facts.update(came)
    assert state(wrong) == state(facts)


def test_entities_without_a_position_are_ignored(many):
    facts = Facts(FAR)
    facts.set_precomputation(AtOnce(foreseen([], [TABLE, CUP])))
    with patch.object(
        Facts, "_compute_in_steps", side_effect=AssertionError("the facts were already computed")
    ):
        assert facts.update([*looking([TABLE, CUP]), thing("cup9", None)]).come >= ON


@pytest.mark.parametrize("end", ["raise SystemExit(3)", "import os; os.kill(os.getpid(), 9)"])
def test_a_failed_process_is_replaced_by_this_one(many, caplog, end):
    facts = Facts(FAR)
    facts.set_precomputation(
        Precomputation(foreseen([], [TABLE, CUP]), lambda: None, [sys.executable, "-c", end])
    )
    assert facts.update([TABLE, CUP]).come >= ON
    assert "the process that precomputes facts failed" in caplog.text


def test_an_invalid_number_ends_the_process_and_this_one_computes(many):
    facts = Facts(FAR)
    said = foreseen([], [TABLE, CUP])
    arrivals = [said.coming.arrivals[0], said.coming.arrivals[1]._replace(position=('"x"', '"y"', '"z"'))]
    said = structs.replace(said, coming=structs.replace(said.coming, arrivals=arrivals))
    with pytest.raises(ValueError, match="convert"):
        compute_facts(said)
    facts.set_precomputation(Precomputation(said, lambda: None))
    assert facts.update([TABLE, CUP]).come >= ON


def test_a_discarded_process_has_ended(many):
    facts = Facts(FAR)
    ahead = Precomputation(
        foreseen([], [CUP]), lambda: None, [sys.executable, "-c", "import time; time.sleep(60)"]
    )
    facts.set_precomputation(ahead)
    facts.discard_precomputation()
    assert ahead._process.poll() is not None
    facts.discard_precomputation()
    assert facts.update([TABLE, CUP]).come >= ON


def test_few_entities_need_no_process(many):
    facts = Facts(FAR)
    ahead = Precomputation(foreseen([], [CUP]), lambda: None)
    facts.set_precomputation(ahead)
    with patch("semmap.nodes.kb_node.relations.facts.place_facts.MANY", 100):
        assert facts.update([TABLE, CUP]).come >= ON
    facts.discard_precomputation()
    assert ahead._process.poll() is not None
