"""Perception end to end: spawned processes, simulated cameras, and a map that perception fills."""

from __future__ import annotations

import math
import os
import re
import signal

import numpy as np
import pytest

from semmap.nodes import bus
from semmap.schemas import keys
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.perception import Observations
from semmap.schemas.scenes import (
    BodiesMoved,
    BodyOrder,
    Delete,
    Deleted,
    MoveBodies,
    Placement,
    Spawn,
    Spawned,
)
from tests.conftest import running, until
from tests.perception_node.detection.models import write_model, yolov8
from tests.recorder.files import column

TOP_Z = 0.74
WORLD = f"""<mujoco>
<visual><quality shadowsize="0" offsamples="0"/><headlight ambient=".4 .4 .4" diffuse=".5 .5 .5"/></visual>
<worldbody>
<light pos="0 0 3" dir="0 0 -1"/>
<geom name="floor" type="plane" size="4 4 .1" rgba=".8 .78 .72 1"/>
<geom name="top" type="box" size=".6 .4 .02" pos="0 0 {TOP_Z - 0.02}" rgba=".55 .4 .3 1"/>
<camera name="left" pos="-.9 -.9 1.6" xyaxes=".707 -.707 0 .4 .4 .82" fovy="45"/>
<camera name="right" pos=".9 -.9 1.6" xyaxes=".707 .707 0 -.4 .4 .82" fovy="45"/>
</worldbody></mujoco>"""


@pytest.mark.parametrize("graphics", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_thing_put_on_the_table_is_known_moved_gone_and_recorded(tmp_path, monkeypatch, graphics):
    if not graphics:  # the cameras cast rays
        monkeypatch.setenv("MUJOCO_GL", "disabled")
    world = tmp_path / "world.xml"
    world.write_text(WORLD)
    words = ("--world", world, "--truth", "perceived", "--perception")  # and an empty map
    with running(tmp_path, *words) as system, system.client() as client:
        looks: list[Observations] = []
        bus.follow(client.session, keys.OBSERVATIONS, lambda _, seen: looks.append(seen))
        until(lambda: looks, "the cameras see")

        put(client, "a_bottle", "bottle", 0.1, 0.05)
        bottle = until(lambda: there(client, 0.1, 0.05), "it becomes an entity")
        assert bottle.class_ == "Bottle"
        assert bottle.pose.position_m == pytest.approx((0.1, 0.05, TOP_Z), abs=0.02)
        assert bottle.provenance.source == "perception"
        assert bottle.provenance.agent == "perception_node"
        assert bottle.preferred_reference == "bottle"
        assert 0.5 < bottle.provenance.confidence <= 1.0
        assert bottle.body.status == "none"
        until(lambda: bottle.name in {o.entity for o in looks[-1].observations}, "it is seen again")

        move(client, "a_bottle", -0.3, -0.15)
        moved = until(lambda: there(client, -0.3, -0.15), "the map follows")
        assert moved.name == bottle.name
        assert there(client, 0.1, 0.05) is None
        until(lambda: client.last_seen(bottle.name).seen_ns, "it is seen again after that commit")
        assert client.last_seen(bottle.name).text == "in view of a camera now"

        bus.ask(client.session, keys.SIM, "delete", Delete(names=("a_bottle",)), Deleted)
        until(lambda: bottle.name not in {e.name for e in client.list()}, "it leaves the map")
        sighting = client.last_seen(bottle.name)
        assert sighting.gone == sighting.removed
        assert re.match(r"reported missing at commit \d+, \d+ s ago: bottle1 is gone: ", sighting.text)

        status = client.status()
        assert status.truth == "perceived"
        assert "perception_node" in {node.node for node in status.nodes}
        assert not any(node.last_error for node in status.nodes)

        (pid,) = [node.pid for node in status.nodes if node.node == "perception_node"]
        os.kill(pid, signal.SIGKILL)
        put(client, "another_bottle", "bottle", 0.1, 0.05)
        another = until(lambda: there(client, 0.1, 0.05), "a new process sees")
        assert (another.class_, another.name) == ("Bottle", "bottle2")  # who watches knows bottle1 as gone

    (recording,) = (tmp_path / "recordings").glob("*.rrd")
    labels = column(recording, "/map/perception/boxes", "Boxes3D:labels")
    assert any(label.startswith(f"{bottle.name}: Bottle") for label in labels)
    assert column(recording, "/map/perception/cloud", "Points3D:positions")
    for camera in ("left", "right"):
        assert column(recording, f"/map/perception/cameras/{camera}", "EncodedImage:blob")


@pytest.mark.long
def test_a_detector_s_model_labels_things_in_its_own_words_and_they_are_found_by_them(tmp_path):
    pytest.importorskip("onnxruntime")
    world, model = tmp_path / "world.xml", tmp_path / "drill.onnx"
    world.write_text(re.sub("<camera name=.right.*/>", "", WORLD))
    names = {"names": "['power drill', 'container']"}
    seen = [(*box_in_image(0.1, 0.05, 0.25), 0, 0.9), (*box_in_image(-0.25, 0.1, 0.25), 1, 0.9)]
    write_model(model, {"output0": yolov8(seen, classes=2)}, metadata=names)
    words = ("--world", world, "--truth", "perceived", "--perception", "--detector", model)
    with running(tmp_path, *words) as system, system.client() as client:
        put(client, "a_bottle", "bottle", 0.1, 0.05)
        put(client, "another", "bottle", -0.25, 0.1)
        drill = until(lambda: there(client, 0.1, 0.05), "it becomes an entity")
        until(lambda: there(client, -0.25, 0.1), "the other, too")
        assert drill.preferred_reference == "power drill"
        assert [one.entity for one in client.find("the power drill").candidates] == [drill.name]
        assert any("detector drill.onnx" in node.detail for node in client.status().nodes)


def box_in_image(x, y, height_m):
    """Middle and size of a bottle on the table in the left camera's image, padded to 640 x 640."""
    right, up = np.array([0.707, -0.707, 0.0]), np.array([0.4, 0.4, 0.82])
    right, up = right / np.linalg.norm(right), up / np.linalg.norm(up)
    corners = np.array(
        [(x + dx, y + dy, TOP_Z + z) for dx in (-0.04, 0.04) for dy in (-0.04, 0.04) for z in (0, height_m)]
    ) - [-0.9, -0.9, 1.6]
    focal = 240 / math.tan(math.radians(22.5))
    depth = corners @ -np.cross(right, up)
    columns, rows = 320 + focal * (corners @ right) / depth, 240 - focal * (corners @ up) / depth + 80
    low, high = np.array([columns.min(), rows.min()]), np.array([columns.max(), rows.max()])
    return (*((low + high) / 2), *(high - low))


def there(client, x, y):
    """The entity that stands on the table at x and y."""
    return next(
        (
            e
            for e in client.list()
            if e.pose.position_m[2] > TOP_Z / 2 and math.dist(e.pose.position_m[:2], (x, y)) < 0.06
        ),
        None,
    )


def put(client, name, model, x, y):
    pose = Pose(position_m=(x, y, TOP_Z + 0.002))
    body = BodyOrder(name=name, class_="Object", model=model, pose=pose, commit=0)
    assert not bus.ask(client.session, keys.SIM, "spawn", Spawn(bodies=(body,)), Spawned).failed


def move(client, name, x, y, yaw=1.0):
    pose = Pose(position_m=(x, y, TOP_Z + 0.002), orientation_wxyz=orientation_from_yaw(yaw))
    order = MoveBodies(placements=(Placement(name=name, pose=pose),))
    assert not bus.ask(client.session, keys.SIM, "move", order, BodiesMoved).failed
