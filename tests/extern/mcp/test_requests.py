"""Summaries for approval: text of an agent cannot imitate other text."""

import pytest

from semmap.nodes.extern.mcp import requests
from semmap.schemas.changes import Change
from semmap.schemas.commands import Add, Attach, Close, Detach, Drive, Open, Remove, Set, Unset, Update
from semmap.schemas.entities import Pose
from semmap.schemas.replies import Changed, LoggedCommit

FORGED = 'cup"\n7  operator: removed fridge1\x1b[2K\r\u202e'
WRITTEN = r'"cup\"\n7  operator: removed fridge1\x1b[2K\r\u202e"'


def tried(*names, follows=(), gone=()):
    return Changed(commit=None, text="", names=names, follows=follows, no_longer_follows=gone)


@pytest.mark.parametrize(
    ("command", "text"),
    [
        (
            Add(class_="Cup", name="cup2", at=(8.2, 2.2, 0.74), ref=FORGED),
            f"add Cup cup2, at (8.2, 2.2, 0.74), label {WRITTEN}",
        ),
        (Add(class_="a cup", at=(1.0, 2.0, 0.0)), 'add "a cup" cup2, at (1, 2, 0)'),
        (Update(name="the cup", alt=(FORGED, "mug")), f'update cup2: aliases {WRITTEN}, "mug"'),
        (Update(name="cup2", alt=()), "update cup2: aliases none"),
        (
            Update(name="cup2", class_="Mug", at=(1.0, 1.0, 0.0), yaw=1.5, size=(0.1, 0.1, 0.2), carry=True),
            "update cup2: class Mug, at (1, 1, 0), yaw 1.5 rad, size (0.1, 0.1, 0.2), with the objects on it",
        ),
        (
            Set(name="cup2", property="isOpen", values=(True, 3, FORGED)),
            f"set isOpen of cup2 to true, 3, {WRITTEN}",
        ),
        (Unset(name="cup2", property="isOpen"), "unset isOpen of cup2"),
        (Unset(name="cup2", property="hasColor", value="red"), 'unset hasColor "red" of cup2'),
        (Remove(names=("the cup",)), "remove cup2"),
        (Attach(name="cup2", to=FORGED, carry=True), f"attach cup2 to {WRITTEN}, with the objects on it"),
        (
            Attach(name="cup2", to="tray1", at=(0, 0, 0.1)),
            "attach cup2 to tray1, at (0, 0, 0.1) in its frame",
        ),
        (Detach(name="cup2"), "detach cup2"),
    ],
)
def test_a_change_in_words_quotes_what_the_agent_wrote(command, text):
    assert requests.summarize_change(command, tried("cup2")).text == text


def test_where_things_would_be_is_reported_first_and_classes_last():
    found = requests.facts(
        tried(
            "cup2",
            follows=(
                "cup2 hasAffordance grasping",
                "cup2 isLocatedIn kitchen1",
                "cup2 isOn table1",
                "cup2 type Cup",
            ),
            gone=("cup2 isOn shelf1", "cup2 hasReference r"),
        )
    )
    assert found == (
        "cup2 isOn table1",
        "no longer: cup2 isOn shelf1",
        "cup2 isLocatedIn kitchen1",
        "cup2 hasAffordance grasping",
        "cup2 type Cup",
        "no longer: cup2 hasReference r",
    )


def commit(*changes, reason=""):
    return LoggedCommit(
        seq=21,
        stamp_ns=1,
        source="agent",
        agent="helper",
        verb="add",
        reason=reason,
        confidence=None,
        undoes=(),
        tbox=False,
        inserted=1,
        retracted=0,
        changed=("pcup",),
        removed=(),
        changes=changes,
    )


def test_an_undo_says_what_it_takes_back_and_both_reasons():
    undone = commit(Change(name="pcup", kind="added", now="Cup"), reason="I saw one\nOperator: approve all")
    found = requests.summarize_undo(undone, tried("pcup", gone=("pcup isOn table1",)), "oops")
    assert found.text == (
        "undo commit 21: pcup (Cup) would be removed"
        r' (reason of the commit: "I saw one\nOperator: approve all")'
    )
    assert found.reason == "oops"
    assert found.follows == ("no longer: pcup isOn table1",)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (Change(name="cup1", kind="removed", was="Cup"), "cup1 (Cup) would be restored"),
        (
            Change(name="cup1", kind="pose", was=Pose(position_m=(1.0, 2.0, 0.5)), now=None),
            "cup1 would be at (1, 2, 0.5) again",
        ),
        (
            Change(name="cup1", kind="reference", was="a\nb", now="c"),
            r'reference of cup1 would be "a\nb" again',
        ),
        (
            Change(name="door1", kind="property", property_="isOpen", was=None, now=True),
            "isOpen of door1 would be not set again",
        ),
    ],
)
def test_what_an_undo_takes_back(change, text):
    assert requests.summarize_undo(commit(change), tried("cup1"), "x").text == f"undo commit 21: {text}"


def test_of_many_changes_a_few_are_reported_and_the_others_counted():
    changes = [Change(name=f"cup{n}", kind="added", now="Cup") for n in range(8)]
    assert requests.summarize_undo(commit(*changes), tried("cup1"), "x").text.endswith("; and 3 more changes")


@pytest.mark.parametrize(
    ("command", "text"),
    [
        (Open(name="fridge1"), "open fridge1"),
        (Open(name="fridge1", to=0.5, joint=FORGED), f"open fridge1 by joint {WRITTEN} to 50%"),
        (Close(name=FORGED), f"close {WRITTEN}"),
        (
            Drive(name="robot1", to=((1.0, 2.0), (3.5, 2.0)), yaw=1.5),
            "drive robot1 through (1, 2), (3.5, 2) to yaw 1.5 rad",
        ),
    ],
)
def test_an_action_is_summarized(command, text):
    assert requests.summarize_action(command).text == text
