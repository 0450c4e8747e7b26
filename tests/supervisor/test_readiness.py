"""What a started system waits for."""

from types import SimpleNamespace

import pytest

from semmap.nodes.supervisor import up
from semmap.nodes.supervisor.control import Supervisor
from semmap.nodes.supervisor.readiness import missing
from semmap.nodes.supervisor.settings import Settings
from semmap.schemas.replies import NodeStatus, SystemStatus

PIDS = {"coordinator": 1, "kb_node": 2, "sim_node": 3, "web": 4}


def status(*nodes, in_agreement=True):
    return SystemStatus(
        truth="map",
        commit=1,
        entities=0,
        bodies=0,
        in_agreement=in_agreement,
        nodes=tuple(
            NodeStatus(node=node, pid=pid, state=state, uptime_s=1.0, heartbeat_age_s=0.1)
            for node, pid, state in nodes
        ),
    )


LATE_KB = "a heartbeat of kb_node to reach the coordinator"
ALL = (("coordinator", 1, "ready"), ("kb_node", 2, "ready"), ("sim_node", 3, "ready"))


@pytest.mark.parametrize(
    ("status", "with_scene", "said"),
    [
        (status(*ALL), True, ""),
        (status(*ALL[:2]), True, "a heartbeat of sim_node to reach the coordinator"),
        (status(ALL[0], ("kb_node", 7, "ready"), ALL[2]), True, LATE_KB),
        (status(ALL[0], ("kb_node", 2, "silent"), ALL[2]), True, LATE_KB),
        (status(*ALL, in_agreement=None), True, "the scene of the simulator to reach the coordinator"),
        (status(*ALL, in_agreement=None), False, ""),
    ],
)  # fmt: skip
def test_what_the_coordinator_lacks_is_named(status, with_scene, said):
    assert missing(status, PIDS, with_scene=with_scene) == said


def test_the_wait_is_reported_regularly_and_at_its_end(tmp_path, monkeypatch):
    said: list[str] = []
    now_s = 100.0
    monkeypatch.setattr(up, "time", SimpleNamespace(monotonic=lambda: now_s))
    settings = Settings(data=str(tmp_path), tbox="", abox=None, world="")
    foreground = up._Foreground(Supervisor(tmp_path), settings, None, None, said.append)
    foreground._report_missing("the scene", 1.0, 30.0)
    foreground._report_missing("", 31.0, 30.0)
    assert not said
    now_s += up.SILENT_S + 1.0
    foreground._report_missing("the scene", 11.0, 30.0)
    foreground._report_missing("the scene", 11.0, 30.0)
    foreground._report_missing("the scene", 31.0, 30.0)
    assert [line.split(maxsplit=1)[1] for line in said] == [
        "waiting for the scene (11 s)",
        "not complete yet: waiting for the scene; see: semmap status",
    ]
