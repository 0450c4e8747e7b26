"""Replies as plain lines."""

import pytest

from semmap.nodes.extern.cli.output import lines
from semmap.schemas.changes import Change
from semmap.schemas.relations import Relation
from semmap.schemas.replies import Changed, Checked, LoggedCommit, Violation


@pytest.mark.parametrize(("count", "shown"), [(0, 0), (1, 1), (20, 20), (21, 19), (700, 19)])
def test_of_many_consequences_a_few_are_shown_and_the_rest_counted(count, shown):
    facts = tuple(f"cup{i} type Cup" for i in range(count))
    text, *rest = lines.format_change(Changed(commit=None, text="it would be", no_longer_follows=facts))
    assert text == "it would be"
    assert rest[:shown] == [f"  would no longer be inferred: {fact}" for fact in facts[:shown]]
    assert rest[shown:] == [f"  would no longer be inferred: {count - shown} more facts"] * (count > shown)


@pytest.mark.parametrize(
    ("fields", "shown"),
    [
        ({}, []),
        ({"shapes": 2}, ["2 SHACL shapes: no violations"]),
        (
            {
                "shapes": 1,
                "violation_count": 3,
                "violations": (Violation(name="a", message="m", text="a: m"),),
            },
            ["1 SHACL shape: 3 violations", "  a: m"],
        ),
    ],
)
def test_a_check_counts_all_violations(fields, shown):
    checked = Checked(consistent=True, engine="semmap", triples=3, elapsed_s=0.5, text="consistent", **fields)
    assert list(lines.format_check(checked)) == ["consistent (semmap, 3 triples, 0.500 s)", *shown]


def test_what_a_thing_bears_is_one_sentence():
    def on(name, relation="isOn", other="table1"):
        return Relation(relation=relation, subject=name, object=other, text=f"{name} {relation} {other}: ...")

    alone = [on("table1", "isLocatedIn", "kitchen1"), on("cup1")]
    assert list(lines.format_relations(alone)) == [relation.text for relation in alone]
    several = [
        on("table1", "isLocatedIn", "kitchen1"),
        on("cup1"),
        on("cup2"),
        on("ball1", "isInside", "bin1"),
    ]
    assert list(lines.format_relations(several)) == [
        several[0].text,
        "table1 supports cup1 and cup2",
        several[3].text,
    ]
    many = list(lines.format_relations([on(f"cup{n}") for n in range(30)]))
    assert many[0].startswith("table1 supports cup0, cup1")
    assert many[0].endswith("and 11 more")


def test_a_renamed_entity_is_listed_once():
    commit = LoggedCommit(
        seq=2,
        stamp_ns=1,
        source="operator",
        agent="",
        verb="rename",
        reason="rename mug1 to mug2",
        confidence=None,
        undoes=(),
        tbox=False,
        inserted=3,
        retracted=3,
        changed=("mug2",),
        removed=("mug1",),
        changes=(Change(name="mug2", kind="name", was="mug1", now="mug2"),),
    )
    assert lines.format_commit_changes(commit) == "mug2: renamed from mug1"
