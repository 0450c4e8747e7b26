"""Damage to SQLite's write-ahead log, which holds the last commits after a kill, is detected."""

import io
import os
import random
import shutil
from pathlib import Path

import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.acknowledged import Acknowledged
from semmap.nodes.kb_node.storage.journal.write_ahead import Log, inspect_log
from semmap.nodes.kb_node.storage.repair.repair import repair
from tests.kb_node import home
from tests.kb_node.home import chair, transaction
from tests.kb_node.storage.repair.test_repair import attempt


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Return the files after a kill, with eight commits in the log."""
    folder, copy = tmp_path_factory.mktemp("running"), tmp_path_factory.mktemp("killed")
    semantic_map = home.new_map(folder)
    for number in range(1, 9):
        semantic_map.commit(transaction(number, chair(f"chair{number}", at=(3.0 * number, 2.0, 0.0))))
    for path in folder.glob(f"{FILENAME}*"):
        shutil.copy(path, copy)
    home.close(semantic_map)
    return copy


@pytest.fixture
def data(killed, tmp_path):
    return shutil.copytree(killed, tmp_path, dirs_exist_ok=True)


def names(data):
    journal = Journal(data / FILENAME)
    try:
        return {entity.name for entity in SemanticMap(journal).snapshot().entities}
    finally:
        journal.close()


ALL = {f"chair{number}" for number in range(1, 9)}


@pytest.mark.parametrize("recovered", [9, 6, 3, 0])
@pytest.mark.parametrize(
    ("is_before_boot", "acknowledged", "allowed"),
    [(False, None, 0), (True, None, 1), (False, 7, 1), (False, 8, 0), (True, 8, 1), (True, 7, 1)],
)
def test_one_unfinished_transaction_is_accepted_after_a_power_failure_or_if_it_was_not_acknowledged(
    is_before_boot, acknowledged, allowed, recovered
):
    log = Log(Path("journal"), io.BytesIO(), (3, 6, 9), is_before_boot, acknowledged)
    behind = sum(end > recovered for end in log.ends)
    assert log.has_lost_commits(recovered, last=7) is (behind > allowed)


def interrupt_last_page(data):
    """Leave the log as a kill between the head of the last frame and its page does."""
    log, header, head, page = inspect_log(data / FILENAME), 32, 24, 4096
    with (data / f"{FILENAME}-wal").open("r+b") as file:
        file.seek(header + log.ends[-1] * (head + page) - page)
        file.write(bytes(page))
    log.file.close()


@pytest.mark.parametrize("acknowledged", [7, 8])
def test_a_page_that_was_not_written_is_damage_only_if_its_commit_was_acknowledged(data, acknowledged):
    (data / f"{FILENAME}-acknowledged").write_bytes(acknowledged.to_bytes(8, "little"))
    interrupt_last_page(data)
    found = attempt(names, data)
    if acknowledged == 7:
        assert found == ALL - {"chair8"}
    else:
        assert "the write-ahead log with the last commits is damaged" in found


def test_a_second_kill_before_the_next_commit_is_not_damage(data, tmp_path_factory):
    """Until then the log still has the transaction that the first kill interrupted."""
    (data / f"{FILENAME}-acknowledged").write_bytes((7).to_bytes(8, "little"))
    interrupt_last_page(data)
    again = tmp_path_factory.mktemp("again")
    journal = Journal(data / FILENAME)
    for path in data.glob(f"{FILENAME}*"):
        shutil.copy(path, again)
    journal.close()
    assert names(again) == ALL - {"chair8"}


def test_a_page_of_the_first_commit_after_a_start_that_was_not_written_is_not_damage(tmp_path, monkeypatch):
    """The number of the last commit is noted before it, so that the log is compared with something."""
    running, killed, noted = tmp_path / "running", tmp_path / "killed", []
    for folder in (running, killed):
        folder.mkdir()
    note = Acknowledged.note

    def note_once(acknowledged, seq):
        noted.append(seq)
        if len(noted) == 1:
            note(acknowledged, seq)

    monkeypatch.setattr(Acknowledged, "note", note_once)
    semantic_map = home.new_map(running)
    semantic_map.commit(transaction(1, chair("chair1", at=(3.0, 2.0, 0.0))))
    for path in running.glob(f"{FILENAME}*"):
        shutil.copy(path, killed)
    home.close(semantic_map)
    assert noted == [0, 1]
    interrupt_last_page(killed)
    assert names(killed) == set()


def test_an_intact_log_is_read(data):
    assert (data / f"{FILENAME}-wal").stat().st_size > 32
    assert names(data) == ALL


def test_a_log_with_an_unfinished_transaction_is_read_up_to_it(data):
    """That transaction was never acknowledged."""
    wal = data / f"{FILENAME}-wal"
    os.truncate(wal, end_of(wal) - 5000)
    assert names(data) == ALL - {"chair8"}


def end_of(wal):
    """Return where the written part ends. Space may be preallocated behind it."""
    return len(wal.read_bytes().rstrip(b"\0"))


@pytest.mark.parametrize("seed", range(20))
def test_a_flipped_bit_is_detected_and_loses_little(data, seed):
    wal, chance = data / f"{FILENAME}-wal", random.Random(seed)
    content = bytearray(wal.read_bytes())
    at = chance.randrange(32) if seed % 4 == 0 else chance.randrange(end_of(wal))
    content[at] ^= 1 << chance.randrange(8)
    wal.write_bytes(content)
    found = attempt(names, data)
    if found != ALL:
        assert " is damaged" in found
        assert " is damaged" in attempt(names, data)  # it is not forgotten
        told = repair(data)
        assert "the map continues from commit 8" in told
        assert "nothing is damaged" not in told
        assert len(names(data)) >= 7
