"""Commits read back from a recording."""

import pytest

from nodes.recorder.recorded_commits import read_commits
from nodes.recorder.recording import open_recording
from schemas import errors
from tests.recorder.messages import START_NS, commit


def test_what_is_whole_of_a_recording_that_is_cut_is_read(tmp_path, caplog):
    path, cut = tmp_path / "a.rrd", tmp_path / "cut.rrd"
    with open_recording(path, None) as recording:
        for seq in (1, 2, 3):
            recording.at(seq, START_NS, None)
            recording.commit(commit(seq))
            recording._stream.flush()  # each in a message of its own
    content = path.read_bytes()
    found = []
    for size in range(700, len(content), 397):
        cut.write_bytes(content[:size])
        found.append([c.seq for c in read_commits(cut)])
        assert cut.read_bytes() == content[:size]
    assert "cut.rrd ends in the middle of a message; its last " in caplog.text
    assert found == sorted(found)
    assert {tuple(seqs) for seqs in found} == {(), (1,), (1, 2), (1, 2, 3)}
    cut.write_bytes(content[:20])
    with pytest.raises(errors.BadFile, match=f"cannot read {cut}"):
        read_commits(cut)
