"""Computed facts: incremental updates equal a rebuild."""

import random
from unittest.mock import patch

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.relations.facts import place_facts
from semmap.nodes.kb_node.relations.facts.place_facts import Changed, Facts
from semmap.nodes.kb_node.relations.facts.rules import Rule
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring import crowds
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

CUP_ON_TABLE = ("cup1", "isOn", "table1")
AT = st.tuples(
    st.sampled_from([-0.3, -0.1, 0.0, 0.1, 0.4, 1.0, 2.0, 7.0]),
    st.sampled_from([0.0, 0.1, 0.3, 2.0]),
    st.sampled_from([0.0, 0.02, 0.07, TOP, TOP + 0.02, TOP + 0.08, TOP + 0.2]),
)
LYING = (0.5**0.5, 0.0, 0.5**0.5, 0.0)
THINGS = st.builds(
    lambda name, at, yaw, turn: thing(name, at, yaw=yaw, turn=turn),
    st.sampled_from(
        ["table1", "table2", "cup1", "cup2", "bowl1", "apple1", "book1", "tray1", "bookshelf1", "odd1"]
    ),
    AT | st.none(),
    st.sampled_from([0.0, 0.7]),
    st.sampled_from([None, None, None, LYING]),
)
PLACES = st.builds(
    lambda name, at, extent: thing(name, at, size=(extent, extent, 2.5), place=True),
    st.sampled_from(["room1", "corner1"]),
    AT,
    st.sampled_from([1.0, 3.0]),
)
CHANGES = st.lists(st.tuples(st.lists(THINGS | PLACES, max_size=4), st.lists(st.sampled_from(
    ["table1", "cup1", "bowl1", "book1", "room1", "missing"]
), max_size=2)), max_size=12)  # fmt: skip


@settings(deadline=None, max_examples=300)
@given(CHANGES)
@example([([thing("bookshelf1", (-0.1, 0.1, 0.0))], []), ([thing("table1", (-0.3, 0.0, 0.0))], [])])
def test_incremental_updates_equal_a_rebuild(changes):
    facts, there = Facts(), {}
    held = set()
    for changed, removed in changes:
        changed = {entity.name: entity for entity in changed}
        removed = [name for name in removed if name not in changed]
        there = {name: e for name, e in (there | changed).items() if name not in removed}
        gone, come = facts.update(changed.values(), removed)
        assert gone <= held
        assert not come & held
        held = held - gone | come
        rebuilt = Facts()
        rebuilt.update(map(PlacedEntity.of, there.values()))
        assert held == set(facts) == set(rebuilt)
        for name in there:
            assert facts.with_contents([name]) == rebuilt.with_contents([name])
    for name in there:
        assert facts.about(name) == {s for s, _, o in held if o == name}
        assert {(name, *about) for about in facts.of(name)} == {fact for fact in held if fact[0] == name}


def test_with_contents_follows_changes():
    facts = Facts()
    book = thing("book1", (0.0, 0.0, TOP))
    cup = thing("cup1", (0.0, 0.0, TOP + book.size_m[2]))
    facts.update([ROOM, CORNER, TABLE, book, cup])
    assert facts.with_contents(["table1"]) == {"table1", "book1", "cup1"}
    changed = facts.update([], ["book1"])
    assert changed.come == {CUP_ON_TABLE}
    assert facts.update([], ["table1"]).gone == {CUP_ON_TABLE, ("table1", "isLocatedIn", "kitchen1")}


def test_each_fact_holds_and_no_other():
    facts = Facts()
    facts.update([ROOM, TABLE, thing("cup1", (0.0, 0.0, TOP)), thing("bowl1", (0.3, 0.0, TOP))])
    assert facts.holds(CUP_ON_TABLE)
    for other in (("table1", "isOn", "cup1"), ("cup1", "isInside", "table1"), ("cup1", "isOn", "missing")):
        assert not facts.holds(other)
    assert [*facts.of("cup1")] == [("isOn", "table1"), ("isLocatedIn", "kitchen1")]
    assert facts.with_contents(["kitchen1"]) == {"kitchen1", "table1", "cup1", "bowl1"}
    assert facts.with_contents(["cup1", "missing"]) == {"cup1", "missing"}
    assert facts.update([]) == Changed(set(), set())


def test_of_several_supports_the_most_important_one_comes_first():
    low, high = (
        thing(f"post{k}", (x, 0.0, 0.0), "", size=(w, 0.2, 0.5)) for k, x, w in ((1, 0.0, 0.1), (2, 0.5, 0.3))
    )
    facts = Facts()
    facts.update([thing("board1", (0.3, 0.0, 0.5), "", size=(0.9, 0.2, 0.02)), low, high])
    assert [*facts.of("board1")] == [("isOn", "post2"), ("isOn", "post1")]


