"""A backup is the journal at its start. An incomplete one is rejected."""

import random
import shutil

import pytest

from semmap.nodes.extern import backup as client_backup
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.nodes.kb_node.storage.backup import backup_parts
from semmap.nodes.kb_node.storage.backup.restore import restore
from semmap.nodes.kb_node.storage.compaction import compaction
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.repair.repair import repair
from semmap.ontology.model_shapes import ModelShape, WorldShapes, world
from semmap.schemas import backups, errors
from tests.kb_node import home
from tests.kb_node.documents.tbox.test_tbox_validation import NEW_CLASSES, replace
from tests.kb_node.home import chair, state, transaction


@pytest.fixture(params=["fresh", "checkpoint", "compacted"])
def semantic_map(tmp_path, request):
    made = home.new_map(tmp_path)
    for number in range(1, 9):
        if number == 5:
            replace(made, number, NEW_CLASSES)
        else:
            made.commit(transaction(number, chair(f"chair{number}"), reason="x" * 500))
        if number == 6 and request.param == "checkpoint":
            made.checkpoint()
        if number == 6 and request.param == "compacted":
            compaction.compact(made._journal, HistoryReader(made._journal), 3)
    yield made
    home.close(made)


def backed_up(semantic_map, file, size=backup_parts.PART_BYTES, between=lambda: None, **how):
    def ask(query):
        part = backup_parts.read_part(semantic_map._journal, query.at, size=size)
        between()
        return part

    return client_backup.write(ask, file, **how)


def opened(data):
    journal = Journal(data / FILENAME)
    try:
        made = SemanticMap(journal)
        return state(made), list(journal.commits()), journal.origin(), made.digest
    finally:
        journal.close()


@pytest.mark.parametrize("size", [100, 3000, backup_parts.PART_BYTES])
def test_a_restored_map_equals_the_backup(tmp_path, semantic_map, size):
    there, commits = state(semantic_map), list(semantic_map._journal.commits())
    numbers = iter(range(10, 10_000))

    def go_on():
        if size > 100:
            semantic_map.commit(transaction(number := next(numbers), chair(f"chair{number}")))

    opening = backed_up(semantic_map, tmp_path / "b", size, go_on)
    assert (opening.last, opening.digest) == (8, commits[-1].digest)
    assert opening.map_id == semantic_map._journal.origin()[0]
    restored_map = restore(tmp_path / "b", tmp_path / "other")
    assert (restored_map.opening, restored_map.entities, restored_map.kept) == (opening, 7, None)
    told = restored_map.text
    assert told.startswith(f"map {opening.map_id[:12]}, begun 20")
    assert "as it was after commit 8 (20" in told
    assert told.endswith("), 7 entities")
    after, restored, origin, digest = opened(tmp_path / "other")
    assert restored == commits
    assert (origin, digest) == (semantic_map._journal.origin(), opening.digest)
    assert {e.name for e in after[2].entities} == {e.name for e in there[2].entities}
    other = tmp_path / "other"
    assert repair(other) == f"nothing is damaged in {other}: the map continues from commit 8"


def with_shapes(semantic_map, *sizes):
    """Store a world whose bodies are cubes, and return the content of the file."""
    file = body_shapes.beside(semantic_map._journal.path)
    cubes = {f"box{number}": ModelShape(size_m=(size,) * 3) for number, size in enumerate(sizes)}
    body_shapes.write(file, WorldShapes.of(cubes))
    return file.read_bytes()


@pytest.mark.parametrize("size", [100, backup_parts.PART_BYTES])
def test_the_shapes_of_a_worlds_bodies_are_restored(tmp_path, semantic_map, size):
    shapes = with_shapes(semantic_map, 0.1, 0.2, 0.3)
    backed_up(semantic_map, tmp_path / "b", size)
    before = world()
    restore(tmp_path / "b", tmp_path / "other")
    assert body_shapes.beside(tmp_path / "other" / FILENAME).read_bytes() == shapes
    assert world() is before
    backed_up(semantic_map, tmp_path / "b", size, overwrite=True)
    restore(tmp_path / "b", tmp_path / "other", replace=True)
    (kept,) = (tmp_path / "other" / "kept").iterdir()
    assert (kept / body_shapes.FILENAME).read_bytes() == shapes
    assert not list((tmp_path / "other").glob("new-*"))


