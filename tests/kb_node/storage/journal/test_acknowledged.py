"""The number of the last acknowledged commit outlives its process, not its journal."""

from __future__ import annotations

import errno
import os

import pytest

from semmap.nodes.kb_node.storage.journal.acknowledged import Acknowledged, read_acknowledged


@pytest.fixture
def journal(tmp_path):
    return tmp_path / "map.sqlite"


def test_the_last_number_can_be_read_while_the_journal_is_open(journal):
    acknowledged = Acknowledged(journal)
    assert read_acknowledged(journal) is None
    for seq in (3, 2**40, 5):
        acknowledged.note(seq)
        assert read_acknowledged(journal) == seq
    acknowledged.close()


def test_a_closed_journal_has_no_file(journal):
    acknowledged = Acknowledged(journal)
    acknowledged.note(3)
    acknowledged.close()
    acknowledged.close()
    assert list(journal.parent.iterdir()) == []


def test_the_number_of_an_earlier_process_stays_until_the_next_commit(journal):
    earlier = Acknowledged(journal)
    earlier.note(3)
    again = Acknowledged(journal)
    assert read_acknowledged(journal) == 3
    again.note(4)
    assert read_acknowledged(journal) == 4


def test_journals_in_one_folder_have_numbers_of_their_own(journal):
    one, other = Acknowledged(journal), Acknowledged(journal.with_name("other.sqlite"))
    one.note(3)
    other.note(4)
    assert read_acknowledged(journal) == 3


def test_an_incomplete_file_has_no_number(journal):
    acknowledged = Acknowledged(journal)
    acknowledged.note(3)
    (file,) = journal.parent.iterdir()
    file.write_bytes(file.read_bytes()[:5])
    assert read_acknowledged(journal) is None


def test_without_room_nothing_is_kept_and_no_file_is_left(journal, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", refuse)
    acknowledged = Acknowledged(journal)
    acknowledged.note(3)
    acknowledged.note(4)
    assert list(journal.parent.iterdir()) == []
    acknowledged.close()
