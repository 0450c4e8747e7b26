"""The intact part of a damaged or truncated recording."""

import pytest

from semmap.nodes.recorder.intact_part import open_intact_part
from semmap.nodes.recorder.recorded_commits import commits_of, read_commits
from semmap.nodes.recorder.recording import open_recording
from semmap.schemas import errors
from tests.recorder.messages import START_NS, commit


@pytest.fixture
def recording(tmp_path):
    """Return a file with five commits, each in its own message."""
    path = tmp_path / "a.rrd"
    with open_recording(path, None) as recording:
        for seq in range(1, 6):
            recording.set_time(seq, START_NS, None)
            recording.commit(commit(seq))
            recording._stream.flush()
    return path


def test_a_whole_one_is_read_where_it_is(recording):
    with open_intact_part(recording) as whole:
        assert whole == (recording, 0, "")
        assert [c.seq for c in commits_of(whole.path)] == [1, 2, 3, 4, 5]


def test_of_a_damaged_one_what_comes_before_the_damage_is_whole(recording, tmp_path):
    content, bad = recording.read_bytes(), tmp_path / "bad.rrd"
    found = []
    for start in range(800, len(content) - 64, 1500):
        bad.write_bytes(
            content[:start] + bytes(b ^ 0x5A for b in content[start : start + 64]) + content[start + 64 :]
        )
        with open_intact_part(bad) as whole:
            seqs = [c.seq for c in commits_of(whole.path)]
            assert seqs == [1, 2, 3, 4, 5][: len(seqs)] or not whole.left_out  # damage in what is not read
            assert (whole.path == bad) == (not whole.left_out)
        found.append(whole.why)
        assert bad.stat().st_size == len(content)
    assert any(why.startswith("is damaged after ") for why in found)


def test_the_end_of_one_that_was_cut_is_left_out_and_named(recording, tmp_path, caplog):
    cut = tmp_path / "cut.rrd"
    cut.write_bytes(recording.read_bytes()[: recording.stat().st_size // 3])
    with open_intact_part(cut) as whole:
        assert whole.left_out == cut.stat().st_size - whole.path.stat().st_size > 0
        assert whole.describe(cut) == (
            f"{cut} ends in the middle of a message; its last {whole.left_out} bytes are ignored"
        )
    assert not whole.path.exists()
    read_commits(cut)
    assert whole.describe(cut) in caplog.text


def test_what_is_no_recording_is_refused(tmp_path):
    (tmp_path / "a.rrd").write_text("no recording")
    for path, said in (("a.rrd", "is not a recording"), ("b.rrd", "no such file"), (".", "cannot read")):
        with pytest.raises(errors.BadFile, match=said), open_intact_part(tmp_path / path):
            pass
