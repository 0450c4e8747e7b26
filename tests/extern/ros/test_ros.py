import collections
import contextlib
import itertools
import json
import queue
import re
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from semmap.nodes import bus
from semmap.nodes.bus.rmw import RosNode
from semmap.nodes.extern.ros import messages
from semmap.nodes.extern.ros.types import decode, encode, topic
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import codec
from semmap.schemas.scenes import CameraFrame
from tests.conftest import PATIENCE_S, until
from tests.extern.ros.made import AT, thing

ADD, REMOVE, MOVE = 0, 1, 3


@pytest.fixture(scope="module")
def router():
    """A Zenoh router such as rmw_zenoh's."""
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(connect=(), listen=(endpoint,), mode="router")):
        yield endpoint


class Listener:
    """Another party's node of ROS."""

    def __init__(self, process):
        self._process = process
        self._heard = collections.defaultdict(queue.SimpleQueue)
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self._process.stdout:
            if line.startswith("["):
                name, what = json.loads(line)
                self._heard[name].put(what)

    def hears(self, topic, fits=lambda what: True):
        """Wait for a message of a topic that fits."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            what = self._heard[topic].get(timeout=max(0.0, deadline - time.monotonic()))
            if fits(what):
                return what

    def has_heard(self, topic, fits):
        """Whether a message that fits is among those that have come."""
        return any(fits(self._heard[topic].get()) for _ in range(self._heard[topic].qsize()))

    def sends_a_frame(self, stamp_ns):
        self._process.stdin.write(f"{stamp_ns}\n")
        self._process.stdin.flush()


@contextlib.contextmanager
def listening(router):
    command = [sys.executable, "-m", "tests.extern.ros.listener", router.rpartition(":")[2]]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        try:
            yield Listener(process)
        finally:
            process.kill()


@pytest.fixture
def bridged(flat, router):
    """`semmap ros` at work."""
    words = ("ros", "--router", router, "--camera", "front=/a/color,/a/depth,/a/info")
    with flat.spawned(*words, stderr=subprocess.PIPE) as process:
        assert any(re.search("publishing [0-9]+ entities", line) for line in process.stderr)
        yield flat
        process.stderr.close()


def test_another_party_sees_the_map_and_its_changes(bridged, router):
    with bridged.client() as client, listening(router) as ros:
        assert "kitchen1" in ros.hears("/tf")
        whole = ros.hears("/planning_scene", lambda objects: len(objects) > 10)
        assert ["table1", ADD] in whole  # though it came later
        client.add("Cup", "cup77", at=(2.0, 2.0, 0.0), size=(0.1, 0.1, 0.1))
        assert ros.hears("/planning_scene", lambda objects: ["cup77", ADD] in objects)
        places = itertools.count(1)

        def moves():  # more than once: in the first seconds all of it is said again, as new
            client.update("cup77", at=(2.0 + 0.01 * next(places), 2.0, 0.0))
            return ros.has_heard("/planning_scene", lambda objects: ["cup77", MOVE] in objects)

        until(moves, "that it has moved")
        assert ["cup77", "Cup"] in ros.hears("/semmap/detections", lambda all_: ["cup77", "Cup"] in all_)
        assert "cup77" in ros.hears("/semmap/markers", lambda texts: "cup77" in texts)
        width, height, values = ros.hears("/semmap/map")
        assert (width * 0.05, height * 0.05) == pytest.approx((11.0, 9.0), abs=0.3)  # and half a metre around
        assert values == [-1, 0, 100]
        client.remove("cup77")
        assert ros.hears("/planning_scene", lambda objects: ["cup77", REMOVE] in objects)
        drawn = ros.hears("/semmap/markers", lambda texts: "cup77" not in texts)
        assert drawn[0] == ""  # deletes all that was drawn
        assert "table1" in drawn


def test_semmap_itself_is_not_a_router(flat):
    assert "is a Zenoh peer, not a router" in flat.cli("ros", "--router", flat.endpoint, status=2)


def test_another_party_sees_the_frames_that_others_publish(bridged, router):
    with bridged.client() as client, listening(router) as ros:
        client.publish_frame("dock", "map", at=(4.0, 1.0, 0.0), fixed=True)
        client.publish_frame("dock/beacon", "dock", at=(0.0, 0.0, 0.4), fixed=True)
        client.publish_frame("fridge1", "dock", fixed=True)  # the entity keeps its name
        assert ros.hears("/tf", lambda frames: {"dock", "dock>dock/beacon"} <= set(frames))
        client.publish_frame("dock", "dock/beacon", fixed=True)  # in one another: ignored
        client.publish_frame("after", "map", fixed=True)
        heard = ros.hears("/tf", lambda frames: {"table1", "after"} <= set(frames))
        assert "dock/beacon>dock" not in heard
        assert "dock>fridge1" not in heard
        client.withdraw_frame("dock/beacon")
        assert ros.hears("/tf", lambda frames: "dock" in frames and "dock>dock/beacon" not in frames)
        client.withdraw_frame("dock")
        client.withdraw_frame("after")


def test_who_comes_later_hears_what_is_latched(router):
    with bus.open_session(bus.Network(connect=(router,))) as session:
        made = topic("/latched", "vision_msgs/msg/Detection3DArray", latched=True)
        node = RosNode(session, "semmap", 0)
        node.publish(made).put(encode(messages.detections([thing()], AT)))
        with listening(router) as ros:
            assert ros.hears("/latched") == [["cup1", "Cup"]]
        heard = queue.SimpleQueue()
        node.subscribe(made, heard.put)
        assert decode(heard.get(timeout=PATIENCE_S), made.type).detections[0].id == "cup1"


def test_frames_of_another_partys_camera_reach_perception(bridged, router):
    found = {}
    with bridged.client() as client, listening(router) as ros:

        def keep(sample):
            frame = codec.decode(sample.attachment.to_bytes(), CameraFrame)
            found[str(sample.key_expr)] = (frame, sample.payload.to_bytes())

        subscriber = client.session.declare_subscriber("semmap/sim/camera/front/*", keep)
        ros.hears("ready")
        stamps = iter(range(1, 1000))

        def both():
            ros.sends_a_frame(next(stamps) * 1_000_000_000)
            return len(found) == 2

        until(both, "colour and depth")
        subscriber.undeclare()
    frame, pixels = found["semmap/sim/camera/front/rgb"]
    assert (frame.width, frame.height, frame.map_from_camera[11]) == (6, 4, 1.0)
    assert pixels == np.arange(4 * 6 * 3, dtype=np.uint8).tobytes()
    _, depth = found["semmap/sim/camera/front/depth"]
    assert set(np.frombuffer(depth, "<f4").tolist()) == {1.5}


def test_a_router_that_is_not_there_is_named(flat):
    said = flat.cli("ros", "--router", "tcp/127.0.0.1:1", status=3)
    assert "no response from a ROS router at tcp/127.0.0.1:1" in said


def test_an_invalid_camera_is_reported_before_the_start(flat):
    assert "example: front=" in flat.cli("ros", "--camera", "front", status=2)
