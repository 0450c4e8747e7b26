"""Floor plans and routes are requested with the walls of the simulated world, if there is one."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from semmap.nodes.coordinator.scene.wall_queries import WallQueries
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import PlanOf, WayOf
from semmap.schemas.plans import Outline, WallsQuery

WALL = Outline(corners=((0.0, 0.0), (4.0, 0.0), (4.0, 0.1)), low=0.0, high=2.5)


def answered(result) -> Future:
    future: Future = Future()
    if isinstance(result, Exception):
        future.set_exception(result)
    else:
        future.set_result(result)
    return future


def asked(query, walls=(WALL,), *, known=True):
    """Return the requests to the simulator and to the knowledge base, and the reply."""
    to_simulator, to_map = [], []
    queries = WallQueries(
        SimpleNamespace(scene=SimpleNamespace(known=known)),
        lambda call: to_simulator.append(call) or answered(walls),
        lambda call: to_map.append(call) or answered("reply"),
    )
    return to_simulator, to_map, query(queries)


def test_a_plan_has_the_walls_of_the_scene():
    to_simulator, to_map, reply = asked(lambda queries: queries.plan(c.PlanFloor(as_of=7)))
    assert to_simulator == [WallsQuery()]
    assert to_map == [PlanOf(as_of=7, walls=(WALL,))]
    assert reply.result() == "reply"


def test_a_route_has_the_walls_of_the_scene_and_all_that_was_asked():
    query = c.FindWay(from_="door1", to="fridge1", radius=0.4, heights=(0.1, 1.5), as_of=7)
    _, to_map, reply = asked(lambda queries: queries.route(query))
    assert to_map == [
        WayOf(from_="door1", to="fridge1", radius=0.4, heights=(0.1, 1.5), as_of=7, walls=(WALL,))
    ]
    assert reply.result() == "reply"


def test_without_a_scene_the_simulator_is_not_asked():
    to_simulator, to_map, reply = asked(lambda queries: queries.plan(c.PlanFloor()), known=False)
    assert (to_simulator, to_map) == ([], [PlanOf(walls=None)])
    assert reply.result() == "reply"


def test_a_simulator_that_ended_leaves_the_walls_unknown():
    _, to_map, reply = asked(lambda queries: queries.plan(c.PlanFloor()), errors.NoAnswer("it ended"))
    assert to_map == [PlanOf(walls=None)]
    assert reply.result() == "reply"


def test_another_error_of_the_simulator_is_that_of_the_query():
    _, to_map, reply = asked(lambda queries: queries.plan(c.PlanFloor()), errors.InternalError("a fault"))
    assert to_map == []
    with pytest.raises(errors.InternalError, match="a fault"):
        reply.result()
