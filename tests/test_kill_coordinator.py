"""Kills the coordinator repeatedly while a client adds entities without names."""

from __future__ import annotations

import pytest

from tests.killing import Busy, kill_again_and_again


class Adder(Busy):
    """Adds cups; two cups for one call would mean that a command was executed twice."""

    def __init__(self, system):
        super().__init__(system)
        self.added: list[str] = []
        self.lost = 0

    def step(self, client):
        (name,) = client.add("Cup", at=(1.0, 2.0, 0.0)).names
        self.added.append(name)

    def unanswered(self):
        self.lost += 1


@pytest.mark.parametrize("kills", [3, pytest.param(30, marks=pytest.mark.long)])
def test_a_command_is_executed_once_however_often_the_coordinator_is_killed(empty_map, kills):
    empty_map.begin_anew("none")
    with empty_map.client() as client:
        adder = Adder(empty_map)
        kill_again_and_again(empty_map, "coordinator", adder, kills)
        there = [entity.name for entity in client.list()]
    assert len(adder.added) == len(set(adder.added))
    assert set(adder.added) <= set(there)
    assert len(there) <= len(adder.added) + adder.lost
