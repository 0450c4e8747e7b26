"""Several changes in one commit, without Zenoh."""

from __future__ import annotations

import pytest

from semmap.schemas import commands as c
from semmap.schemas import errors


@pytest.fixture
def home(dispatcher):
    for x, name in enumerate(("chair1", "chair2", "chair3")):
        dispatcher.change(c.Add(class_="Chair", name=name, at=(float(x), 0.0, 0.0), set=("isOpen=false",)))
    return dispatcher


def opened(*names: str) -> tuple[c.Set, ...]:
    return tuple(c.Set(name=name, property="isOpen", values=(True,)) for name in names)


def states(dispatcher) -> dict:
    return {name: entity.properties.get("isOpen") for name, entity in dispatcher.map.entities.items()}


def last(semantic_map):
    return semantic_map._journal.commit(semantic_map.seq)


def test_it_is_one_commit_and_one_undo(home):
    before = home.map.seq
    reply = home.change(
        c.Batch(
            changes=(
                *opened("chair1", "chair2"),
                c.Update(name="chair1", at=(0.5, 0.0, 0.0)),
                c.Unset(name="chair3", property="isOpen"),
            )
        )
    )
    assert (reply.commit, home.map.seq) == (before + 1, before + 1)
    assert reply.names == ("chair1", "chair2", "chair3")
    assert reply.text == "changed 3: chair1, chair2 and chair3"
    assert states(home) == {"chair1": True, "chair2": True, "chair3": None}
    assert home.map.entity("chair1").pose.position_m == (0.5, 0.0, 0.0)
    home.change(c.Undo())
    assert states(home) == dict.fromkeys(("chair1", "chair2", "chair3"), False)
    assert home.map.entity("chair1").pose.position_m == (0.0, 0.0, 0.0)


def test_unchanged_entities_are_reported(home):
    home.change(c.Set(name="chair2", property="isOpen", values=(True,)))
    reply = home.change(c.Batch(changes=opened("chair1", "chair2")))
    assert reply.text == "changed 1: chair1; already so: chair2"
    again = home.change(c.Batch(changes=opened("chair1", "chair2")))
    assert (again.text, again.commit) == ("unchanged: already up to date", None)


def test_set_and_unset_in_a_batch_take_what_they_take_alone(home, semantic_map):
    home.change(
        c.Batch(changes=(c.Update(name="chair1", ref="seat"), c.Unset(name="chair2", property="isOpen")))
    )
    iri = semantic_map.entity("chair3").iri
    unset = c.Unset(name=iri, property="isOpen")
    reply = home.change(c.Batch(changes=(*opened("seat", "chair2"), unset)))
    assert reply.text == "changed 3: chair1, chair2 and chair3"
    assert states(home) == {"chair1": True, "chair2": True, "chair3": None}
    for changes, said in (
        (opened("chair"), "'chair' is ambiguous"),
        (opened("seat", "chair1"), "changes isOpen of chair1 twice"),
        ((c.Update(name="seat", ref="x"),), "no entity is named 'seat'; did you mean chair1?"),
    ):
        with pytest.raises((errors.BadRequest, errors.UnknownName), match=said):
            home.change(c.Batch(changes=changes))


@pytest.mark.parametrize(
    ("last", "error"),
    [
        (c.Set(name="chair9", property="isOpen", values=(True,)), errors.UnknownName),
        (c.Set(name="chair3", property="isOpne", values=(True,)), errors.BadRequest),
        (c.Set(name="chair3", property="isOpen", values=(True,), if_is=True), errors.PreconditionFailed),
        (c.Set(name="chair3", property="isOpen", values=(True, False)), errors.BadRequest),
        (c.Update(name="chair3", class_="Kitchen"), errors.Refused),
        (c.Update(name="chair3", class_="Chiar"), errors.UnknownClass),
    ],
)
def test_if_one_is_rejected_none_is_made(home, semantic_map, last, error):
    before = set(semantic_map.abox()), dict(home.map.entities), home.map.seq
    with pytest.raises(error):
        home.change(c.Batch(changes=(*opened("chair1", "chair2"), last)))
    assert (set(semantic_map.abox()), dict(home.map.entities), home.map.seq) == before


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ((), "the batch has no changes"),
        ((c.Update(name="chair1", ref="a"), c.Update(name="chair1", ref="b")), "changes chair1 twice"),
        ((c.Unset(name="chair1", property="is open"), *opened("chair1")), "changes isOpen of chair1 twice"),
        ((c.Update(name="chair1", set=("isOpen=no",)), *opened("chair1")), "changes isOpen of chair1 twice"),
        ((c.Update(name="chair1", ref="a", dry_run=True),), "give dry_run once for the batch"),
        ((c.Update(name="chair1", ref="a", id="1", source="agent"),), "give id and source once"),
        ((c.Update(name="chair1", ref="a", wait=True),), "remove wait"),
        ((c.Update(name="chair1", at=(0.0, 0.0, 0.0), frame="chair2"),), "remove the frame"),
    ],
)
def test_invalid_changes_in_a_batch_are_rejected(home, changes, said):
    before = home.map.seq
    with pytest.raises(errors.BadRequest, match=said):
        home.change(c.Batch(changes=changes))
    assert home.map.seq == before


def test_a_dry_run_and_a_repetition_by_id(home):
    tried = home.change(c.Batch(changes=opened("chair1", "chair2"), dry_run=True))
    assert tried.dry_run
    assert states(home)["chair1"] is False
    first = home.change(c.Batch(id="b1", changes=opened("chair1", "chair2")))
    again = home.change(c.Batch(id="b1", changes=opened("chair1", "chair2")))
    assert again.commit == first.commit
    assert again.text.startswith("already done: ")


def test_the_agent_of_the_batch_is_that_of_its_changes(home):
    named = c.Update(name="chair1", ref="portal")
    with pytest.raises(errors.Refused, match="only an operator"):
        home.change(c.Batch(source="perception", changes=(named,)))
    with pytest.raises(errors.PreconditionFailed, match="chair1"):
        home.change(c.Batch(changes=opened("chair2"), unchanged=("chair1",), since=0))


def test_the_reason_names_the_first_changes(home, semantic_map):
    home.change(c.Batch(changes=opened("chair1", "chair2", "chair3")))
    row = last(semantic_map)
    assert row.reason == "set chair1 isOpen true; set chair2 isOpen true; set chair3 isOpen true"
    home.change(
        c.Batch(
            changes=tuple(
                c.Set(name=name, property=property_, values=(value,))
                for name in ("chair1", "chair2", "chair3")
                for property_, value in (("isOpen", False), ("note", "x"))
            )
        )
    )
    row = last(semantic_map)
    assert row.reason.endswith("set chair2 isOpen false; and 3 more changes")
    assert row.verb == "batch"
