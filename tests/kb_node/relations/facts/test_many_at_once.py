"""Facts computed in arrays equal those computed one by one."""

import math
import random
from contextlib import contextmanager
from unittest.mock import patch

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.kb_node.relations.facts import place_facts
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.columns import solids_of
from semmap.nodes.kb_node.relations.geometry.fitting import fit_model
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.nodes.kb_node.relations.measuring import crowds, space
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.survey import NO_ROW, Survey
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology.model_shapes import own_size_m, shapes
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.depth import tries

MODELS = [*sorted(shapes()), "odd"]
"""All shipped models, and an unknown one."""
TABLEWARE = ["table", "cup", "book", "bowl", "tray", "plate", "rug"]
FURNITURE = ["fridge", "drawer", "milk", "carton", "can", "cupboard", "bookshelf", "book"]
OPENING = ["fridge", "drawer", "desk", "oven", "dishwasher", "cabinet", "plate", "can", "apple", "laptop"]
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
LYING = (0.5**0.5, 0.0, 0.5**0.5, 0.0)
HEAD_DOWN = (0.0, 1.0, 0.0, 0.0)
HARDLY_LEANING = (math.cos(1e-4), math.sin(1e-4), 0.0, 0.0)
STEPS = (0.0, 1e-12, -1e-12, 1e-9, 5e-7, -5e-7, 1e-6, 2e-6, -2e-6, 1e-4)
"""Distances from a threshold [m]."""


def one_by_one(entities, limits=None):
    """Return the facts computed without arrays."""
    with many(10**9):
        facts = Facts(limits)
        facts.update(entities)
        return facts


def at_once(entities, limits=None):
    with many(1):
        facts = Facts(limits)
        facts.update(entities)
        return facts


def in_steps(entities, limits=None):
    with many(1):
        facts = Facts(limits)
        for _ in facts.fill_steps(entities):
            pass
        return facts


@contextmanager
def many(count):
    """Use arrays from this number of entities on."""
    with patch.object(place_facts, "MANY", count), patch.object(space, "MANY", count):
        yield


def kept(facts):
    """Return the stored facts, in their order, by subject and by object."""
    return [(one.of, {name: set(about) for name, about in one.about.items()}) for one in facts._rule_facts]


def require_alike(entities, limits=None):
    expected = one_by_one(entities, limits)
    for facts in (at_once(entities, limits), in_steps(entities, limits)):
        assert kept(facts) == kept(expected)
        assert facts.space.describe_crowds() == expected.space.describe_crowds()
        for name, solid in expected.space.solids.items():
            other = facts.space.solids[name]
            assert (other.bounds, other.bottom, other.top) == (solid.bounds, solid.bottom, solid.top)
    return expected


