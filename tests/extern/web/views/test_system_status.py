import pytest
from msgspec import structs

from semmap.nodes.extern.web.views.system_status import (
    KEPT_S,
    Load,
    RateHistory,
    format_headline,
    list_problems,
    node_rows,
)
from semmap.schemas.health import Health
from semmap.schemas.replies import SystemStatus

NOW_NS = 1_000_000_000_000
BEAT = Health(node="kb_node", host="lab", pid=7, started_ns=0, stamp_ns=NOW_NS - 500_000_000, state="ready")


def test_rates_are_differences_of_totals():
    rates = RateHistory()
    rates.add_sample(100.0, commit=10, poses=1000, loads={7: Load(5.0, 1 << 20)})
    assert not rates.is_due(101.0)
    assert rates.is_due(102.0)
    rates.add_sample(102.0, commit=14, poses=1040, loads={7: Load(5.5, 2 << 20), 8: Load(99.0, 1 << 20)})
    (sample,) = rates.samples
    assert sample.commits_hz == pytest.approx(2.0)
    assert sample.poses_hz == pytest.approx(20.0)
    assert sample.memory_mb == pytest.approx(3.0)
    assert sample.cpu_percent == pytest.approx(25.0)


def test_samples_start_again_when_the_clock_was_set_back():
    rates = RateHistory()
    for at_s in (100.0, 102.0):
        rates.add_sample(at_s, commit=1, poses=0, loads={})
    assert rates.is_due(50.0)
    rates.add_sample(50.0, commit=2, poses=0, loads={})
    assert not rates.samples
    rates.add_sample(52.0, commit=6, poses=0, loads={})
    assert [(sample.at_s, sample.commits_hz) for sample in rates.samples] == [(52.0, 2.0)]


def test_a_new_map_or_process_has_no_negative_rate():
    rates = RateHistory()
    rates.add_sample(0.0, commit=10, poses=5, loads={7: Load(50.0, 1)})
    rates.add_sample(2.0, commit=1, poses=0, loads={7: Load(1.0, 1)})
    assert rates.samples[-1][1:3] == (0.0, 0.0)
    assert rates.samples[-1].cpu_percent == 0.0


def test_samples_of_ten_minutes_are_kept():
    rates = RateHistory()
    for second in range(0, 2000, 2):
        rates.add_sample(float(second), second, second, {})
    assert rates.samples[0].at_s >= 1998.0 - KEPT_S
    assert len(rates.samples) <= KEPT_S / 2 + 1


def test_problems_are_listed_by_severity():
    late = structs.replace(BEAT, node="sim_node", stamp_ns=NOW_NS - 20_000_000_000, last_error="no room")
    starting = structs.replace(BEAT, node="recorder", state="starting", detail="waiting")
    health = {beat.node: beat for beat in (BEAT, late, starting)}
    assert list_problems(health, "the knowledge base does not answer", NOW_NS) == (
        "the knowledge base does not answer",
        "recorder: starting (waiting)",
        "sim_node: no heartbeat for 20 s",
        "sim_node: no room",
    )
    assert list_problems({"kb_node": BEAT}, "", NOW_NS) == ()


def test_nodes_are_listed_with_state_and_memory():
    (row,) = node_rows([BEAT], {7: Load(1.0, 300 << 20)}, NOW_NS)
    assert (row["state"], row["memory"], row["beat"], row["host"]) == ("ready", "300 MB", "0.5 s ago", "lab")
    (silent,) = node_rows([structs.replace(BEAT, stamp_ns=0)], {}, NOW_NS)
    assert (silent["state"], silent["memory"]) == ("silent", "")


@pytest.mark.parametrize("client", ["web", "ros"])
def test_an_ended_client_is_not_a_problem(client):
    ended = structs.replace(BEAT, node=client, stamp_ns=NOW_NS - 20_000_000_000)
    assert list_problems({client: ended}, "", NOW_NS) == ()
    assert node_rows([ended], {}, NOW_NS) == []


def test_the_headline_states_whether_map_and_scene_agree():
    status = SystemStatus(truth="map", commit=3, entities=78, bodies=1, in_agreement=True, nodes=())
    assert format_headline(status) == "78 entities, 1 body, commit 3; map and scene agree"
