"""Damaged journals: refused with the commit's number, and mended up to the last good one."""

import os
import random
import shutil

import pytest

from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.storage import repair as repair_module
from nodes.kb_node.storage.journal import FILENAME, Journal
from nodes.kb_node.storage.repair import repair
from nodes.kb_node.storage.sqlite_file import NotWritten
from schemas import errors
from tests.kb_node import home
from tests.kb_node.documents.tbox.test_tbox_validation import NEW_CLASSES, replace
from tests.kb_node.home import chair, state, transaction
from tests.kb_node.storage.test_journal import edit, flip


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
    """A copy of it to be damaged."""
    return shutil.copytree(whole, tmp_path, dirs_exist_ok=True)


def opened(data):
    journal = Journal(data / FILENAME)
    try:
        semantic_map = SemanticMap(journal)
        return state(semantic_map), list(journal.commits())
    finally:
        journal.close()


def attempt(function, data):
    """What a function gives, or the words with which it refuses."""
    try:
        return function(data)
    except errors.Refused as error:
        return error.text


@pytest.mark.parametrize("broken", [1, 5, 8])
def test_it_goes_on_from_the_last_good_commit(data, broken):
    _, commits = opened(data)
    flip(data / FILENAME, "commits", broken)
    damaged = (data / FILENAME).read_bytes()
    with pytest.raises(errors.Refused, match=f"commit {broken} is damaged; .* semmap repair --data {data} "):
        opened(data)
    said = repair(data)
    after = ", and everything after it, up to commit 8, is dropped" if broken < 8 else ""
    assert said.startswith(
        f"the map continues from commit {broken - 1} (commit {broken} is damaged{after}); "
    )
    (kept,) = (data / "kept").iterdir()
    assert (kept / FILENAME).read_bytes() == damaged
    (seq, _, snapshot), mended = opened(data)
    assert (seq, mended) == (broken - 1, commits[: broken - 1])
    assert {e.name for e in snapshot.entities} == {e.name for c in mended for e in c.changed}
    assert repair(data) == f"nothing is damaged: the map continues from commit {broken - 1}"


@pytest.mark.parametrize("left", [0.5, 0.7, 0.75, 0.85, 0.95])
def test_a_journal_that_was_cut_off_goes_on_from_what_is_left(data, left):
    _, commits = opened(data)
    path = data / FILENAME
    os.truncate(path, int(path.stat().st_size * left))
    with pytest.raises(errors.Refused, match=f"semmap repair --data {data} "):
        opened(data)
    first = data / "first.nt"
    first.write_text("".join(f"{s} {p} {o} .\n" for s, p, o in home.TBOX))
    assert repair(data, tbox=first).startswith("the map continues from commit ")
    (seq, _, _), mended = opened(data)
    assert 0 < seq < 8
    assert mended == commits[:seq]


def test_a_full_disk_ends_the_repair_and_leaves_the_damaged_file(data, monkeypatch):
    flip(data / FILENAME, "commits", 8)
    damaged = (data / FILENAME).read_bytes()
    append = Journal.append

    def until_it_is_full(journal, commit, *others, **fields):
        if commit.seq == 4:
            raise NotWritten("the disk is full")
        append(journal, commit, *others, **fields)

    monkeypatch.setattr(Journal, "append", until_it_is_full)
    with pytest.raises(errors.Refused, match="the disk is full"):
        repair(data)
    assert (data / FILENAME).read_bytes() == damaged
    monkeypatch.undo()
    assert repair(data).startswith("the map continues from commit 7 ")


def test_it_tells_how_far_it_is(data, monkeypatch):
    monkeypatch.setattr(repair_module, "_TOLD_EVERY_S", 0.0)
    flip(data / FILENAME, "commits", 5)
    told = []
    repair(data, told.append)
    checked, saved = (
        [f"{n} commits checked" for n in range(1, 5)],
        [f"{n} commits saved" for n in range(1, 5)],
    )
    assert told == [*checked, *saved, "the map is rebuilt from 4 commits"]


def test_a_repaired_map_takes_commits_again(data):
    flip(data / FILENAME, "commits", 7)
    repair(data)
    journal = Journal(data / FILENAME)
    semantic_map = SemanticMap(journal)
    assert semantic_map.commit(transaction("new", chair("chair9"))).seq == 7
    journal.close()
    assert opened(data)[0][0] == 7


@pytest.mark.parametrize("seed", range(40))
def test_flipped_bytes_are_noticed_or_do_no_harm(data, seed):
    expected, commits = opened(data)
    path = data / FILENAME
    content = bytearray(path.read_bytes())
    chance = random.Random(seed)
    start = chance.randrange(4096, len(content) - 64)  # page 1 tells SQLite what file it is: see below
    for i in range(start, start + chance.choice([1, 16, 64])):
        content[i] ^= chance.randrange(1, 256)
    path.write_bytes(content)
    found = attempt(opened, data)
    assert found == (expected, commits) or "is damaged" in found
    if "start a new map with --fresh" not in attempt(repair, data):
        (seq, _, _), mended = opened(data)
        assert mended == commits[:seq]


def test_what_cannot_be_mended_says_how_to_go_on(data):
    (data / FILENAME).write_bytes(b"not a database " * 99)
    with pytest.raises(errors.Refused, match=r"file is not a database; start a new map with --fresh"):
        repair(data)


def test_a_damaged_tbox_is_where_the_good_commits_end(data):
    edit(data / FILENAME, "UPDATE tboxes SET value = x'00' WHERE seq = 5")
    with pytest.raises(errors.Refused, match="the TBox in it is damaged"):
        opened(data)
    assert repair(data).startswith(
        "the map continues from commit 4 (the TBox in it is damaged, and everything"
    )


def damage_a_page_of_the_tbox(path):
    """After that SQLite cannot read the row at all, and calls the file malformed."""
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
def test_a_first_tbox_that_is_lost_can_be_given_anew(data, how, tmp_path_factory):
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


def test_nothing_and_what_is_in_use_are_refused(data, tmp_path_factory):
    with pytest.raises(errors.BadFile, match="there is no map in"):
        repair(tmp_path_factory.mktemp("empty"))
    journal = Journal(data / FILENAME)
    with pytest.raises(errors.Refused, match="another knowledge base is using"):
        repair(data)
    journal.close()
