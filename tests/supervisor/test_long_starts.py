"""Long starts report their progress, and a world is compiled only when needed."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import pytest

from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.world_file import require_world
from semmap.nodes.supervisor import control, up
from semmap.nodes.supervisor.control import Supervisor
from semmap.nodes.supervisor.settings import Settings
from semmap.ontology import EMPTY_WORLD, HOUSEHOLD_TTL
from semmap.schemas.errors import BadFile
from semmap.schemas.health import Health

WORLD = """<mujoco><worldbody><geom type="plane" size="5 5 1"/>
<body name="box1" pos="0 0 0.1"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"""


def of(data: Path, world: str = str(EMPTY_WORLD)) -> Settings:
    return Settings(data=str(data), tbox=str(HOUSEHOLD_TTL), abox=None, world=world)


def starting(detail: str) -> Health:
    return Health(node="sim_node", pid=os.getpid(), started_ns=0, stamp_ns=0, state="starting", detail=detail)


def test_seeding_reports_the_elapsed_time(tmp_path, monkeypatch):
    monkeypatch.setattr(control, "SILENT_S", 0.05)
    told: list[float] = []
    made = Supervisor(tmp_path / "data").seed(of(tmp_path / "data"), told.append)
    assert "0 entities" in made
    assert len(told) > 1
    assert told == sorted(told)


def test_the_compiled_world_is_reported(tmp_path):
    settings = of(tmp_path, "/there/big.xml")
    assert up._describe_seeding(settings, 12.3).endswith(
        "compiling the world big.xml and loading the map (12 s)"
    )
    settings = of(tmp_path)
    assert up._describe_seeding(settings, 12.3).split(maxsplit=1)[1] == "loading the map (12 s)"


def test_a_starting_node_reports_its_progress(tmp_path, monkeypatch):
    said: list[str] = []
    foreground = up._Foreground(Supervisor(tmp_path), of(tmp_path), None, None, said.append)
    foreground._watchdog.run_as({"sim_node": os.getpid()})
    foreground._on_health(starting("compiling the world big.xml"))
    assert not said
    monkeypatch.setattr(up, "SILENT_S", 0.0)
    foreground._on_health(starting(""))
    foreground._on_health(starting("compiling the world big.xml"))
    assert [line.split(maxsplit=1)[1] for line in said] == ["compiling the world big.xml (0 s)"]


def test_a_world_is_compiled_no_more_often_than_it_must(tmp_path, monkeypatch):
    """With 5 000 bodies, each compilation takes five seconds."""
    path = tmp_path / "world.xml"
    path.write_text(WORLD)
    times = []
    compiled = base_scene._compiled
    monkeypatch.setattr(base_scene, "_compiled", lambda spec: times.append(1) or compiled(spec))
    require_world(path, build)
    assert not times
    base_scene.prepare(mujoco.MjSpec.from_file(str(path)))
    assert len(times) == 1


def test_a_world_that_does_not_compile_is_still_rejected(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text(WORLD.replace('size="0.1"', 'size="-1"'))
    with pytest.raises(BadFile, match="cannot compile world file"):
        require_world(path, build)
