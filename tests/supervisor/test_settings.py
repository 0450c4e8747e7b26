from __future__ import annotations

import pytest

from semmap.nodes.supervisor.settings import Settings
from semmap.schemas import codec, errors


def settings(**fields) -> Settings:
    return Settings(data="/d", tbox="/t", abox=None, world="/w", **fields)


def test_the_coordinator_listens_and_the_others_connect_to_it():
    chosen = settings(listen="tcp/127.0.0.1:7000", connect=("tcp/127.0.0.1:7447",))
    door, other = chosen.network("coordinator"), chosen.network("kb_node")
    assert (door.listen, door.connect) == (("tcp/127.0.0.1:7000",), ("tcp/127.0.0.1:7447",))
    assert other.connect == ("tcp/127.0.0.1:7000", "tcp/127.0.0.1:7447")
    assert other.listen == ("tcp/127.0.0.1:0",)
    assert "router" not in chosen.nodes


@pytest.mark.parametrize(
    "fields",
    [
        {"listen": "tcp/0.0.0.0:7447"},
        {"connect": ("tcp/10.0.0.1:7447",)},
        {"only": ("kb_node", "coordinator")},
        {"only": ("sim_node",), "connect": ("tcp/127.0.0.1:7448",)},
    ],
)
def test_with_remote_clients_all_nodes_connect_to_a_router(fields):
    chosen = settings(**fields)
    router = chosen.network("router")
    assert chosen.nodes[0] == "router"
    assert (router.mode, router.listen, router.connect) == ("router", (chosen.listen,), chosen.connect)
    for node in chosen.nodes[1:]:
        network = chosen.network(node)
        assert (network.mode, network.listen, network.connect) == ("client", (), (chosen.reachable,))


def test_a_single_node_joins_the_router_of_another_host():
    there = ("tcp/10.0.0.1:7447",)
    assert settings(connect=there, single=True).network("recorder").connect == there


def test_a_part_has_the_nodes_that_are_named():
    assert settings(only=("sim_node", "kb_node")).nodes == ("router", "kb_node", "sim_node")
    assert settings(only=("router",)).nodes == ("router",)


def test_without_a_local_coordinator_perception_may_use_the_simulator():
    part = {"perception": True, "camera_hz": 5.0}
    assert settings(**part, only=("sim_node", "perception_node")).camera_hz == 5.0
    with pytest.raises(ValueError, match="--truth map"):
        settings(**part, only=("sim_node", "perception_node", "coordinator"))


@pytest.mark.parametrize(
    ("listen", "reachable"),
    [("tcp/0.0.0.0:7447", "tcp/127.0.0.1:7447"), ("tcp/[::]:7447", "tcp/[::1]:7447")],
)
def test_a_wildcard_listener_is_reached_on_loopback(listen, reachable):
    assert settings(listen=listen).reachable == reachable


def test_nodes_can_be_left_out():
    assert settings().nodes == ("coordinator", "kb_node", "sim_node", "recorder")
    assert settings(sim=False, record=False).nodes == ("coordinator", "kb_node")
    assert settings(perception=True).nodes[-1] == "perception_node"


def test_settings_survive_the_file_and_are_checked():
    chosen = settings(threshold_m=0.1, truth="perceived", perception=True, when_gone="mark")
    assert codec.decode(codec.encode_json(chosen), Settings) == chosen
    with pytest.raises(errors.BadRequest, match="angle_threshold_deg"):
        codec.decode(codec.encode_json(settings(angle_threshold_deg=-1.0)), Settings)


def test_perception_cannot_use_cameras_that_show_the_map():
    for truth in ("map", "scene"):
        with pytest.raises(
            ValueError, match=f"--truth {truth} .* add --truth perceived, or use other cameras"
        ):
            settings(perception=True, truth=truth, camera_hz=5.0)
        assert settings(perception=True, truth=truth).perception  # frames of other cameras
    assert settings(perception=True, truth="perceived", camera_hz=5.0).perception


@pytest.mark.parametrize("endpoint", ["foo", "tcp/", "/127.0.0.1:7447", "tcp/127.0.0.1:65536", ""])
def test_an_invalid_endpoint_is_rejected(endpoint):
    for fields in ({"listen": endpoint}, {"connect": ("tcp/10.0.0.1:7447", endpoint)}):
        with pytest.raises(ValueError, match=f"'{endpoint}' is not a valid endpoint; use tcp/HOST:PORT"):
            settings(**fields)


@pytest.mark.parametrize("endpoint", ["tcp/[::1]:7447", "unixsock-stream//tmp/a", "tls/robot.local:65535"])
def test_endpoints_of_any_protocol_are_taken(endpoint):
    assert settings(listen=endpoint).listen == endpoint


@pytest.mark.parametrize("limit", ["", "7", "7w", "0d", "-1GB"])
def test_the_limit_of_recordings_is_an_age_or_a_size(limit):
    with pytest.raises(ValueError, match="examples: 12h, 7d, 500MB, 20GB"):
        settings(record_keep=limit)
    assert settings(record_keep="7d").record_keep == "7d"


def test_only_a_router_by_itself_is_for_all_robots(tmp_path):
    said = {"data": str(tmp_path), "tbox": "t", "abox": None, "world": "w", "namespace": "*"}
    with pytest.raises(errors.BadRequest, match="is not a valid robot name"):
        codec.convert(said, Settings)
    shared = codec.convert({**said, "single": True}, Settings)
    assert (shared.namespace, shared.network("router").namespace) == ("*", "")
