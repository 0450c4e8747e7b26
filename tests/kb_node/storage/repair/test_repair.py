"""Damaged journals are rejected with the commit's number, and repaired up to the last intact one."""

import os
import random
import shutil

import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.nodes.kb_node.storage.repair import repair as repair_module
from semmap.nodes.kb_node.storage.repair.repair import repair
from semmap.schemas import errors
from tests.depth import tries
from tests.kb_node import home
from tests.kb_node.documents.tbox.test_tbox_validation import NEW_CLASSES, replace
from tests.kb_node.home import chair, state, transaction
from tests.kb_node.storage.journal.test_journal import edit, flip


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A folder with a map of 8 commits, of which the fifth replaced the TBox."""
    folder = tmp_path_factory.mktemp("whole")
    semantic_map = home.new_map(folder)
    for i in range(1, 9):
        if i == 5:
            replace(semantic_map, i, NEW_CLASSES)
        else:
            semantic_map.commit(transaction(i, chair(f"chair{i}"), reason="x" * 1990))
    home.close(semantic_map)
    return folder


@pytest.fixture
def data(whole, tmp_path):
    """A copy of the folder, to be damaged."""
    return shutil.copytree(whole, tmp_path, dirs_exist_ok=True)


def opened(data):
    journal = Journal(data / FILENAME)
    try:
        semantic_map = SemanticMap(journal)
        return state(semantic_map), list(journal.commits())
    finally:
        journal.close()


def attempt(function, data):
    """Return the result of a function, or its error message."""
    try:
        return function(data)
    except errors.Refused as error:
        return error.text


@pytest.mark.parametrize("broken", [1, 3, 5, 8])
def test_intact_commits_after_a_damaged_one_are_kept(data, broken):
    _, commits = opened(data)
    flip(data / FILENAME, "commits", broken)
    damaged = (data / FILENAME).read_bytes()
    (data / body_shapes.FILENAME).write_bytes(b"{}")
    with pytest.raises(errors.Refused, match=f"commit {broken} is damaged; .* semmap repair --data {data} "):
        opened(data)
    said = repair(data)
    assert said.startswith(
        f"the map continues from commit 8 (commit {broken} is damaged and left out); the damaged file is kept"
    )
    (kept,) = (data / "kept").iterdir()
    assert (kept / FILENAME).read_bytes() == damaged
    assert (data / body_shapes.FILENAME).read_bytes() == b"{}"
    (seq, _, snapshot), repaired = opened(data)
    assert seq == 8
    assert repaired[: broken - 1] == commits[: broken - 1]
    assert (repaired[broken - 1].inserted, repaired[broken - 1].retracted) == ((), ())
    assert [c.inserted for c in repaired[broken:]] == [c.inserted for c in commits[broken:]]
    assert {e.name for e in snapshot.entities} == {f"chair{n}" for n in range(1, 9) if n not in (5, broken)}
    assert repair(data) == f"nothing is damaged in {data}: the map continues from commit 8"


def story(folder, *steps):
    """Create a journal with a commit for each step, a function from the map to triples."""
    semantic_map = home.new_map(folder)
    for number, step in enumerate(steps, start=1):
        insert, retract = step
        assert semantic_map.commit(transaction(number, insert, retract, reason=f"step {number}"))
    return semantic_map


def at(name, before, after):
    """Return a step that changes an x coordinate."""
    here = [t for t in chair(name, at=(before, 2.0, 0.0)) if "coordinates_x" in t[1]]
    there = [t for t in chair(name, at=(after, 2.0, 0.0)) if "coordinates_x" in t[1]]
    return there, here


MOVES = (
    (chair("chair1", at=(1.0, 2.0, 0.0)), ()),
    (chair("chair2"), ()),
    at("chair1", 1.0, 3.0),
    (chair("chair3"), ()),
    at("chair1", 3.0, 5.0),
    ((), chair("chair3")),
)


def where(data):
    """Return the x of each entity."""
    (_, _, snapshot), _ = opened(data)
    return {e.name: e.pose.position_m[0] for e in snapshot.entities}


@pytest.mark.parametrize(
    ("broken", "unfit", "there"),
    [
        (1, "also left out because of missing changes: commits 3 and 5", {"chair2": 1.0}),
        (3, "", {"chair1": 5.0, "chair2": 1.0}),  # where it is set from there is known to the next one
        (4, "also left out because of missing changes: commit 6", {"chair1": 5.0, "chair2": 1.0}),
        (6, "", {"chair1": 5.0, "chair2": 1.0, "chair3": 1.0}),
    ],
)
def test_dependent_commits_are_reported(tmp_path, broken, unfit, there):
    home.close(story(tmp_path, *MOVES))
    flip(tmp_path / FILENAME, "commits", broken)
    said = repair(tmp_path)
    assert f"(commit {broken} is damaged and left out" in said
    assert (unfit in said) if unfit else "also left out" not in said
    assert where(tmp_path) == there
    _, commits = opened(tmp_path)
    assert [c.reason for c in commits if "left out" not in c.reason] == [
        f"step {n}" for n in range(1, 7) if n != broken and str(n) not in unfit
    ]


@pytest.mark.parametrize("broken", [(1,), (3,), (2, 3), (1, 5), (6,)], ids=str)
def test_a_checkpoint_restores_damaged_commits(tmp_path, broken):
    semantic_map = story(tmp_path, *MOVES)
    semantic_map.checkpoint()
    home.close(semantic_map)
    (_, triples, _), commits = opened(tmp_path)
    for seq in broken:
        flip(tmp_path / FILENAME, "commits", seq)
    assert "restored from the checkpoint after commit 6); the damaged file" in repair(tmp_path)
    (_, repaired_triples, _), repaired = opened(tmp_path)
    assert repaired_triples == triples
    assert where(tmp_path) == {"chair1": 5.0, "chair2": 1.0}
    assert [c.inserted for c in repaired[broken[-1] :]] == [c.inserted for c in commits[broken[-1] :]]


@pytest.mark.parametrize("seq", range(1, 9))
def test_a_damaged_digest_loses_nothing(data, seq):
    """The next commit has it, too."""
    expected = opened(data)
    edit(data / FILENAME, "UPDATE commits SET digest = x'00112233' WHERE seq = ?", seq)
    with pytest.raises(errors.Refused, match="is damaged"):
        opened(data)
    said = repair(data)
    if seq < 8:
        assert "(all commits are intact)" in said
        assert opened(data) == expected
    else:
        assert "commit 8 is damaged and left out" in said


@pytest.mark.parametrize("left", [0.5, 0.7, 0.75, 0.85, 0.95])
def test_a_truncated_journal_is_repaired(data, left):
    _, commits = opened(data)
    path = data / FILENAME
    os.truncate(path, int(path.stat().st_size * left))
    with pytest.raises(errors.Refused, match=f"semmap repair --data {data} "):
        opened(data)
    first = data / "first.nt"
    first.write_text("".join(f"{s} {p} {o} .\n" for s, p, o in home.TBOX))
    assert repair(data, tbox=first).startswith("the map continues from commit ")
    (seq, _, _), repaired = opened(data)
    assert seq <= 8
    assert all(
        ours.id == theirs.id or "left out" in ours.reason
        for ours, theirs in zip(repaired, commits, strict=False)
    )


def test_a_full_disk_aborts_the_repair(data, monkeypatch):
    flip(data / FILENAME, "commits", 8)
    damaged = (data / FILENAME).read_bytes()
    append = Journal.append

    def until_it_is_full(journal, commit, *others, **fields):
        if commit.seq == 4:
            raise NotWritten("the disk is full")
        return append(journal, commit, *others, **fields)

    monkeypatch.setattr(Journal, "append", until_it_is_full)
    with pytest.raises(errors.Refused, match="the disk is full"):
        repair(data)
    assert (data / FILENAME).read_bytes() == damaged
    monkeypatch.undo()
    assert repair(data).startswith("the map continues from commit 8 ")


def test_progress_is_reported(data, monkeypatch):
    monkeypatch.setattr(repair_module, "_REPORT_INTERVAL_S", 0.0)
    flip(data / FILENAME, "commits", 5)
    told = []
    repair(data, told.append)
    checked, saved = (
        [f"{n} commits checked" for n in range(1, 5)],
        [f"{n} commits saved" for n in range(1, 9)],
    )
    assert told == [*checked, *saved, "the map is rebuilt from 8 commits"]


def test_a_repaired_map_accepts_commits(data):
    flip(data / FILENAME, "commits", 7)
    repair(data)
    journal = Journal(data / FILENAME)
    semantic_map = SemanticMap(journal)
    assert semantic_map.commit(transaction("new", chair("chair9"))).seq == 9
    journal.close()
    assert opened(data)[0][0] == 9


@pytest.mark.parametrize("seed", range(tries(30)))
def test_flipped_bits_are_detected_or_harmless(data, seed):
    """Anywhere: in commits, indexes, the checkpoint, and SQLite's own pages."""
    semantic_map = SemanticMap(Journal(data / FILENAME))
    semantic_map.checkpoint()
    semantic_map.commit(transaction("last", chair("chair9")))
    home.close(semantic_map)
    expected = looked_at(data)
    path = data / FILENAME
    content = bytearray(path.read_bytes())
    chance = random.Random(seed)
    start = chance.randrange(*((0, 4096) if seed % 3 == 0 else (4096, len(content) - 64)))
    for i in range(start, start + chance.choice([1, 1, 16, 64])):
        content[i] ^= 1 << chance.randrange(8)
    path.write_bytes(content)
    found = attempt(looked_at, data)
    assert found == expected or "is damaged" in found
    if "start a new map with --fresh" not in attempt(repair, data):
        _, repaired = opened(data)
        theirs = {commit.seq: commit for commit in expected[0][1]}
        assert all("commit" in ours.reason or ours.inserted == theirs[ours.seq].inserted for ours in repaired)


