"""Test a robot program in a separate system: pytest examples/test_tidy_up.py."""

import pytest

import semmap
from semmap.testing import own_system


def tidy_up(client: semmap.Client) -> list[str]:
    """Put every cup onto the counter, side by side, and return the names of the moved cups."""
    counter = client.get("counter1")
    x, y, z = counter.pose.position_m
    moved = []
    for cup in client.list("Cup"):
        if "counter1" not in {r.object for r in client.relations(cup.name) if r.relation == "isOn"}:
            at = (x - 0.2 + 0.15 * len(moved), y, z + counter.size_m[2])
            client.update(cup.name, at=at, reason="tidy up")
            moved.append(cup.name)
    return moved


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    with own_system(tmp_path_factory.mktemp("map"), "--abox", "none", "--no-sim", "--no-record") as client:
        client.add("Counter", "counter1", at=(1.0, 0.0, 0.0), size=(0.6, 1.6, 0.9))
        client.add("Cup", "cup1", at=(3.0, 3.0, 0.0))
        client.add("Cup", "cup2", at=(1.0, 0.5, 0.9))
        yield client


def test_cups_are_put_on_the_counter(client):
    assert tidy_up(client) == ["cup1"]
    assert {cup.name for cup in client.list("Cup", on="counter1")} == {"cup1", "cup2"}
    assert client.history("cup1")[-1].reason == "tidy up"


def test_the_changes_of_the_robot_can_be_undone(client):
    client.undo()
    assert client.get("cup1").pose.position_m == (3.0, 3.0, 0.0)


def test_an_unknown_class_is_rejected(client):
    with pytest.raises(semmap.UnknownClass, match="did you mean"):
        client.add("Cupp", at=(0.0, 0.0, 0.0))
