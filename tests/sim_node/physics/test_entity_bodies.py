"""Which bodies of a world file are entities."""

import mujoco
import pytest

from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.physics.entity_bodies import find_entities
from tests.household import household_classes

GEOM = '<geom type="box" size="0.1 0.1 0.1"/>'
TWO = f'<body name="{{}}">{GEOM}</body><body name="{{}}">{GEOM}</body>'
CHAIRS = f'<body name="chair_1">{GEOM}</body><body name="chair_2" pos="1 0 0">{GEOM}</body>'


@pytest.mark.parametrize(
    ("body", "names"),
    [
        (f'<body name="chair">{CHAIRS}</body>', {"chair_1", "chair_2"}),
        (f'<body name="chairs">{CHAIRS}</body>', {"chair_1", "chair_2"}),
        (f'<body name="furniture">{CHAIRS}</body>', {"chair_1", "chair_2"}),
        (f'<body name="kitchen">{CHAIRS}</body>', {"kitchen", "chair_1", "chair_2"}),
        (f'<body name="cup">{TWO.format("cup_red", "cup_blue")}</body>', {"cup_red", "cup_blue"}),
        (f'<body name="cup">{TWO.format("cupRed", "cup_blue_1")}</body>', {"cupRed", "cup_blue_1"}),
        (f'<body name="cup">{TWO.format("cup_a", "cup_b")}</body>', {"cup_a", "cup_b"}),
        (f'<body name="cup">{TWO.format("red_cup", "blue_cup")}</body>', {"red_cup", "blue_cup"}),
        (f'<body name="cups">{TWO.format("cup_small", "cup_big")}</body>', {"cup_small", "cup_big"}),
        (f'<body name="cabinet">{TWO.format("cabinet_left", "cabinet_right")}</body>', {"cabinet"}),
        (f'<body name="table">{TWO.format("table_wood", "table_metal")}</body>', {"table"}),
        (f'<body name="cup">{TWO.format("cup_red", "cup_lid")}</body>', {"cup"}),
        (f'<body name="cup">{TWO.format("cup_1", "cup_2")}{TWO.format("cup_base", "x")}</body>', {"cup"}),
        (f'<body name="cup">{GEOM}{TWO.format("cup_red", "cup_blue")}</body>', {"cup"}),
        (f'<body name="chair"><freejoint/>{CHAIRS}</body>', {"chair"}),
        (f'<body name="chair">{GEOM}{CHAIRS}</body>', {"chair"}),
        (f'<body name="mug_1"><body name="mug_1_main">{GEOM}</body></body>', {"mug_1"}),
        (
            f'<body name="cup"><body name="cup_base">{GEOM}</body><body name="cup_lid">{GEOM}</body></body>',
            {"cup"},
        ),
    ],
)
def test_a_body_without_geoms_around_bodies_of_its_class_is_only_a_group(body, names):
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    _, found = find_entities(model, BodyClasses(household_classes()), {})
    assert {model.body(number).name for number in found} == names
