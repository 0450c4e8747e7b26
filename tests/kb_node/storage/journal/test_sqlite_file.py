import resource
import shutil
import sqlite3
import threading
from contextlib import contextmanager

import pytest

from semmap.nodes.kb_node.storage.journal.sqlite_file import (
    DiskFull,
    InUse,
    JournalFile,
    NotWritten,
    has_room,
)
from semmap.schemas import errors


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "journal.sqlite"
    with sqlite3.connect(path) as db:
        db.execute("CREATE TABLE numbers (number INTEGER PRIMARY KEY)")
    db.close()
    opened = JournalFile(path)
    yield opened
    opened.close()


def write(file, *several):
    with file.writing("numbers") as db:
        for number in several:
            db.execute("INSERT INTO numbers VALUES (?)", (number,))


def write_together(file, *several):
    with file.writing("all of them"):
        for number in several:
            write(file, number)


def numbers(file):
    with file.reading() as db:
        return [number for (number,) in db.execute("SELECT number FROM numbers ORDER BY number")]


def test_a_transaction_is_synced_to_the_disk(file):
    with file.reading() as db:
        assert db.execute("PRAGMA synchronous").fetchone() == (2,)
        assert db.execute("PRAGMA journal_mode").fetchone() == ("wal",)


def log_of(folder):
    return folder / "journal.sqlite-wal"


def test_the_log_never_grows(file, tmp_path):
    before = log_of(tmp_path).stat().st_size
    for number in range(1500):
        write(file, number)
    assert log_of(tmp_path).stat().st_size == before
    assert numbers(file) == list(range(1500))


def test_written_data_survives_a_kill(file, tmp_path):
    write(file, 1)
    left = tmp_path / "left"
    left.mkdir()
    for path in (tmp_path / "journal.sqlite", log_of(tmp_path)):
        shutil.copy(path, left)
    again = JournalFile(left / "journal.sqlite")
    write(again, 2)
    assert numbers(again) == [1, 2]
    again.close()
    assert not log_of(left).exists()


@contextmanager
def full(size=1):
    """No file of this process may become larger than `size` bytes."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_a_full_disk_is_reported_as_such_and_loses_nothing(file, tmp_path):
    write(file, *range(5000))
    left = tmp_path / "left"
    left.mkdir()
    for path in (tmp_path / "journal.sqlite", log_of(tmp_path)):  # as after a kill
        shutil.copy(path, left)
    for _ in range(3):
        with full():
            assert not has_room(left)
            with pytest.raises(DiskFull, match="disk full; free some space") as reported:
                JournalFile(left / "journal.sqlite")
        assert "--fresh" not in reported.value.text
    assert has_room(left)
    again = JournalFile(left / "journal.sqlite")
    assert numbers(again) == list(range(5000))
    again.close()


def test_what_does_not_fit_on_the_disk_can_be_written_later(file):
    with file.reading() as db:
        db.execute("PRAGMA max_page_count=1")
    full = r"a table could not be written to .*: database or disk is full; free some space, then repeat it$"
    with pytest.raises(NotWritten, match=full), file.writing("a table") as db:
        db.execute("CREATE TABLE more (number)")
    with file.reading() as db:
        db.execute("PRAGMA max_page_count=1000")
    write(file, 1)
    assert numbers(file) == [1]


@pytest.mark.parametrize("kind", [write, write_together])
def test_a_transaction_is_atomic(file, kind):
    kind(file, 1, 2)
    with pytest.raises(NotWritten, match=r"numbers could not be written to .*journal\.sqlite: UNIQUE[^;]*$"):
        kind(file, 3, 3)
    assert numbers(file) == [1, 2]


def fail_after(file, number):
    with file.writing("a number"):
        write(file, number)
        raise ZeroDivisionError


def test_any_error_rolls_back(file):
    with pytest.raises(ZeroDivisionError):
        fail_after(file, 1)
    assert numbers(file) == []


def test_a_thread_waits_until_another_has_written(file):
    seen = []
    reader = threading.Thread(target=lambda: seen.append(numbers(file)))
    with file.writing("both"):
        write(file, 1)
        reader.start()
        reader.join(timeout=0.1)
        write(file, 2)
    reader.join()
    assert seen == [[1, 2]]


def test_a_second_process_is_rejected(file, tmp_path):
    with pytest.raises(InUse, match="another knowledge base is using"):
        JournalFile(tmp_path / "journal.sqlite")


def test_a_folder_is_rejected(tmp_path):
    with pytest.raises(errors.Refused, match="cannot be read: unable to open"):
        JournalFile(tmp_path)


def test_use_after_close_is_a_programming_error(file):
    file.close()
    with pytest.raises(sqlite3.ProgrammingError):
        numbers(file)
