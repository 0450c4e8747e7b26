"""What another process works out of where things will be is what holds when they have come."""

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
from tests.kb_node.relations.made import TABLE, TOP, thing

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
    """As a load says of them; the looks of their classes are those of the models."""
    looks = list(dict.fromkeys(ClassModel(entity.model, entity.place) for entity in entities))
    return ExpectedEntities(
        looks,
        [
            ExpectedEntity(
                f"<{entity.iri}>",
                looks.index(ClassModel(entity.model, entity.place)),
                tuple(f'"{value!r}"^^<float>' for value in entity.pose.position_m),
                entity.pose.orientation_wxyz,
                entity.size_m,
            )
            for entity in entities
        ],
    )


def looking(entities):
    """They have the models that are chosen for them."""
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
        [{name: set(of) for name, of in kept.about.items()} for kept in facts._kept],
        set(facts.space.solids),
    )


class AtOnce:
    """Works out in this process what the other one would."""

    def __init__(self, said):
        self._found = compute_facts(codec.decode(codec.encode(said), PrecomputeRequest))

    def facts(self, came):
        return self._found.match(came)

    def give_up(self):
        pass


@pytest.fixture
def many():
    """Few are many."""
    with patch("semmap.nodes.kb_node.relations.facts.place_facts.MANY", 1):
        yield


@settings(deadline=None, max_examples=100)
@given(WORLDS, WORLDS)
def test_with_a_process_and_without_the_facts_are_the_same(there, rows):
    there, wanted = [structs.replace(e, name=f"old_{e.name}") for e in world(there)], world(rows)
    come = looking(wanted)
    with patch("semmap.nodes.kb_node.relations.facts.place_facts.MANY", 1):
        alone, helped = Facts(FAR), Facts(FAR)
        for facts in (alone, helped):
            facts.update(there)
        helped.set_precomputation(AtOnce(foreseen(there, wanted)))
        with patch.object(
            Facts, "_compute_in_steps", side_effect=AssertionError("it was worked out already")
        ):
            changed = helped.update(come)
        assert changed == alone.update(come)
        assert state(helped) == state(alone)


(CUP,) = looking([thing("cup1", (0.0, 0.0, TOP), size=(0.08, 0.08, 0.1))])
ON = {("cup1", "isOn", "table1")}


def test_a_process_of_its_own_works_it_out(many):
    facts, beats = Facts(FAR), []
    facts.update([TABLE])
    facts.set_precomputation(Precomputation(foreseen([TABLE], [CUP]), lambda: beats.append(1)))
    with patch.object(Facts, "_compute_in_steps", side_effect=AssertionError("it was worked out already")):
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
def test_what_was_foreseen_otherwise_is_worked_out_here(many, came):
    facts = Facts(FAR)
    facts.update([TABLE])
    wrong = Facts(FAR)
    wrong.update([TABLE])
    wrong.set_precomputation(AtOnce(foreseen([TABLE], [CUP])))
    assert wrong.update(came) == facts.update(came)
    assert state(wrong) == state(facts)


def test_who_has_no_position_does_not_matter(many):
    facts = Facts(FAR)
    facts.set_precomputation(AtOnce(foreseen([], [TABLE, CUP])))
    with patch.object(Facts, "_compute_in_steps", side_effect=AssertionError("it was worked out already")):
        assert facts.update([*looking([TABLE, CUP]), thing("cup9", None)]).come >= ON


@pytest.mark.parametrize("end", ["raise SystemExit(3)", "import os; os.kill(os.getpid(), 9)"])
def test_a_process_that_dies_leaves_the_work_to_this_one(many, caplog, end):
    facts = Facts(FAR)
    facts.set_precomputation(
        Precomputation(foreseen([], [TABLE, CUP]), lambda: None, [sys.executable, "-c", end])
    )
    assert facts.update([TABLE, CUP]).come >= ON
    assert "the process that precomputes facts failed" in caplog.text


def test_a_number_that_is_none_ends_the_process_and_the_work_is_done_here(many):
    facts = Facts(FAR)
    said = foreseen([], [TABLE, CUP])
    arrivals = [said.coming.arrivals[0], said.coming.arrivals[1]._replace(position=('"x"', '"y"', '"z"'))]
    said = structs.replace(said, coming=structs.replace(said.coming, arrivals=arrivals))
    with pytest.raises(ValueError, match="convert"):
        compute_facts(said)
    facts.set_precomputation(Precomputation(said, lambda: None))
    assert facts.update([TABLE, CUP]).come >= ON


def test_one_that_is_given_up_is_gone(many):
    facts = Facts(FAR)
    ahead = Precomputation(
        foreseen([], [CUP]), lambda: None, [sys.executable, "-c", "import time; time.sleep(60)"]
    )
    facts.set_precomputation(ahead)
    facts.discard_precomputation()
    assert ahead._process.poll() is not None
    facts.discard_precomputation()
    assert facts.update([TABLE, CUP]).come >= ON


def test_few_need_none(many):
    facts = Facts(FAR)
    ahead = Precomputation(foreseen([], [CUP]), lambda: None)
    facts.set_precomputation(ahead)
    with patch("semmap.nodes.kb_node.relations.facts.place_facts.MANY", 100):
        assert facts.update([TABLE, CUP]).come >= ON
    facts.discard_precomputation()
    assert ahead._process.poll() is not None