class World:
    """Objects on and in each other on a few square metres, some of them at thresholds."""

    def __init__(self, seed, models=MODELS, middle=(0.0, 0.0), extent=2.0, odd=0.15):
        self.dice = random.Random(seed)
        self.models, self.middle, self.extent, self.odd = models, middle, extent, odd
        self.made = []

    def things(self, count):
        for k in range(count):
            self.made.append(self.place(k) if self.dice.random() < 0.1 else self.thing(k))
        return self.made

    def place(self, k):
        size = self.dice.choice([(3.0, 3.0, 2.5), (6.0, 4.0, 2.5), (1.0, 1.0, 2.0), (50.0, 50.0, 9.0), None])
        at = (*self.somewhere(), self.dice.choice([0.0, 0.0, 0.03, 0.05, -0.5]))
        return self.entity(f"place{k}", "", at, size, self.turn(), place=True)

    def thing(self, k):
        dice, model = self.dice, self.dice.choice(self.models)
        own = own_size_m(model)
        size = dice.choice([own, own, own, None, tuple(round(dice.uniform(0.02, 1.5), 3) for _ in range(3))])
        if dice.random() < 0.1 and size is not None:
            size = (size[1], size[0], size[2])
        is_fixed = dice.random() < 0.15
        return self.entity(f"{model or 'thing'}{k}", model, self.at(), size, self.turn(), fixed=is_fixed)

    def entity(self, name, model, at, size, turn, place=False, fixed=False):
        pose = Pose(position_m=at, orientation_wxyz=turn)
        return PlacedEntity(
            name=name,
            iri=f"urn:{name}",
            pose=pose,
            size_m=size,
            place=place,
            model=model,
            joints=self.joints(model, size or own_size_m(model)),
            fixed=fixed,
        )

    def joints(self, model, size):
        """Return joint positions, most of them open or closed."""
        leaves = fit_model(model, size).leaves if size and model in shapes() else ()
        if not leaves or self.dice.random() < 0.3:
            return ()
        stands = tuple(
            self.dice.choice([0.0, leaf.limits[0], leaf.limits[1], self.dice.uniform(*leaf.limits)])
            for leaf in leaves
        )
        return stands if any(stands) else ()

    def turn(self):
        if self.dice.random() < self.odd:
            return self.dice.choice([LYING, HEAD_DOWN, HARDLY_LEANING])
        return self.dice.choice(
            [(1.0, 0.0, 0.0, 0.0), orientation_from_yaw(self.dice.choice([0.7, math.pi / 2]))]
        )

    def somewhere(self):
        return tuple(round(m + self.dice.uniform(-self.extent, self.extent), 2) for m in self.middle)

    def at(self):
        """Return a position anywhere, or on, in or beside another object."""
        dice = self.dice
        if not self.made or dice.random() < 0.3:
            return (*self.somewhere(), dice.choice([0.0, 0.0, 0.02, 0.75, dice.uniform(0.0, 2.0)]))
        other = solid_of(dice.choice(self.made))
        shape = other.form.shape
        heights = [
            0.0,
            other.size[2],
            *(s.height for s in shape.surfaces),
            *(i.low[2] for i in shape.interiors),
        ]
        x, y = dice.choice([(0.0, 0.0), (0.25, -0.2), (0.5, 0.5), (0.5, 0.0), (0.55, 0.1), (1.0, 0.0)])
        own = (x * other.size[0] + dice.choice(STEPS), y * other.size[1], dice.choice(heights))
        up = dice.choice([0.0, 0.0, 0.02, -0.003, -0.005, 0.05, -0.05, 0.0015, 0.01]) + dice.choice(STEPS)
        px, py, pz = other.to_map(own)
        return px, py, pz + up


@settings(deadline=None, max_examples=tries(60))
@given(st.integers(0, 10**9), st.sampled_from([0.5, 2.0, 6.0]), st.sampled_from([0.0, 0.15]))
def test_crowded_worlds_of_all_models(seed, extent, odd):
    require_alike(World(seed, extent=extent, odd=odd).things(40))


@settings(deadline=None, max_examples=tries(50))
@given(st.integers(0, 10**9), st.sampled_from([TABLEWARE, FURNITURE, OPENING]))
def test_objects_on_and_in_a_few_models(seed, models):
    require_alike(World(seed, models, extent=1.0, odd=0.0).things(40))


@settings(deadline=None, max_examples=tries(25))
@given(
    st.integers(0, 10**9),
    st.sampled_from([(9000.0, -9000.0), (1.2e5, 3.0), (1e12, -1e12), (-(2.0**31), 2.0**31)]),
)
@example(220, (-(2.0**31), 2.0**31))
def test_far_away(seed, middle):
    world = World(seed, middle=middle)
    require_alike([*World(seed + 1).things(10), *world.things(20)])


def test_positions_beyond_the_cell_numbers():
    made = World(1).things(20)
    away = Pose(position_m=(1e308, -1e308, 1e308))
    require_alike([*made, *(structs.replace(one, name=f"far-{one.name}", pose=away) for one in made)])


