"""The journals of a replay are copies, and the original does not change."""

import shutil
from contextlib import closing
from pathlib import Path

import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.nodes.kb_node.storage.compaction.compaction import compact
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.replay import journal_copy
from semmap.nodes.kb_node.storage.replay.preparation import SOURCE, prepare
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.documents.tbox.test_tbox_validation import NEW_CLASSES, replace
from tests.kb_node.home import chair, state, transaction
from tests.kb_node.storage.journal.test_journal import flip


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A folder with a map of 6 commits. The fourth replaced the TBox, with checkpoints after 2 and 5."""
    folder = tmp_path_factory.mktemp("whole")
    semantic_map = home.new_map(folder)
    for i in range(1, 7):
        if i == 4:
            replace(semantic_map, i, NEW_CLASSES)
        else:
            semantic_map.commit(transaction(i, chair(f"chair{i}"), reason=f"chair {i}"))
        if i in (2, 5):
            semantic_map.checkpoint()
    home.close(semantic_map)
    return folder


@pytest.fixture
def data(whole, tmp_path):
    """A copy of the folder."""
    return Path(shutil.copytree(whole, tmp_path / "data"))


@pytest.fixture
def folder(tmp_path):
    """The folder of the replay."""
    made = tmp_path / "replay"
    made.mkdir()
    return made


def replayed(folder, until):
    """Return the map of a replay after each commit, and their digests."""
    with closing(Journal(folder / FILENAME)) as journal, closing(Journal(folder / SOURCE)) as source:
        semantic_map = SemanticMap(journal)
        states = [state(semantic_map)]
        for seq in range(semantic_map.seq + 1, until + 1):
            commit = source.commit(seq)
            semantic_map.restate(commit, source.tbox(seq) if commit.tbox else None)
            states.append(state(semantic_map))
        return states, semantic_map.digest


@pytest.mark.parametrize("since", [1, 2, 3, 4, 5, 6])
def test_a_replay_reproduces_the_map(data, folder, since):
    before = {path.name: path.read_bytes() for path in data.iterdir() if path.is_file()}
    assert prepare(data, folder, since=since) == (since, 6)
    states, digest = replayed(folder, 6)
    with closing(Journal(data / FILENAME)) as journal:
        assert digest == journal.digest(6).hex()
        assert states[-1] == state(SemanticMap(journal))
        past = HistoryReader(journal)
        for seq, (_, _, snapshot) in enumerate(states, start=since):
            assert snapshot.entities == past.entities(seq)
    assert before[FILENAME]


def test_the_shapes_of_bodies_are_copied(data, folder):
    (data / body_shapes.FILENAME).write_bytes(b"{}")
    prepare(data, folder)
    assert (folder / body_shapes.FILENAME).read_bytes() == b"{}"


def test_a_journal_in_use_can_be_copied(data, folder):
    with closing(Journal(data / FILENAME)) as journal:
        semantic_map = SemanticMap(journal)
        for i in range(7, 20):
            semantic_map.commit(transaction(i, chair(f"chair{i}")))
            assert prepare(data, folder, since=i - 1).until == i
        assert state(semantic_map) == replayed(folder, 19)[0][-1]


def test_a_restarted_log_repeats_the_copy(data, tmp_path, monkeypatch):
    with closing(Journal(data / FILENAME)) as journal:
        semantic_map = SemanticMap(journal)
        copyfile, times = shutil.copyfile, []

        def copy_slowly(source, to):
            copyfile(source, to)
            if not times:  # enough for SQLite to checkpoint and restart the log
                times.append(1)
                for i in range(7, 11):
                    semantic_map.commit(transaction(i, chair(f"chair{i}"), reason="x" * 1990))
                with journal.file.reading() as db:
                    db.execute("PRAGMA wal_checkpoint(RESTART)").fetchone()
                semantic_map.commit(transaction(11, chair("chair11")))

        monkeypatch.setattr(shutil, "copyfile", copy_slowly)
        to = tmp_path / "copy.sqlite"
        journal_copy.copy(data, to)
        assert times
        with closing(Journal(to)) as copied:
            assert copied.last == 11
            assert state(SemanticMap(copied)) == state(semantic_map)


@pytest.mark.parametrize(
    ("span", "kind", "said"),
    [
        ({"until": 7}, errors.Refused, "there is no commit 7 yet; the last one is 6"),
        (
            {"since": 5, "until": 3},
            errors.BadRequest,
            r"the end \(commit 3\) is before the beginning \(commit 5\)",
        ),
        ({"since": "someday"}, errors.BadRequest, "'someday' is neither a commit number nor a time"),
        ({"since": 0}, errors.Refused, "there was no map at that time"),
    ],
)
def test_an_invalid_span_is_rejected(data, folder, span, kind, said):
    with pytest.raises(kind, match=said):
        prepare(data, folder, **span)


def test_compacted_commits_cannot_be_replayed(data, folder):
    with closing(Journal(data / FILENAME)) as journal:
        compact(journal, HistoryReader(journal), 3)
    assert prepare(data, folder) == (3, 6)
    states, _ = replayed(folder, 6)
    assert len(states) == 4
    with pytest.raises(errors.Refused, match=r"commits before 3 .* have been compacted"):
        prepare(data, folder, since=2)


def test_damage_in_the_span_names_the_original(data, folder):
    flip(data / FILENAME, "commits", 5)
    with pytest.raises(errors.Refused, match=rf"^{data / FILENAME}: commit 5 is damaged; .* --data {data} "):
        prepare(data, folder)
    assert prepare(data, folder, until=4) == (1, 4)


def test_a_missing_map_is_reported(tmp_path, folder):
    with pytest.raises(errors.BadFile, match=f"there is no map in {tmp_path}"):
        prepare(tmp_path, folder)
