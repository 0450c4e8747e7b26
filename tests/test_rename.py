"""`semmap rename` in a running system: the references, the body, the history and undo."""

import asyncio

from semmap import aio
from semmap.nodes import bus
from semmap.schemas import keys
from semmap.schemas.scenes import Scene, SceneQuery
from tests.conftest import until


def bodies(client):
    """Return the names of the bodies in the scene."""
    return {body.name for body in bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene).bodies}


def test_references_body_and_history_follow_a_renamed_entity(flat_scene):
    with flat_scene.client() as client:
        plate = client.get("plate1").pose
        client.set("plate1", "isOn", "table1")
        assert flat_scene.cli("rename", "table1", "big_table", "--dry-run").startswith(
            "dry run, nothing changed; it would be: renamed table1 to big_table"
        )
        assert flat_scene.cli("rename", "table1", "big_table").startswith(
            "renamed table1 to big_table (commit"
        )
        assert client.get("plate1").properties["isOn"] == ("big_table",)
        until(lambda: "big_table" in (names := bodies(client)) and "table1" not in names, "the new body")
        until(lambda: client.status().in_agreement, "map and scene agree")
        assert client.get("plate1").pose == plate  # it did not fall while the table was replaced
        assert "begun from flat.ttl" in flat_scene.cli("history", "big_table")

        assert client.undo().text.startswith("undid commit")
        assert client.get("plate1").properties["isOn"] == ("table1",)
        until(lambda: "table1" in (names := bodies(client)) and "big_table" not in names, "the old body")


def test_a_rename_that_is_rejected_names_the_next_step(flat_scene):
    assert flat_scene.cli("rename", "cup1", "oven1", status=1) == (
        "semmap: the name 'oven1' is taken; see: semmap get oven1\n"
    )
    assert "new must be a valid name" in flat_scene.cli("rename", "cup1", "1 cup", status=2)
    with flat_scene.client() as client:
        client.track("cup1")
        assert flat_scene.cli("rename", "cup1", "mug1", status=1) == (
            "semmap: cup1 is tracked; to rename it, first: semmap track cup1 --off\n"
        )
        client.track("cup1", off=True)
        client.attach("apple1", to="bowl1")
        assert flat_scene.cli("rename", "apple1", "apple9", status=1) == (
            "semmap: apple1 is attached to bowl1; to rename it, first: semmap detach apple1\n"
        )
        client.detach("apple1")


def test_without_a_simulator_and_on_an_event_loop(flat_map):
    async def session():
        async with aio.connect(flat_map.endpoint) as client:
            reply = await client.rename("milk1", "oat_milk")
            return reply.names, [entity.name for entity in await client.list("Milk")]

    assert asyncio.run(session()) == (("oat_milk",), ["oat_milk"])


def test_two_systems_on_one_machine_do_not_meet(flat_map, flat_scene):
    with flat_map.client() as client, flat_scene.client() as other:
        client.add("Table", "table_of_the_other")
        assert "table_of_the_other" in {entity.name for entity in client.list()}
        assert "table_of_the_other" not in {entity.name for entity in other.list()}
    assert "table_of_the_other" not in flat_scene.cli("list")