@pytest.mark.parametrize("semantic_map", ["fresh"], indirect=True)
def test_shapes_that_change_during_a_backup_are_restored_whole(tmp_path, semantic_map):
    first = with_shapes(semantic_map, 0.1, 0.2, 0.3)
    later = []

    def ask(query):
        part = backup_parts.read_part(semantic_map._journal, query.at, size=300)
        if first[:100] in part.content and not later:  # the first of several parts
            later.append(with_shapes(semantic_map, 0.4, 0.5, 0.6, 0.7))
        return part

    client_backup.write(ask, tmp_path / "b")
    restore(tmp_path / "b", tmp_path / "other")
    assert [body_shapes.beside(tmp_path / "other" / FILENAME).read_bytes()] == later


@pytest.mark.parametrize("semantic_map", ["fresh"], indirect=True)
def test_an_existing_file_is_kept_by_default(tmp_path, semantic_map):
    file = tmp_path / "b"
    file.write_text("precious")
    with pytest.raises(errors.BadFile, match="already exists; add --overwrite"):
        backed_up(semantic_map, file)
    assert file.read_text() == "precious"

    def fail():
        raise errors.NoAnswer("gone")

    with pytest.raises(errors.NoAnswer):
        backed_up(semantic_map, file, between=fail, overwrite=True)
    assert file.read_text() == "precious"
    backed_up(semantic_map, file, overwrite=True)
    assert backups.verify(file).last == 8
    assert file.stat().st_mode & 0o777 == 0o600
    assert {path.name for path in tmp_path.iterdir() if path.name == "b" or "part" in path.name} == {"b"}
    with pytest.raises(errors.BadFile, match=r"cannot be written to .*: No such file"):
        backed_up(semantic_map, tmp_path / "none" / "b")


def test_a_damaged_backup_is_rejected(tmp_path, semantic_map):
    file, chance, other = tmp_path / "b", random.Random(1), tmp_path / "other"
    backed_up(semantic_map, file)
    whole = file.read_bytes()
    for number in range(40):
        content = bytearray(whole)
        if number % 4 == 0:
            del content[chance.randrange(len(content)) :]
        else:
            content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
        file.write_bytes(content)
        try:
            backups.verify(file)
        except errors.BadFile as error:
            found = error.text
        else:
            found = attempt(file, other)
        assert found == "harmless" or " is damaged or incomplete" in found or "is not a backup" in found
        assert not other.exists() or not any(other.iterdir())


def attempt(file, other):
    """Return the result of restoring a backup that looks intact: an error, or the original map."""
    try:
        restore(file, other)
    except errors.BadFile as error:
        return error.text
    journal = Journal(other / FILENAME)
    ids = [journal.commit_of(str(number)) for number in range(journal.first, 9)]
    kept = [commit.seq for commit in ids if commit is not None]
    journal.close()
    shutil.rmtree(other)
    return "harmless" if kept == list(range(journal.first, 9)) else f"unnoticed: {kept}"


@pytest.mark.parametrize("semantic_map", ["fresh"], indirect=True)
def test_an_existing_map_is_kept_or_archived(tmp_path, semantic_map):
    backed_up(semantic_map, tmp_path / "b")
    other = tmp_path / "other"
    other.mkdir()
    theirs = home.new_map(other)
    theirs.commit(transaction("theirs", chair("sofa")))
    with pytest.raises(
        errors.Refused, match=r"there is a map in .*other; restore to another folder, or add --repl"
    ):
        restore(tmp_path / "b", other)
    with pytest.raises(errors.Refused, match="another knowledge base is using"):
        restore(tmp_path / "b", other, replace=True)
    home.close(theirs)
    before = (other / FILENAME).read_bytes()
    restored = restore(tmp_path / "b", other, replace=True)
    (kept,) = (other / "kept").iterdir()
    assert restored.kept == str(kept)
    assert restored.text.endswith(f"; the previous map was moved to {kept}")
    assert (kept / FILENAME).read_bytes() == before
    assert len(opened(other)[1]) == len(list(semantic_map._journal.commits()))


def test_other_files_are_rejected(tmp_path):
    (tmp_path / "b").write_text("a shopping list")
    with pytest.raises(errors.BadFile, match="is not a backup"):
        restore(tmp_path / "b", tmp_path / "other")
    with pytest.raises(errors.BadFile, match="cannot be read: No such file"):
        restore(tmp_path / "c", tmp_path / "other")


def test_compaction_during_a_backup_is_reported(tmp_path, semantic_map):
    journal = semantic_map._journal
    part = backup_parts.read_part(journal, "", size=100)
    compaction.compact(journal, HistoryReader(journal), 7)
    with pytest.raises(errors.Refused, match="was compacted during the backup; start the backup again"):
        backup_parts.read_part(journal, part.next)
    for nonsense in ("x", "1.2", "0.8.9.0.0"):
        with pytest.raises(errors.BadRequest, match="invalid position of a backup part"):
            backup_parts.read_part(journal, nonsense)
