"""The client for an event loop, with a system whose map is empty."""

from __future__ import annotations

import asyncio
import inspect
import time
from types import SimpleNamespace

import pytest

import semmap
from semmap import aio
from semmap.nodes.extern import connection
from semmap.testing import free_endpoint

CUPS = "SELECT ?cup { ?cup a dm:Cup }"


@pytest.fixture(scope="module")
def endpoint(empty_map):
    return empty_map.endpoint


def run(coroutine):
    return asyncio.run(asyncio.wait_for(coroutine, 60.0))


def test_the_verbs_are_those_of_the_client():
    assert inspect.signature(aio.AsyncClient.add) == inspect.signature(semmap.Client.add)
    verbs = {name for name in dir(semmap.Client) if not name.startswith("_")}
    assert verbs - {"session"} == {name for name in dir(aio.AsyncClient) if not name.startswith("_")}


def test_a_verb_is_awaited(endpoint):
    async def main():
        async with aio.connect(endpoint, agent="loop") as client:
            added = await client.add("Cup", "cup1", at=(1.0, 2.0, 0.7))
            entity = await client.get("cup1")
            with pytest.raises(semmap.UnknownName):
                await client.get("cup2")
            (commit,) = await client.history("cup1")
            assert (await client.remove("cup1")).names == ("cup1",)
            return added.names, entity.class_, commit.agent

    assert run(main()) == (("cup1",), "Cup", "loop")


def test_several_are_under_way_at_once(endpoint):
    async def main():
        async with aio.connect(endpoint) as client:
            names = [f"plate{n}" for n in range(20)]
            await asyncio.gather(*(client.add("Plate", name, at=(1.0, 1.0, 0.0)) for name in names))
            found = {entity.name for entity in await client.list("Plate")}
            await client.remove(*names)
            return found == set(names)

    assert run(main())


def test_the_loop_goes_on_while_a_reply_is_waited_for(endpoint):
    async def main():
        async with aio.connect(endpoint) as client:
            ticks = 0
            checking = asyncio.ensure_future(client.check("owlrl"))
            while not checking.done() and ticks < 100:
                ticks += 1
                await asyncio.sleep(0)
            checking.cancel()
            return ticks

    assert run(main()) == 100


def test_commits_are_iterated(endpoint):
    async def main():
        async with aio.connect(endpoint) as client, client.commits() as commits:
            for name in ("bowl1", "bowl2"):
                await client.add("Bowl", name, at=(2.0, 2.0, 0.0))
            seen = [(await anext(commits)).names for _ in range(2)]
            await client.remove("bowl1", "bowl2")
            return seen

    assert run(main()) == [("bowl1",), ("bowl2",)]


def test_a_commit_that_does_not_come_is_waited_for_so_long(endpoint):
    async def main():
        async with aio.connect(endpoint) as client, client.commits(timeout=0.2) as commits:
            with pytest.raises(semmap.NoAnswer, match=r"no commit received within 0\.2 s"):
                await anext(commits)

    run(main())


def test_an_iterator_of_commits_ends_with_the_session(endpoint):
    async def main():
        async with aio.connect(endpoint) as client:
            async with client.commits() as commits:
                waiting = asyncio.ensure_future(anext(commits, "the end"))
                await asyncio.sleep(0.1)
            return await waiting

    assert run(main()) == "the end"


def test_a_standing_query_is_followed(endpoint):
    async def main():
        async with aio.connect(endpoint) as client, client.watch(CUPS) as standing:
            assert standing.rows == ()
            news = standing.changes(timeout=20.0)
            await client.add("Cup", "cup5", at=(1.0, 2.0, 0.7))
            appeared = (await anext(news)).appeared
            await client.remove("cup5")
            disappeared = (await anext(news)).disappeared
            return appeared, disappeared

    appeared, disappeared = run(main())
    assert appeared == disappeared
    assert semmap.local_name(appeared[0][0]) == "cup5"


def test_a_query_that_is_none_is_refused(endpoint):
    async def main():
        async with aio.connect(endpoint) as client:
            with pytest.raises(semmap.BadRequest):
                async with client.watch("nonsense"):
                    pass

    run(main())


def test_without_a_system_the_error_is_immediate(monkeypatch):
    def wait(_):
        pytest.fail("it waits for a system that is starting")

    monkeypatch.setattr(connection, "time", SimpleNamespace(monotonic=time.monotonic, sleep=wait))

    async def main():
        async with aio.connect(free_endpoint()):
            pass

    with pytest.raises(semmap.NoAnswer, match="no response from"):
        run(main())
