import random
import resource
import sqlite3
import subprocess
import sys
from contextlib import contextmanager

import pytest
from msgspec import structs

from semmap.nodes.kb_node.storage.journal import Checkpoint, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import InUse
from semmap.schemas import errors
from semmap.schemas.commits import Commit


def commit(seq, text="x"):
    triple = ("<urn:a>", "<urn:b>", f'"{text}"')
    return Commit(seq=seq, stamp_ns=seq, id=f"id{seq}", source="operator", inserted=(triple,))


def written(journal, after=0):
    """Return the commits without the digests, which the journal adds."""
    commits = list(journal.commits(after=after))
    assert [c.digest for c in commits] == [journal.digest(c.seq).hex() for c in commits]
    return [structs.replace(c, digest="") for c in commits]


def write(path, *commits):
    journal = Journal.create(path, b"tbox")
    for one in commits:
        journal.append(one)
    journal.close()


def edit(path, statement, *values):
    with sqlite3.connect(path) as db:
        db.execute(statement, values)
    db.close()


def flip(path, table, seq):
    """Change one byte in the middle of a body."""
    with sqlite3.connect(path) as db:
        (body,) = db.execute(f"SELECT body FROM {table} WHERE seq = ?", (seq,)).fetchone()
        changed = bytearray(body)
        changed[len(changed) // 2] ^= 1
        db.execute(f"UPDATE {table} SET body = ? WHERE seq = ?", (bytes(changed), seq))
    db.close()


def test_appended_commits_are_read_again(path):
    write(path, commit(1), commit(2), commit(3))
    journal = Journal(path)
    assert written(journal) == [commit(1), commit(2), commit(3)]
    assert written(journal, after=2) == [commit(3)]
    assert journal.tbox(0) == b"tbox"
    assert journal.commit_of("id2").inserted == commit(2).inserted
    assert journal.commit_of("id9") is None
    journal.append(commit(4))
    assert written(journal, after=3) == [commit(4)]
    journal.close()


def test_a_second_knowledge_base_is_rejected(journal, path):
    with pytest.raises(InUse, match=r"another knowledge base is using .*journal\.sqlite"):
        Journal(path)
    journal.append(commit(1))


@pytest.mark.parametrize("damaged", [1, 2, 3])
def test_a_flipped_byte_names_the_commit(path, damaged):
    write(path, commit(1), commit(2), commit(3))
    flip(path, "commits", damaged)
    journal = Journal(path)
    with pytest.raises(
        errors.Refused, match=f"commit {damaged} is damaged; the last good one is {damaged - 1}"
    ):
        list(journal.commits())
    with pytest.raises(errors.Refused, match=f"commit {damaged} is damaged"):
        journal.commit_of(f"id{damaged}")
    journal.close()


@pytest.mark.parametrize(
    ("statement", "named"),
    [
        ("DELETE FROM commits WHERE seq = 2", 2),
        ("UPDATE commits SET digest = x'00' WHERE seq = 2", 2),
        ("UPDATE commits SET seq = 7 WHERE seq = 3", 3),
        ("UPDATE commits SET body = (SELECT body FROM commits WHERE seq = 1) WHERE seq = 2", 2),
    ],
)
def test_a_missing_or_forged_commit_is_reported(path, statement, named):
    write(path, commit(1), commit(2), commit(3))
    edit(path, statement)
    journal = Journal(path)
    with pytest.raises(errors.Refused, match=f"commit {named} is damaged"):
        list(journal.commits())
    journal.close()


def test_a_damaged_tbox_is_detected(path):
    write(path)
    edit(path, "UPDATE tboxes SET value = x'00' WHERE seq = 0")
    journal = Journal(path)
    with pytest.raises(errors.Refused, match=r"its TBox is damaged; recover .* semmap repair"):
        journal.tbox(0)
    journal.close()


def test_damaged_pages_are_reported(path):
    write(path, *(commit(i, "x" * 3000) for i in range(1, 20)))
    content = bytearray(path.read_bytes())
    content[4096:] = b"\xff" * (len(content) - 4096)
    path.write_bytes(content)
    with pytest.raises(errors.Refused, match="is damaged"):
        Journal(path)


@pytest.mark.parametrize(
    ("content", "text"),
    [(b"", "cannot be read: no such table"), (b"not a database " * 99, "is damaged: file is not a database")],
)
def test_other_files_are_rejected(path, content, text):
    path.write_bytes(content)
    with pytest.raises(errors.Refused, match=text):
        Journal(path)


def test_a_missing_folder_is_rejected(tmp_path):
    with pytest.raises(errors.Refused, match="cannot create a journal at"):
        Journal.create(tmp_path / "nowhere" / "journal.sqlite", b"")


def test_another_version_is_rejected_and_closed(path):
    write(path)
    edit(path, "UPDATE meta SET value = x'00' WHERE key = 'format'")
    with pytest.raises(errors.Refused, match="another version of semmap; start a new map with --fresh"):
        Journal(path)
    edit(path, "DELETE FROM meta")


def checkpoint(seq):
    return Checkpoint(
        seq=seq,
        triples=(("<urn:a>", "<urn:b>", "<urn:c>"),),
        read_by=b"code",
    )


def test_the_newest_intact_checkpoint_is_used(path, journal):
    assert journal.last_checkpoint() == Checkpoint(seq=0)
    for seq in (10, 20, 30):
        journal.checkpoint(checkpoint(seq))
    assert journal.last_checkpoint() == checkpoint(30)
    journal.close()
    flip(path, "checkpoints", 30)
    again = Journal(path)
    assert again.last_checkpoint() == checkpoint(20)
    again.close()
    flip(path, "checkpoints", 20)
    again = Journal(path)
    assert again.last_checkpoint() == Checkpoint(seq=0)
    again.close()


BULKY = random.Random(2).randbytes(100_000).hex()
"""A string that cannot be compressed."""


@contextmanager
def full_by_page_count(journal):
    """Limit the number of pages of SQLite."""
    with journal.file.reading() as db:
        pages = db.execute("PRAGMA page_count").fetchone()[0]
        db.execute(f"PRAGMA max_page_count={pages}")
        yield
        db.execute("PRAGMA max_page_count=1000000")


@contextmanager
def full_by_file_size(journal):
    """Limit the file size by the operating system."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    size = journal.path.stat().st_size  # less than the log, which is as long as it gets from the beginning
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("full", [full_by_page_count, full_by_file_size])
def test_a_full_disk_writes_nothing(journal, path, full):
    journal.append(commit(1))
    big = commit(2, BULKY)
    with full(journal):
        with pytest.raises(errors.Refused, match=r"commit 2 could not be written to .*journal\.sqlite: "):
            journal.append(big)
        with pytest.raises(errors.Refused, match="the checkpoint after commit 1 could not be written"):
            journal.checkpoint(Checkpoint(seq=1, triples=big.inserted))
    assert written(journal) == [commit(1)]
    journal.append(commit(2))
    journal.close()
    again = Journal(path)
    assert written(again) == [commit(1), commit(2)]
    assert again.last_checkpoint() == Checkpoint(seq=0)
    again.close()


WRITER = """
import sys
from pathlib import Path
from semmap.nodes.kb_node.storage.journal import Journal
from tests.kb_node.storage.journal.test_journal import commit
journal = Journal(Path(sys.argv[1]))
for seq in range(1, 100_000):
    journal.append(commit(seq))
    print(seq, flush=True)
"""


def test_every_acknowledged_commit_survives_a_kill(path):
    write(path)
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True
    ) as writer:
        assert writer.stdout is not None
        for line in writer.stdout:
            if int(line) == 100:
                writer.kill()
                break
        acknowledged = 100 + len(writer.stdout.read().splitlines())
    journal = Journal(path)
    there = written(journal)
    journal.close()
    assert there == [commit(seq) for seq in range(1, len(there) + 1)]
    assert len(there) - acknowledged in (0, 1)
