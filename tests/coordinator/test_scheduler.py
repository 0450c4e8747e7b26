"""Which changes are grouped, which run concurrently, and which wait."""

from __future__ import annotations

from concurrent.futures import Future

import pytest

from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.scheduler import MAX_GROUP_SIZE, Scheduler
from semmap.schemas import errors
from semmap.schemas.commands import Add, Batch, Clear, Set, Track, Undo, Unset, Update
from semmap.schemas.entities import Pose
from semmap.schemas.replies import Changed


class KnowledgeBase:
    """Collects groups of changes; the test completes them."""

    def __init__(self):
        self.groups: list[tuple[list[str | None], Future]] = []

    def __call__(self, changes, has_gone):
        self.has_gone = has_gone
        self.groups.append(([getattr(change, "name", None) for change in changes], Future()))
        return self.groups[-1][1]

    @property
    def names(self):
        return [names for names, _ in self.groups]

    def finish(self, i: int) -> None:
        names, future = self.groups[i]
        future.set_result([Changed(commit=i + 1, text=str(name)) for name in names])


@pytest.fixture
def kb():
    return KnowledgeBase()


@pytest.fixture
def turns(kb):
    return Scheduler(kb)


def move(turns, name):
    return turns.change(Update(name=name, at=(0.0, 0.0, 0.0)))


def test_changes_of_different_entities_are_grouped(kb, turns):
    futures = [move(turns, name) for name in "abc"]
    assert kb.groups == []
    turns.run_ready()
    assert kb.names == [["a", "b", "c"]]
    kb.finish(0)
    assert [future.result().text for future in futures] == ["a", "b", "c"]


def test_changes_of_one_entity_are_sequential(kb, turns):
    for name in "aba":
        move(turns, name)
    turns.run_ready()
    assert kb.names == [["a", "b"]]
    kb.finish(0)
    turns.run_ready()
    assert kb.names == [["a", "b"], ["a"]]


def test_a_second_group_is_under_way_beside_a_smaller_one(kb, turns):
    move(turns, "a")
    turns.run_ready()
    for name in "bc":
        move(turns, name)
    turns.run_ready()
    assert kb.names == [["a"], ["b", "c"]]
    move(turns, "d")
    kb.finish(0)
    turns.run_ready()
    assert kb.names == [["a"], ["b", "c"]]
    kb.finish(1)
    turns.run_ready()
    assert kb.names == [["a"], ["b", "c"], ["d"]]


def test_groups_are_of_a_size(kb, turns):
    for i in range(3 * MAX_GROUP_SIZE):
        move(turns, f"e{i}")
    turns.run_ready()
    assert [len(names) for names in kb.names] == [MAX_GROUP_SIZE, MAX_GROUP_SIZE]


@pytest.mark.parametrize("change", [Add(class_="Chair"), Add(class_="Chair", name="c")])
def test_entities_without_name_or_position_are_sent_alone(kb, turns, change):
    move(turns, "a")
    turns.change(change)
    move(turns, "b")
    for i in range(3):
        turns.run_ready()
        assert len(kb.groups) == i + 1
        kb.finish(i)
    assert kb.names == [["a"], [change.name], ["b"]]


def test_all_other_commands_keep_their_order(kb, turns):
    assert turns.run_after(lambda: "at once") == "at once"
    move(turns, "a")
    later = turns.run_after(lambda: "done")
    refused = turns.run_after(lambda: 1 / 0)
    move(turns, "b")
    turns.run_ready()
    assert (kb.names, later.done()) == ([["a"]], False)
    kb.finish(0)
    turns.run_ready()
    assert (later.result(), type(refused.exception())) == ("done", ZeroDivisionError)
    assert kb.names == [["a"], ["b"]]