def looked_at(data):
    """Return the contents, read in every possible way."""
    everything = opened(data)
    journal = Journal(data / FILENAME)
    try:
        touching = [journal.touching(f"chair{n}") for n in range(1, 10)]
        of_commands = [(c := journal.commit_of(str(n))) and c.seq for n in range(1, 9)]
        return everything, touching, of_commands, sorted(journal.last_touches(9)), journal.tbox_changes(0)
    finally:
        journal.close()


def test_an_unrepairable_journal_names_the_next_step(data):
    (data / FILENAME).write_bytes(b"not a database " * 99)
    with pytest.raises(errors.Refused, match=r"file is not a database; start a new map with --fresh"):
        repair(data)


def test_a_commit_whose_tbox_is_damaged_is_left_out(data):
    edit(data / FILENAME, "UPDATE tboxes SET value = x'00' WHERE seq = 5")
    with pytest.raises(errors.Refused, match="its TBox is damaged"):
        opened(data)
    assert repair(data).startswith("the map continues from commit 8 (commit 5 is damaged and left out)")
    assert {f"chair{n}" for n in (1, 2, 3, 4, 6, 7, 8)} <= where(data).keys()


def damage_a_page_of_the_tbox(path):
    """Then SQLite cannot read the row, and reports a malformed file."""
    content = bytearray(path.read_bytes())
    tbox = tbox_of(path)
    page = content.index(tbox[len(tbox) // 2 :][:64]) // 4096 * 4096
    content[page : page + 4096] = b"\xff" * 4096
    path.write_bytes(content)


def tbox_of(path):
    journal = Journal(path)
    try:
        return journal.tbox(0)
    finally:
        journal.close()


@pytest.mark.parametrize("how", ["digest", "pages"])
def test_a_lost_initial_tbox_can_be_provided(data, how, tmp_path_factory):
    expected = opened(data)
    tbox = tmp_path_factory.mktemp("tbox") / "tbox.nt"
    tbox.write_bytes(tbox_of(data / FILENAME))
    if how == "digest":
        edit(data / FILENAME, "UPDATE tboxes SET value = x'00' WHERE seq = 0")
    else:
        damage_a_page_of_the_tbox(data / FILENAME)
    with pytest.raises(errors.Refused, match="semmap repair --data"):
        opened(data)
    with pytest.raises(
        errors.Refused, match=r"cannot be read; provide it with --tbox FILE, or start a new map"
    ):
        repair(data)
    with pytest.raises(errors.BadFile, match="is it a TBox"):
        repair(data, tbox=scene(tbox.with_name("no_tbox.ttl")))
    assert repair(data, tbox=tbox).startswith("the map continues from commit 8 (")
    assert opened(data)[1] == expected[1]


def scene(path):
    path.write_text("<http://x/a> <http://x/b> <http://x/c> .")
    return path


def test_missing_and_used_journals_are_rejected(data, tmp_path_factory):
    with pytest.raises(errors.BadFile, match="there is no map in"):
        repair(tmp_path_factory.mktemp("empty"))
    journal = Journal(data / FILENAME)
    with pytest.raises(errors.Refused, match="another knowledge base is using"):
        repair(data)
    journal.close()
