"""Every tool by the official SDK, over stdio, beside a system with a simulator."""

import asyncio
import json

from tests.extern.mcp.conftest import by_stdio, run

WHY = {"reason": "a test"}
READS = {
    "overview": {},
    "find": {"text": "the cup on the desk"},
    "understand": {"text": "take the cup and bring it to Anna"},
    "list": {"class": "Cup"},
    "get": {"name": "cup1"},
    "relations": {"name": "cup1"},
    "query": {"query": "SELECT ?c { ?c a dm:Cup }"},
    "explain": {"name": "cup1", "predicate": "type", "value": "Dishware"},
    "could": {"name": "cup1", "predicate": "type", "value": "Table"},
    "route": {"from": "bed1", "to": "fridge1"},
    "history": {"limit": 1},
    "diff": {"since": 1},
    "when": {"name": "cup1", "relation": "isOn", "other": "desk1"},
    "last_seen": {"name": "cup1"},
    "picture": {"place": "kitchen1", "width": 64, "height": 64},
}


def test_the_sdk_calls_every_tool(flat_scene):
    async def trail(agent):
        """The trail of a person whose live pose is published."""
        with flat_scene.client() as client:
            client.track("person1")
            while (found := await agent.raw("trail", name="person1")).is_error:
                client.publish_pose("person1", at=(5.0, 2.0, 0.0))
                await asyncio.sleep(0.1)
        return json.loads(found.content[-1].text)

    async def session():
        async with by_stdio(flat_scene.endpoint, "--allow", "change") as agent:
            replies = {tool: await agent(tool, **arguments) for tool, arguments in READS.items()}

            async def commit(**change):
                while True:  # the scene may move something in between
                    token = (await agent("propose", **change, **WHY))["token"]
                    done = await agent.raw("commit", token=token)
                    if not done.is_error:
                        return json.loads(done.content[-1].text)
                    assert "propose it again" in done.content[-1].text

            robot = (await commit(verb="add", class_="Robot", at=[6.0, 4.2, 0.0]))["names"][0]
            while (await agent("get", name=robot)).get("body") == "pending":
                await asyncio.sleep(0.05)
            replies["trail"] = await trail(agent)
            replies["open"] = await agent("open", name="fridge1", **WHY)
            replies["close"] = await agent("close", name="fridge1", **WHY)
            replies["drive"] = await agent.refused("drive", name=robot, to=[[6.2, 4.2]], **WHY)
            attached = await commit(verb="attach", name="cup1", to=robot, at=[0.0, 0.0, 0.6])
            replies["commit"] = await commit(verb="detach", name="cup1")
            replies["undo"] = await agent("undo", commit=replies["commit"]["commit"])
            used = {*replies, "propose"}
            return await agent.tools(), used, replies, attached

    tools, used, replies, attached = run(session())
    assert set(tools) == used
    assert replies["route"]["metres"] > 4
    assert replies["route"]["points"]
    assert replies["could"]["possible"] is False
    assert replies["could"]["steps"]
    assert "open to 100%" in replies["open"]["text"]["said"]
    assert "closed" in replies["close"]["text"]["said"]
    assert "cannot drive: its model has no velocity actuators" in replies["drive"]
    assert attached["done"]
    assert len(json.dumps(replies["overview"])) < 4000


def test_actions_are_within_the_limits(flat_scene):
    async def session():
        words = ("--allow", "change", "--places", "bedroom1", "--classes", "Robot,Cupboard")
        async with by_stdio(flat_scene.endpoint, *words) as agent:
            added = {"verb": "add", "class": "Robot", "at": [4.0, 5.6, 0.0], "name": "r1"}
            await agent("commit", token=(await agent("propose", **added, **WHY))["token"])
            outside = await agent.refused("drive", name="r1", to=[[8.0, 2.0]], **WHY)
            return await agent.refused("open", name="fridge1", **WHY), outside

    fridge, outside = run(session())
    assert fridge.startswith("fridge1 is not of a class that you may change")
    assert "which is not in a place that you may change: bedroom1" in outside
