"""Damage to SQLite's write-ahead log, which holds the last commits after a kill, is detected."""

import io
import os
import random
import shutil
from pathlib import Path

import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.write_ahead import Log
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


@pytest.mark.parametrize(
    ("is_before_boot", "recovered", "lost"),
    [
        (False, 9, False),
        (False, 6, True),
        (False, 3, True),
        (False, 0, True),
        (True, 9, False),
        (True, 6, False),
        (True, 3, True),
        (True, 0, True),
    ],
)
def test_an_unfinished_transaction_is_accepted_after_a_power_failure_only(is_before_boot, recovered, lost):
    log = Log(Path("journal"), io.BytesIO(), (3, 6, 9), is_before_boot)
    assert log.has_lost_commits(recovered) is lost


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
