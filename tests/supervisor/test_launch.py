"""The configuration of a node by the settings of `semmap up`."""

import pytest

from semmap.nodes.supervisor.launch import robot_config
from semmap.nodes.supervisor.settings import Settings
from semmap.ontology import EMPTY_WORLD, FLAT_START_M, FLAT_WORLD


@pytest.mark.parametrize(
    ("world", "given", "starts"),
    [
        pytest.param(FLAT_WORLD, None, FLAT_START_M, id="in the flat, where the origin is in a wall"),
        pytest.param(FLAT_WORLD, (1.0, 2.0, 0.0), (1.0, 2.0, 0.0), id="where the user says"),
        pytest.param(EMPTY_WORLD, None, (0.0, 0.0, 0.0), id="at the origin of another world"),
    ],
)
def test_a_robot_starts_in_a_free_place(world, given, starts):
    settings = Settings(data="/d", tbox="/t", abox=None, world=str(world), robot="/r.xml", robot_at=given)
    assert robot_config(settings).at_m == starts