@pytest.mark.parametrize("seed", range(4))
def test_changes_while_a_map_is_filled_lead_to_the_facts_of_a_rebuild(seed):
    """Facts that a change ends have been computed before, so that the change reports them."""
    dice = random.Random(seed)

    def at():
        return (dice.choice([0.0, 0.1, 1.5, 3.0]), dice.choice([0.0, 0.3, 1.5]), dice.choice([0.0, TOP, TOP]))

    there = {
        e.name: e
        for e in [ROOM, TABLE, *(thing(f"table{k}", (1.5 * k, 1.5, 0.0)) for k in (2, 3))]
        + [thing(f"cup{k}", at()) for k in range(9)]
    }
    many = 2 if seed % 2 else 100
    with patch.object(place_facts, "_STEP", 3), patch.object(place_facts, "MANY", many):
        facts = Facts()
        for _ in facts.insert_steps(there.values()):
            pass
        assert not facts.is_complete
        steps = facts.compute_steps()
        for _ in range(3):
            next(steps)
            before = Facts()
            before.update(there.values())
            removed = dice.sample([name for name in there if name.startswith("cup")], 1)
            changed = [thing(dice.choice(["table1", "table2", "cup20"]), at())]
            there = {n: e for n, e in there.items() if n not in removed} | {e.name: e for e in changed}
            gone, come = facts.update(changed, removed)
            after = Facts()
            after.update(there.values())
            assert (gone, come) == (set(before) - set(after), set(after) - set(before))
        for _ in steps:
            pass
    assert facts.is_complete
    assert set(facts) == set(after)


def test_caches_are_cleared_in_turn_when_idle():
    facts = Facts()
    facts.update([ROOM, *(thing(f"table{k}", (3.0 * k, 0.0, 0.0)) for k in range(20))])
    facts.clear_caches()
    expected = set(facts)

    def count_cached():
        return sum(bool(solid.__dict__) for solid in facts.space.solids.values())

    for solid in facts.space.solids.values():
        assert solid.outline
    assert count_cached() == 21
    facts.clear_caches()
    assert count_cached() == 21, "nothing has changed since"
    cached = [21]
    for k in range(4):
        facts.update([thing("cup1", (100.0 + k, 0.0, 0.0))])
        facts.clear_caches()
        cached.append(count_cached())
    assert cached == sorted(cached, reverse=True)
    assert cached[1] < 21
    assert cached[-1] <= 1
    assert {fact for fact in facts if fact[0] != "cup1"} == expected


@pytest.mark.parametrize("seed", range(3))
def test_what_an_update_makes_count_in_a_crowd_is_shifted(seed):
    dice = random.Random(seed)
    shifted = set()
    with patch.object(crowds, "MOST", 4):
        facts = Facts()
        facts.update([ROOM, TABLE])

        def counted():
            return {name: facts.space.counts(solid) for name, solid in facts.space.solids.items()}

        for _ in range(40):
            name, size = f"cup{dice.randrange(9)}", (dice.uniform(0.05, 0.3),) * 3
            before = counted()
            if name in before and dice.random() < 0.3:
                facts.update([], [name])
            else:
                facts.update([thing(name, (dice.uniform(0.0, 0.1), 0.0, TOP), size=size)])
            now = counted()
            others = {n for n in before.keys() & now.keys() if n != name and before[n] != now[n]}
            assert others <= facts.shifted
            shifted |= others
    assert shifted
    facts.update([])
    assert facts.shifted == frozenset()


def test_facts_about_a_moved_object_are_computed_again_whatever_a_rule_is_concerned_with():
    def list_tables_at_hand(space, solid):
        table = space.solids.get("table1")
        if table is not None and table is not solid and abs(table.position[0] - solid.position[0]) < 1.0:
            yield "isNear", "table1"

    facts = Facts(rules=[Rule(("isNear",), list_tables_at_hand, lambda survey: [], lambda *_: False)])
    facts.update([TABLE])
    near = {("cup1", "isNear", "table1")}
    assert facts.update([thing("cup1", (0.0, 0.0, TOP)), thing("cup2", (9.0, 0.0, TOP))]).come == near
    assert facts.update([thing("table1", (3.0, 0.0, 0.0))]) == (near, set())
    facts.update([thing("cup1", (3.0, 0.0, TOP))])
    assert facts.update([], ["table1"]) == (near, set())
