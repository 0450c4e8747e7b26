"""Crowds: the largest objects are counted, whatever the order of insertion."""

from unittest.mock import patch

from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.relations.facts.contradictions import find_contradiction
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring import crowds, support_contact
from semmap.nodes.kb_node.relations.measuring.broad_phase import BroadPhase
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

NAMES = [
    "table1",
    "table2",
    "bowl1",
    "tray1",
    *(f"{model}{k}" for model in ("book", "cup") for k in range(5)),
]
THINGS = st.builds(
    lambda name, x, z: thing(name, (x, 0.3, z)),
    st.sampled_from(NAMES),
    st.sampled_from([0.3, 0.5, 0.95, 1.1, 1.5]),
    st.sampled_from([0.0, TOP, TOP + 0.03, TOP + 0.06]),
)
CHANGES = st.lists(
    st.tuples(st.lists(THINGS, max_size=8), st.lists(st.sampled_from(NAMES), max_size=3)), max_size=10
)


@settings(deadline=None, max_examples=150)
@given(CHANGES, st.sampled_from([1, 2, 4, 6]))
def test_incremental_updates_equal_a_rebuild(changes, most):
    with patch.object(crowds, "MOST", most):
        facts, there, held = Facts(), {}, set()
        for changed, removed in changes:
            changed = {entity.name: entity for entity in changed}
            there = {name: e for name, e in (there | changed).items() if name not in removed}
            made = facts.update([e for e in changed.values() if e.name in there], removed)
            held = held - made.gone | made.come
            rebuilt, in_steps = Facts(), Facts()
            rebuilt.update(reversed(there.values()))
            for _ in in_steps.fill_steps(there.values()):
                pass
            assert held == set(facts) == set(rebuilt) == set(in_steps)
            assert (
                facts.space.describe_crowds()
                == rebuilt.space.describe_crowds()
                == in_steps.space.describe_crowds()
            )


def heap(count, model="cup", x=0.3):
    return [thing(f"{model}{k}", (x, 0.3, TOP), model) for k in range(count)]


def test_thousands_of_objects_are_on_one_table():
    facts = Facts()
    looked_at = []
    pairs = BroadPhase.pairs
    with patch.object(BroadPhase, "pairs", lambda *args: looked_at.append(pairs(*args)) or looked_at[-1]):
        facts.update([ROOM, TABLE, *heap(1500)])
    assert {(f"cup{k}", "isOn", "table1") for k in range(1500)} <= set(facts)
    assert {(f"cup{k}", "isLocatedIn", "kitchen1") for k in range(1500)} <= set(facts)
    assert max(len(one) for one, _, _ in looked_at) < 1502 * 2 * crowds.MOST
    assert facts.space.describe_crowds() == [
        "1501 objects are within 1 m of (0.5, 0.5); "
        "relations (on, inside, beside) are computed only with the 100 largest"
    ]


def test_a_heap_is_not_compared_pair_by_pair():
    facts = Facts()
    facts.update([ROOM, TABLE, *(thing(f"book{k}", (5.0 + 0.5 * k, 3.0, 0.0), "book") for k in range(2000))])
    looks = []
    concerned = Facts._add_affected_by
    with patch.object(Facts, "_add_affected_by", lambda *args: looks.append(args) or concerned(*args)):
        facts.update(heap(1500))
    assert len(looks) < 2 * (crowds.MOST + 10)
    assert ("cup1499", "isOn", "table1") in set(facts)


def test_only_counted_objects_of_equal_size_are_compared():
    facts = Facts()
    facts.update([ROOM, TABLE, *heap(1000, "book")])
    counted = next(f"book{k}" for k in range(1000) if facts.space.counts(facts.space.solids[f"book{k}"]))
    compared = []
    on = support_contact.on
    with patch.object(support_contact, "on", lambda *args: compared.append(args) or on(*args)):
        facts.update([thing(counted, (0.31, 0.3, TOP), "book")])
    assert len(compared) < 2 * crowds.MOST**2 + 2 * 1000
    assert ("book999", "isOn", "table1") in set(facts)


def test_a_removed_crowd_is_no_longer_reported():
    facts = Facts()
    facts.update([ROOM, TABLE, *heap(crowds.MOST + 20)])
    assert facts.space.describe_crowds(["cup3"])
    assert not facts.space.describe_crowds(["missing"])
    facts.update([], [f"cup{k}" for k in range(40)])
    assert facts.space.describe_crowds() == []


def test_supports_in_a_crowd_are_neighbours():
    facts = Facts()
    books = heap(crowds.MOST + 20, "book")
    above = thing("cup1", (0.3, 0.3, TOP + 0.03))
    facts.update([ROOM, TABLE, *books, above, thing("table2", (3.0, 3.0, 0.0))])
    for other in ("book99", "book98", "book0", "table1"):
        assert find_contradiction(facts.space, ("cup1", "isOn", other)) is None
    assert find_contradiction(facts.space, ("cup1", "isOn", "table2")) is not None


def test_temporary_changes_are_undone():
    facts = Facts()
    facts.update([ROOM, TABLE, *heap(crowds.MOST + 20)])
    before = set(facts)
    with facts.space.with_changes(heap(30, x=2.0), ["table1"]):
        pass
    facts.update([thing("book1", (4.0, 4.0, 0.0))])
    assert facts.shifted == frozenset()
    assert before <= set(facts)
