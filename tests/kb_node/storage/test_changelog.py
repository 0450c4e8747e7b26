"""The changes of commits, read from a journal."""

from msgspec import structs

from semmap.nodes.kb_node.answers.past.differences import compute_difference
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage import changelog, history
from semmap.nodes.kb_node.storage.changelog import Changelog
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.undo import undo
from semmap.ontology import vocabulary as v
from semmap.schemas.commands import Diff, History, Undo
from semmap.schemas.commits import Edit, NewEntity
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.home import transaction
from tests.kb_node.stating import TBOX, adding, edited, stated, statement, unstated


def told(journal, only=None, since=1):
    """Return the changes of the commits as text."""
    query = History(name=only, since=since)
    return [
        [f"{change.name} {change.text}" for change in commit.changes]
        for commit in history.HistoryReader(journal).history(query)
    ]


def test_history_contains_old_and_new_values(stateful_map):
    edited(stateful_map, at=(3.0, 2.0, 0.0))
    edited(stateful_map, ref="seat")
    stated(stateful_map, "isOpen", "false")
    stated(stateful_map, "isOpen", "true")
    stated(stateful_map, "hasColor", "red", "blue")
    unstated(stateful_map, "hasColor", "red")
    edited(stateful_map, set=(statement("note", "x"),), alt=("stool",))
    stateful_map.commit(transaction("go", remove=["chair1"]))
    assert told(stateful_map._journal) == [
        ["chair1 added as Chair", "kitchen1 added as Kitchen"],
        ["chair1 moved from (1, 2, 0) to (3, 2, 0)"],
        ["chair1 label added: 'seat'"],
        ["chair1 isOpen: not set → false"],
        ["chair1 isOpen: false → true"],
        ["chair1 hasColor: + color_blue, color_red"],
        ["chair1 hasColor: - color_red"],
        ["chair1 alias added: 'stool'", "chair1 note: + x"],
        ["chair1 removed"],
    ]


def test_a_removed_entity_is_listed_with_its_class(stateful_map):
    removed_together = transaction("go", remove=["chair1", "kitchen1"])
    stateful_map.commit(removed_together)
    (commit,) = history.HistoryReader(stateful_map._journal).history(History(since=2))
    assert [(change.name, change.kind, change.was) for change in commit.changes] == [
        ("chair1", "removed", "Chair"),
        ("kitchen1", "removed", "Kitchen"),
    ]


def test_the_history_of_an_entity_is_filtered(stateful_map):
    stateful_map.commit(transaction("go", remove=["kitchen1"]))
    stateful_map.commit(adding("stool1"))
    assert told(stateful_map._journal, "kitchen1") == [["kitchen1 added as Kitchen"], ["kitchen1 removed"]]


def test_a_part_of_the_history_has_old_values(stateful_map):
    edited(stateful_map, at=(3.0, 2.0, 0.0))
    stateful_map.commit(transaction("go", remove=["chair1"]))
    stateful_map.commit(adding("chair1"))
    edited(stateful_map, at=(5.0, 2.0, 0.0))
    assert told(stateful_map._journal, since=2)[0] == ["chair1 moved from (1, 2, 0) to (3, 2, 0)"]
    assert told(stateful_map._journal, since=4) == [["chair1 added as Chair"], ["chair1 placed at (5, 2, 0)"]]


def test_older_journals_derive_properties_from_triples(stateful_map, monkeypatch):
    stated(stateful_map, "isOpen", "false")
    stated(stateful_map, "isOpen", "true")
    commit_ = Journal.commit

    def older(journal, seq):
        commit = commit_(journal, seq)
        changed = tuple(structs.replace(entity, properties={}) for entity in commit.changed)
        return structs.replace(commit, changed=changed)

    monkeypatch.setattr(Journal, "commit", older)
    assert told(stateful_map._journal, since=2) == [
        ["chair1 isOpen: not set → false"],
        ["chair1 isOpen: false → true"],
    ]


def test_changes_of_a_large_commit_are_limited(stateful_map):
    new = tuple(adding(f"stool{i}").add[0] for i in range(100))
    made = stateful_map.commit(transaction("many", add=new))
    changes = Changelog(stateful_map._journal, dict).of(made)
    assert len(changes) == changelog.FEW
    gone = stateful_map.commit(transaction("none", remove=[n.name for n in new]))
    assert len(Changelog(stateful_map._journal, dict).of(gone)) == changelog.FEW


def test_ambiguous_properties_have_a_prefix(tmp_path):
    other = home.turtle("@prefix lab: <http://lab.org/lab#> . lab:hasColor a owl:ObjectProperty .")
    semantic_map = home.new_map(tmp_path, [*TBOX, *other])
    semantic_map.commit(transaction("begin", home.chair()))
    stated(semantic_map, "lab:hasColor", "red")
    stated(semantic_map, "lab:hasColor", "blue")
    assert told(semantic_map._journal, since=2) == [
        ["chair1 lab:hasColor: + color_red"],
        ["chair1 lab:hasColor: + color_blue"],
    ]
    home.close(semantic_map)


def diff(journal, since):
    """Return the changes of entities since a commit as text."""
    query = Diff(since=str(since))
    found = compute_difference(journal, history.HistoryReader(journal), query, Thresholds())
    return [f"{change.name} {change.text}" for change in found.changes]


def test_a_renamed_entity_is_neither_added_nor_removed(stateful_map):
    journal = stateful_map._journal
    stated(stateful_map, "isOpen", "true")
    rename = Edit(name="chair1", rename="throne", at=(3.0, 2.0, 0.0), set=(statement("isOpen", "false"),))
    stateful_map.commit(transaction("rename", edit=[rename]))
    changed = ["throne renamed from chair1", "throne moved from (1, 2, 0) to (3, 2, 0)"]
    assert told(journal, since=3) == [[*changed, "throne isOpen: true → false"]]
    assert told(journal, "throne", since=3) == told(journal, "chair1", since=3) == told(journal, since=3)
    edited(stateful_map, name="throne", rename="seat1")
    edited(stateful_map, name="seat1", ref="seat")
    assert diff(journal, 2) == [
        "seat1 renamed from chair1",
        "seat1 moved from (1, 2, 0) to (3, 2, 0)",
        "seat1 label added: 'seat'",
        "seat1 isOpen: true → false",
    ]
    stateful_map.commit(transaction("go", remove=["seat1"]))
    assert diff(journal, 2) == ["chair1 removed"]


def test_an_undone_rename_is_a_rename_even_without_a_pose(stateful_map):
    stateful_map.commit(transaction("rename", verb="rename", edit=[Edit(name="kitchen1", rename="hall1")]))
    undo(stateful_map, stateful_map._journal, Undo(id="undo"))
    assert told(stateful_map._journal, since=2) == [
        ["hall1 renamed from kitchen1"],
        ["kitchen1 renamed from hall1"],
    ]
    assert diff(stateful_map._journal, 1) == []


def test_an_entity_that_replaces_another_one_is_not_a_renamed_one(stateful_map):
    chair = NewEntity(name="chair2", class_iri=v.bare(v.dm("Chair")), pose=Pose(position_m=(1.0, 2.0, 0.0)))
    stateful_map.commit(transaction("replace", verb="undo", remove=["chair1"], add=[chair]))
    assert told(stateful_map._journal, since=2) == [["chair2 added as Chair", "chair1 removed"]]
