"""Resources: the schema in pages, and standing queries with notifications of changes."""

import asyncio
import json
from urllib.parse import quote

import pytest
from mcp.shared.exceptions import MCPError

from semmap.nodes.extern.mcp import resources
from semmap.nodes.extern.mcp.answers import BUDGET
from semmap.nodes.extern.mcp.limits import Rate
from semmap.nodes.extern.mcp.resources import MOST, Subscriptions
from semmap.nodes.extern.mcp.server import server
from semmap.nodes.extern.mcp.tools import Tools
from semmap.schemas import errors
from tests.extern.mcp.conftest import by_stdio, in_memory, run


@pytest.fixture(scope="module")
def client(flat):
    with flat.client() as client:
        yield client


def made(client):
    return server(Tools(lambda: client, rate=Rate(1e6, 1e6)))


async def read(agent, uri):
    found = await agent.client.read_resource(uri, cache_mode="bypass")
    assert len(found.contents[0].text) <= BUDGET
    return json.loads(found.contents[0].text)


def test_the_schema_lists_every_class_and_property_in_pages(client):
    async def session():
        async with in_memory(made(client)) as agent:
            listed = [str(r.uri) for r in (await agent.client.list_resources()).resources]
            assert listed == [resources.SCHEMA, resources.CLASSES, resources.PROPERTIES]
            assert (await read(agent, resources.SCHEMA))["prefixes"]["dm"].endswith("#")
            found = []
            for uri in (resources.CLASSES, resources.PROPERTIES):
                page = await read(agent, uri)
                lines = page[uri.rpartition("/")[2]]
                while "next" in page:
                    page = await read(agent, f"{uri}/{page['next']}")
                    lines += page[uri.rpartition("/")[2]]
                found.append(lines)
            return found

    classes, properties = run(session())
    assert [line.split(" < ")[0].removeprefix("dm:") for line in classes] == [
        c.name for c in client.classes()
    ]
    assert [line.split(":")[0] for line in properties] == [p.name for p in client.properties()]


@pytest.mark.parametrize("mode", ["2026-07-28", "legacy"])
def test_a_subscriber_of_a_standing_query_is_notified_of_changes(client, mode):
    from mcp import Client

    uri = "semmap://watch/in/kitchen1"
    told = asyncio.Event()

    async def on_message(message):
        if getattr(message, "method", "") == "notifications/resources/updated":
            assert message.params.uri == uri
            told.set()

    async def session():
        async with Client(made(client), mode=mode, message_handler=on_message) as talking:
            agent = type("A", (), {"client": talking})
            before = await read(agent, uri)
            if mode == "legacy":
                await talking.subscribe_resource(uri)
                await asyncio.to_thread(client.add, "Cup", "watched1", at=(7.5, 1.5, 0.0))
                await asyncio.wait_for(told.wait(), 60)
                await talking.unsubscribe_resource(uri)
            else:
                async with talking.listen(resource_subscriptions=[uri]) as events:
                    await asyncio.to_thread(client.add, "Cup", "watched1", at=(7.5, 1.5, 0.0))
                    event = await asyncio.wait_for(anext(aiter(events)), 60)
                    assert event.uri == uri
            return before, await read(agent, uri)

    with pytest.warns() if mode == "legacy" else _nothing():
        before, after = run(session())
    client.undo()
    assert after["total"] == before["total"] + 1
    assert [":watched1"] in after["rows"] or any("watched1" in str(row) for row in after["rows"])
    assert after["commit"] > before["commit"]


class _nothing:  # noqa: N801
    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


@pytest.mark.parametrize(
    ("uri", "row"),
    [
        ("semmap://watch/on/desk1", "cup1"),
        ("semmap://watch/class/Cup", "cup1"),
        ("semmap://watch/query/" + quote("SELECT ?e { ?e a dm:Fridge }", safe=""), "fridge1"),
    ],
)
def test_a_standing_query_can_be_read(client, uri, row):
    assert row in resources.read(client, uri)


@pytest.mark.parametrize(
    "uri",
    [
        "semmap://watch/",
        "semmap://watch/under/table1",
        "semmap://watch/in/",
        "semmap://watch/class/Cup%3E%20%7D",
        "semmap://watch/query/DROP%20ALL",
        "semmap://watch/in/ghost1",
        "semmap://elsewhere",
        "file:///etc/passwd",
        "semmap://schema/classes/nonsense",
    ],
)
def test_an_unknown_resource_is_rejected(client, uri):
    async def session():
        async with in_memory(made(client)) as agent:
            with pytest.raises(MCPError) as refused:
                await agent.client.read_resource(uri)
            return str(refused.value)

    assert "Traceback" not in run(session())


def test_the_number_of_standing_queries_is_limited(client):
    subscriptions = Subscriptions(lambda: client, lambda uri: None)
    try:
        for number in range(MOST):
            subscriptions.subscribe(
                f"semmap://watch/query/SELECT%20%3Fe%20%7B%20%3Fe%20a%20dm%3AC{number}%20%7D"
            )
        with pytest.raises(errors.Refused, match="unsubscribe from one first"):
            subscriptions.subscribe("semmap://watch/on/table1")
        subscriptions.subscribe("semmap://watch/query/SELECT%20%3Fe%20%7B%20%3Fe%20a%20dm%3AC1%20%7D")
    finally:
        subscriptions.close()
    subscriptions.subscribe("semmap://watch/on/table1")
    subscriptions.unsubscribe("semmap://watch/on/table1")
    subscriptions.unsubscribe("semmap://watch/on/table1")


def test_over_stdio_the_schema_is_there(flat):
    async def session():
        async with by_stdio(flat.endpoint) as agent:
            assert len((await agent.client.list_resource_templates()).resource_templates) == 5
            return await read(agent, resources.SCHEMA)

    assert "dm:isLocatedIn" in run(session())["measured"]
