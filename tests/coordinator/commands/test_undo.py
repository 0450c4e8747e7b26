"""The reply to an undo names what it has changed back."""

from __future__ import annotations

import pytest

from semmap.schemas import commands as c


def add(dispatcher, name="chair1", **fields):
    return dispatcher.change(c.Add(class_="Chair", name=name, **{"at": (1.0, 2.0, 0.0), **fields}))


def undone(dispatcher, **fields):
    return dispatcher.change(c.Undo(**fields))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (c.Update(name="chair1", at=(3.0, 2.0, 0.0)), "moved chair1 from (1, 2, 0) to (3, 2, 0)"),
        (c.Set(name="chair1", property="isOpen", values=(True,)), "chair1: isOpen: not set → true"),
        (c.Rename(name="chair1", new="throne"), "renamed chair1 to throne"),
        (c.Remove(names=("chair1",)), "removed chair1"),
        (c.Update(name="chair1", ref="seat"), "chair1: label added: 'seat'"),
    ],
)
def test_a_change_is_described_as_it_was_made(dispatcher, change, text):
    add(dispatcher)
    dispatcher.change(change)
    reply = undone(dispatcher)
    assert reply.text.startswith(f"undid commit 2: {text}")
    assert reply.commit == 3


def scene(count):
    items = ",".join(f'{{"class": "Chair", "name": "seat{i}", "at": [{i}, 0, 0]}}' for i in range(count))
    return c.Load(content=f'{{"entities": [{items}]}}'.encode(), filename="scene.json")


@pytest.mark.parametrize(
    ("count", "more"), [(3, ""), (4, "; … and 1 entity more"), (5, "; … and 2 entities more")]
)
def test_three_changes_are_described_and_the_others_counted(dispatcher, count, more):
    dispatcher.change(scene(count))
    reply = undone(dispatcher)
    described = "; ".join(f"added seat{i} as Chair" for i in range(3))
    assert reply.text == f"undid commit 1: {described}{more}"
    assert len(reply.undone) == count
    assert set(reply.names) == {f"seat{i}" for i in range(count)}


def test_at_most_fifty_changes_are_listed(dispatcher):
    dispatcher.change(scene(51))
    assert len(undone(dispatcher).undone) == 50


def test_an_older_commit_is_undone_by_its_number(dispatcher):
    add(dispatcher)
    add(dispatcher, "chair2", at=(4.0, 2.0, 0.0))
    assert undone(dispatcher, commit=1).text == "undid commit 1: added chair1 as Chair"
    assert set(dispatcher.map.entities) == {"chair2"}


def test_a_dry_run_of_an_undo_changes_nothing(dispatcher):
    add(dispatcher)
    reply = undone(dispatcher, dry_run=True)
    assert reply.dry_run
    assert "added chair1 as Chair" in reply.text
    assert set(dispatcher.map.entities) == {"chair1"}