def test_an_error_is_the_result_of_its_change_and_a_fault_that_of_its_group(kb, turns):
    first, second = move(turns, "a"), move(turns, "b")
    turns.run_ready()
    kb.groups[0][1].set_result([Changed(commit=1, text="a"), errors.Refused("no")])
    assert first.result().text == "a"
    assert isinstance(second.exception(), errors.Refused)
    third = move(turns, "a")
    turns.run_ready()
    kb.groups[1][1].set_exception(ZeroDivisionError())
    assert isinstance(third.exception(), ZeroDivisionError)


@pytest.mark.parametrize("immediate", [True, False])
def test_an_unexpected_exception_is_the_result_and_frees_the_queue(immediate):
    futures = []

    def together(changes, _):
        if immediate and not futures:
            futures.append(None)
            raise MemoryError("no memory")
        futures.append(Future())
        return futures[-1]

    turns = Scheduler(together)
    first = move(turns, "a")
    turns.run_ready()
    if not immediate:
        futures[0].set_exception(MemoryError("no memory"))
    assert isinstance(first.exception(timeout=0), MemoryError)
    second = move(turns, "a")
    turns.run_ready()
    futures[1].set_result([Changed(commit=1, text="a")])
    assert second.result(timeout=0).commit == 1


HERE = Pose(position_m=(0.0, 0.0, 0.0))


def settled(*names):
    return ObservedState(dict.fromkeys(names, HERE), dict.fromkeys(names, (1, -1, -1)))


@pytest.mark.parametrize(
    "change",
    [
        Add(class_="Chair", name="c", at=(0.0, 0.0, 0.0)),
        Update(name="c", size=(1.0, 1.0, 1.0)),
        Set(name="c", property="note", values=("x",)),
        Unset(name="c", property="note"),
        Track(name="c", from_="stream"),
        settled("c"),
    ],
    ids=lambda change: type(change).__name__,
)
def test_a_change_of_one_entity_goes_together_with_changes_of_others(kb, turns, change):
    move(turns, "a")
    turns.change(change)
    move(turns, "b")
    turns.run_ready()
    assert [len(names) for names in kb.names] == [3]


@pytest.mark.parametrize(
    "change",
    [
        Add(class_="Chair", at=(0.0, 0.0, 0.0)),
        Add(class_="Chair", name="c", at=(0.0, 0.0, 0.0), dry_run=True),
        Update(name="c", size=(1.0, 1.0, 1.0), dry_run=True),
        settled("c", "d"),
        Batch(changes=()),
        Clear(),
        Undo(),
    ],
    ids=lambda change: type(change).__name__,
)
def test_a_change_of_several_entities_and_a_dry_run_go_alone(kb, turns, change):
    move(turns, "a")
    turns.change(change)
    move(turns, "b")
    turns.run_ready()
    assert [len(names) for names in kb.names] == [1]


def test_a_change_of_the_same_entity_ends_a_group_also_if_others_follow(kb, turns):
    """Otherwise the second change of `a` would be overtaken."""
    for name in "aab":
        move(turns, name)
    turns.run_ready()
    assert kb.names == [["a"]]
    kb.finish(0)
    turns.run_ready()
    assert kb.names == [["a"], ["a", "b"]]


def test_a_group_that_goes_alone_has_nothing_beside_it(kb, turns):
    turns.change(Clear())
    turns.run_ready()
    move(turns, "a")
    move(turns, "b")
    turns.run_ready()
    assert kb.names == [[None]]


def test_at_most_two_groups_are_under_way(kb, turns):
    for name in "abc":
        move(turns, name)
        turns.run_ready()
    assert kb.names == [["a"], ["b"]]
    assert len(turns) == 1


def test_the_clients_of_a_group_have_gone_when_each_of_them_has(kb):
    gone = {"a": False, "b": False}
    clients = iter(gone)

    def client():
        name = next(clients)
        return lambda: gone[name]

    turns = Scheduler(kb, client)
    move(turns, "a")
    move(turns, "b")
    turns.run_ready()
    assert kb.names == [["a", "b"]]
    assert not kb.has_gone()
    gone["a"] = True
    assert not kb.has_gone()
    gone["b"] = True
    assert kb.has_gone()
