"""Computed facts: incremental updates equal a rebuild."""

from hypothesis import example, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
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


def test_with_contents_follows_changes():
    facts = Facts()
    book = thing("book1", (0.0, 0.0, TOP))
    cup = thing("cup1", (0.0, 0.0, TOP + book.size_m[2]))
    facts.update([ROOM, CORNER, TABLE, book, cup])
    assert facts.with_contents(["table1"]) == {"table1", "book1", "cup1"}
    changed = facts.update([], ["book1"])
    assert changed.come == {CUP_ON_TABLE}
    assert facts.update([], ["table1"]).gone == {CUP_ON_TABLE, ("table1", "isLocatedIn", "kitchen1")}
