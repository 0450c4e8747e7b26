from semmap.nodes.extern.web.views import log_lines
from semmap.nodes.extern.web.views.log_lines import WARNING, Log, line_of, rows_of
from semmap.schemas.changes import Change
from semmap.schemas.health import Health
from semmap.schemas.replies import LoggedCommit


def logged(seq, **others):
    about = {"source": "operator", "agent": "ann", "verb": "update", "reason": "", "changed": ("cup1",)}
    return LoggedCommit(
        seq=seq, stamp_ns=seq * 1_000_000_000, confidence=None, undoes=(), tbox=False, inserted=2,
        retracted=2, removed=(), **(about | others),
    )  # fmt: skip


def beat(error, stamp=0):
    return Health(node="sim_node", pid=1, started_ns=0, stamp_ns=stamp, state="ready", last_error=error)


def test_commits_are_listed_once_the_newest_first():
    log = Log()
    log.add_commits([logged(1), logged(3)])
    log.add_commits([logged(3), logged(2)])
    assert [line.commit for line in log.lines] == [3, 2, 1]
    assert log.last == 3


def test_a_line_has_the_reason_and_the_changes():
    commit = logged(4, reason="tidied up", notes=("carried plate1 along",), changed=("cup1", "plate1"))
    line = line_of(commit)
    assert line.by == "operator/ann"
    assert line.text == "tidied up: 2 entities (carried plate1 along)"
    assert line.names == ("cup1", "plate1")
    assert line_of(logged(5)).text == "update: 1 entity"


def test_a_lasting_error_is_listed_once():
    log = Log()
    for stamp, error in enumerate(("no room", "no room", "", "no room")):
        log.add_health(beat(error, stamp))
    assert [line.text for line in log.lines] == ["no room", "no room"]
    assert all(line.kind == WARNING for line in log.lines)


def test_lines_can_be_filtered_by_words_and_kinds():
    log = Log()
    log.add_commits([logged(1), logged(2, source="perception", agent="")])
    log.add_health(beat("no room", 5_000_000_000))
    assert [row["commit"] for row in rows_of(log.lines)] == ["", "2", "1"]
    assert [row["commit"] for row in rows_of(log.lines, "ANN entity")] == ["1"]
    assert [row["kind"] for row in rows_of(log.lines, kinds=("warning", "perception"))] == [
        "warning",
        "perception",
    ]
    assert len({row["id"] for row in rows_of(log.lines)}) == 3


def test_old_lines_are_removed(monkeypatch):
    monkeypatch.setattr(log_lines, "MOST", 3)
    log = Log()
    log.add_commits(logged(seq) for seq in range(1, 10))
    assert [line.commit for line in log.lines] == [9, 8, 7]
    log.clear()
    assert (log.lines, log.last) == ([], 0)


def test_changes_are_shown_in_words():
    change = Change(name="cup1", kind="reference", was="cup", now="<b>mug</b>")
    text = line_of(logged(2, changes=(change,))).text
    assert text == f"update: cup1: {change.text}"
    assert "<b>mug</b>" in text
