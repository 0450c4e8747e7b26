"""A commit of which a part is worked out while the disk takes the rest."""

import subprocess
import sys
import threading

import pytest
from msgspec import structs

from nodes.kb_node.storage.journal import Journal
from nodes.kb_node.storage.journal.pace import Pace
from nodes.kb_node.storage.journal.sqlite_file import NotWritten
from nodes.kb_node.storage.journal.verification import verify
from schemas.commits import Departed
from tests.kb_node.storage.journal.test_journal import (
    BULKY,
    commit,
    full_by_file_size,
    full_by_page_count,
    write,
    written,
)


@pytest.fixture(autouse=True)
def slow_disk(monkeypatch):
    monkeypatch.setattr(Pace, "is_slow", lambda _: True)


def about(one, *names, notes=()):
    return structs.replace(one, removed=tuple(Departed(name=n, types=()) for n in names), notes=notes)


def same(one):
    return lambda: one


def reopened(journal):
    journal.close()
    again = Journal(journal.path)
    verify(again)
    return again


def test_what_is_not_otherwise_is_written_once(journal):
    journal.append(commit(1))
    first = about(commit(2), "cup1")
    finished, digest = journal.append_beside(first, same(first))
    assert finished is first
    assert digest == journal.digest(2)
    journal.append(commit(3))
    again = reopened(journal)
    assert written(again) == [commit(1), first, commit(3)]
    again.close()


def test_what_is_otherwise_stands_in_its_place(journal):
    first = about(commit(1), "cup1", "cup2")
    whole = about(commit(1), "cup1", "table1", notes=("a word",))
    finished, digest = journal.append_beside(first, same(whole))
    assert finished is whole
    assert digest == journal.digest(1)
    assert [journal.touching(name) for name in ("cup1", "cup2", "table1")] == [[1], [], [1]]
    later = about(commit(2), "cup2")
    journal.append_beside(later, same(later))
    again = reopened(journal)
    assert written(again) == [whole, later]
    assert again.commit_of("id1").notes == ("a word",)
    again.close()


def test_it_is_worked_out_by_another_thread_and_nobody_reads_before_it_is(journal):
    first, whole = commit(1), about(commit(1), "cup1")
    seen, threads = [], []

    def finish():
        threads.append(threading.get_ident())
        reader.start()
        reader.join(0.2)
        assert reader.is_alive()
        return whole

    reader = threading.Thread(target=lambda: seen.extend(written(journal)))
    journal.append_beside(first, finish)
    reader.join(10.0)
    assert seen == [whole]
    assert threads != [threading.get_ident()]


@pytest.mark.parametrize("full", [full_by_page_count, full_by_file_size])
def test_what_the_disk_does_not_take_is_refused(journal, full):
    journal.append(commit(1))
    big = commit(2, BULKY)
    with full(journal), pytest.raises(NotWritten, match="commit 2 could not be written"):
        journal.append_beside(big, same(big))
    journal.append(commit(2))
    again = reopened(journal)
    assert written(again) == [commit(1), commit(2)]
    again.close()


@pytest.mark.parametrize("full", [full_by_page_count, full_by_file_size])
def test_where_the_disk_takes_the_first_only_that_stands(journal, full, caplog):
    journal.append(commit(1))
    first = about(commit(2), "cup1")
    whole = about(commit(2), "cup1", "table1", notes=(BULKY,))
    with full(journal):
        finished, digest = journal.append_beside(first, same(whole))
    assert finished is whole
    assert digest == journal.digest(2)
    assert "commit 2 stands without" in caplog.text
    journal.append(commit(3))
    again = reopened(journal)
    assert written(again) == [commit(1), first, commit(3)]
    again.close()


def test_what_could_not_be_finished_is_durable(journal):
    def fail():
        raise ValueError("geometry")

    with pytest.raises(ValueError, match="geometry"):
        journal.append_beside(commit(1), fail)
    again = reopened(journal)
    assert written(again) == [commit(1)]
    again.append(commit(2))
    again.close()


def test_on_a_quick_disk_it_is_finished_first_and_written_once(journal, monkeypatch):
    monkeypatch.setattr(Pace, "is_slow", lambda _: False)
    whole, by = about(commit(1), "cup1"), []

    def finish():
        by.append(threading.get_ident())
        return whole

    finished, digest = journal.append_beside(commit(1), finish)
    assert (finished, digest) == (whole, journal.digest(1))
    assert by == [threading.get_ident()]
    with pytest.raises(KeyError):
        journal.append_beside(commit(2), lambda: {}[0])
    again = reopened(journal)
    assert written(again) == [whole]
    again.close()


def test_together_with_others_it_is_written_once_it_is_finished(journal):
    whole = about(commit(2), "cup1")
    with journal.together():
        journal.append(commit(1))
        assert journal.append_beside(commit(2), same(whole)) == (whole, journal._digest)
    with pytest.raises(NotWritten, match="no room"), journal.together():
        _appended_in_vain(journal, commit(3))
    journal.append_beside(commit(3), same(commit(3)))
    again = reopened(journal)
    assert written(again) == [commit(1), whole, commit(3)]
    again.close()


def _appended_in_vain(journal, one):
    journal.append_beside(one, same(one))
    raise NotWritten("no room")


WRITER = """
import sys
from pathlib import Path
from nodes.kb_node.storage.journal import Journal
from nodes.kb_node.storage.journal.pace import Pace
from tests.kb_node.storage.journal.test_append_beside import about, commit
Pace.is_slow = lambda _: True
journal = Journal(Path(sys.argv[1]))
for seq in range(1, 100_000):
    first, whole = about(commit(seq), "cup1"), about(commit(seq), "cup1", "table1")
    journal.append_beside(first, lambda: whole if seq % 2 else first)
    print(seq, flush=True)
"""


def test_every_acknowledged_commit_survives_a_kill_as_it_was_acknowledged(path):
    write(path)
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True
    ) as writer:
        assert writer.stdout is not None
        for line in writer.stdout:
            if int(line) == 60:
                writer.kill()
                break
        acknowledged = 60 + len(writer.stdout.read().splitlines())
    journal = Journal(path)
    verify(journal)
    there = written(journal)
    journal.close()
    assert acknowledged <= len(there) <= acknowledged + 1
    first, whole = ("cup1",), ("cup1", "table1")
    assert [c.names for c in there[:acknowledged]] == [
        whole if c.seq % 2 else first for c in there[:acknowledged]
    ]
    assert all(c.names in (first, whole) for c in there[acknowledged:])
