"""Surfaces are requested once, and again for new models."""

from __future__ import annotations

import asyncio

import pytest

from semmap.nodes.extern.web.scene.assets import Assets
from semmap.schemas import errors
from semmap.schemas.scenes import SurfaceQuery, Surfaces
from tests.extern.web.scene.sample_scenes import body, scene, surface


class Live:
    """A stub of `Live` with a simulator that replies, fails, or changes during a request."""

    def __init__(self, now):
        self.scene, self.asked, self.refuses, self.meanwhile = now, [], False, None

    async def query(self, prefix, call):
        self.asked.append(call.VERB)
        if self.meanwhile is not None:
            self.scene, self.meanwhile = self.meanwhile, None
        if self.refuses:
            raise errors.NoAnswer("no simulator answers")
        if isinstance(call, SurfaceQuery):
            return Surfaces(surfaces={name: surface() for name in call.names})
        return surface((4.0, 0.1, 2.5))


@pytest.fixture
def made():
    live, changed = Live(scene(body("chair1"), body("chair2"))), []
    return Assets(live, lambda: changed.append(True)), live, changed


def test_each_model_and_the_walls_are_requested_once(made):
    assets, live, changed = made
    asyncio.run(assets.fetch())
    asyncio.run(assets.fetch())
    assert live.asked == ["surfaces", "world"]
    assert assets.surface_of("chair", (0.5, 0.5, 1.0)) == surface()
    assert assets.walls is not None
    assert changed == [True]


def test_models_that_arrive_during_a_request_are_requested_too(made):
    assets, live, _ = made
    live.meanwhile = scene(body("chair1"), body("table1", model="table"))
    asyncio.run(assets.fetch())
    assert assets.surface_of("table", (0.5, 0.5, 1.0)) is not None


def test_failed_requests_are_repeated_and_a_new_simulator_has_new_walls(made):
    assets, live, _ = made
    live.refuses = True
    assert not asyncio.run(assets.fetch())
    assert assets.surface_of("chair", (0.5, 0.5, 1.0)) is None
    assert assets.walls is None
    live.refuses = False
    assert asyncio.run(assets.fetch())
    assert assets.surface_of("chair", (0.5, 0.5, 1.0)) is not None
    assert (walls := assets.walls) is not None
    live.scene = scene(body("chair1"), run="2")
    assert asyncio.run(assets.fetch())
    assert assets.walls is not walls


def test_files_are_cached_by_appearance(made):
    assets, _, _ = made
    asyncio.run(assets.fetch())
    key = ("solid", "chair", (0.5, 0.5, 1.0), ())
    assert assets.glb(key) is assets.glb(key)
    assert assets.glb(("past", "chair", (0.5, 0.5, 1.0), ())) != assets.glb(key)