@settings(deadline=None, max_examples=tries(25))
@given(st.integers(0, 10**9), st.builds(
    Thresholds,
    gap_m=st.sampled_from([0.0, 0.001, 0.05, 0.3]),
    contact_m=st.sampled_from([0.0, 0.0015, 0.02]),
    base_share=st.sampled_from([0.0, 0.25, 1.0]),
    inside_share=st.sampled_from([0.0, 0.5, 1.0]),
    place_share=st.sampled_from([0.0, 0.5, 1.0]),
    attached_m=st.sampled_from([0.0, 0.02, 0.5]),
))  # fmt: skip
def test_other_thresholds(seed, limits):
    require_alike(World(seed, extent=1.0).things(25), limits)


@settings(deadline=None, max_examples=tries(25))
@given(st.integers(0, 10**9), st.sampled_from([1, 3, 8]), st.sampled_from([0.3, 1.0, 3.0]))
def test_in_crowds(seed, most, extent):
    with patch.object(crowds, "MOST", most):
        require_alike(World(seed, extent=extent).things(30))


@settings(deadline=None, max_examples=tries(25))
@given(st.integers(0, 10**9), st.sampled_from([3, 100]), st.integers(1, 12))
def test_step_by_step(seed, most, step):
    """Entities are added, removed and moved, in large and small updates."""
    world = World(seed, extent=1.0)
    made = {entity.name: entity for entity in world.things(30)}
    names = list(made)
    with patch.object(crowds, "MOST", most), many(step):
        facts, held = Facts(), set()
        for _ in range(6):
            some = world.dice.sample(names, world.dice.randrange(1, 20))
            gone = world.dice.sample(some, len(some) // 4)
            changed = [
                structs.replace(
                    made[n],
                    pose=made[world.dice.choice(names)].pose,
                    joints=world.joints(made[n].model, made[n].size_m or own_size_m(made[n].model)),
                )
                for n in some
                if n not in gone
            ]
            there = {entity.name: entity for entity in changed}
            made |= there
            change = facts.update(changed, gone)
            assert change.gone <= held
            assert not change.come & held
            held = held - change.gone | change.come
            now = [made[name] for name in facts.space.solids]
            expected = one_by_one(now)
            assert kept(facts) == kept(expected)
            assert held == set(expected)


def test_an_ordinary_map_needs_no_measurement_one_by_one():
    world, made = World(0), []
    top = own_size_m("table")[2]
    for room in range(4):
        x = 7.0 * room
        made.append(world.entity(f"room{room}", "", (x, 0.0, 0.0), (6.0, 6.0, 2.5), UPRIGHT, place=True))
        for k in range(4):
            x, y, turn = 7.0 * room + 1.5 * (k % 2), 1.5 * (k // 2), orientation_from_yaw(0.4 * k)
            made.append(world.entity(f"table{room}{k}", "table", (x, y, 0.0), None, turn))
            for n, model in enumerate(("cup", "book", "bottle")):
                at = (x - 0.2 + 0.2 * n, y, top)
                made.append(world.entity(f"{model}{room}{k}", model, at, None, turn))
    there = Space(made)
    survey = Survey(there, [solid for solid in there.solids.values() if not solid.is_place])
    assert not survey.is_open.any()
    assert not survey.may_hang.any()
    assert (survey.place != NO_ROW).all()
    assert (survey.support != NO_ROW).sum() == 3 * 16
    require_alike(made)


@pytest.mark.parametrize("seed", range(3))
def test_solids_created_together_equal_those_created_alone(seed):
    made = [e for e in World(seed, extent=5000.0).things(400) if e.pose is not None]
    for alone, solid in zip(map(solid_of, made), solids_of(made), strict=True):
        for what in (
            "name",
            "position",
            "bounds",
            "bottom",
            "top",
            "is_level",
            "is_place",
            "is_measured",
            "form",
        ):
            assert getattr(solid, what) == getattr(alone, what)
