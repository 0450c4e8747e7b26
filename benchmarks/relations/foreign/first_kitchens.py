"""Worlds of kitchens, drawn before the code was read. They stay as they are.

Their dimensions and names are like those of published worlds.
"""

from __future__ import annotations

from benchmarks.relations.foreign.common import BOTTLE, BOWL, MUG, PLATE
from benchmarks.relations.foreign.drawing import (
    Body,
    ForeignWorld,
    Part,
    ball,
    bar,
    box,
    case,
    crate,
    fixed,
    free,
    own,
    prism,
    sum_of,
    tube,
    turning,
    vessel,
)


def robocasa_sink_row() -> ForeignWorld:
    """A counter with a sunk basin, and a wall cabinet with two doors above."""
    top = sum_of(
        (
            box((0.3, 0.6, 0.04), (-0.45, 0, 0.86)),
            box((0.6, 0.6, 0.04), (0.6, 0, 0.86)),
            box((0.6, 0.1, 0.04), (0, 0.25, 0.86)),
            box((0.6, 0.1, 0.04), (0, -0.25, 0.86)),
            box((1.5, 0.02, 0.86), (0.15, 0.28, 0)),
            box((0.02, 0.58, 0.86), (-0.59, 0, 0)),
            box((0.02, 0.58, 0.86), (0.89, 0, 0)),
        )
    )
    sink = crate((0.58, 0.38, 0.2), (0, 0, -0.2), 0.012)
    tap = bar(0.012, (0, 0.24, 0), (0, 0.24, 0.25)) + bar(0.012, (0, 0.24, 0.25), (0, 0.08, 0.25))
    door = box((0.395, 0.018, 0.68))
    return ForeignWorld(
        "robocasa_sink_row",
        (
            fixed("counter_main_main_group_base", (0, 0, 0), top),
            fixed("sink_main_group_main", (0, 0, 0.9), sink + tap),
            fixed(
                "cab_main_main_group_main",
                (0.5, 0.12, 1.4),
                case((0.8, 0.36, 0.7)),
                turning(
                    "cab_main_hingeleftdoor",
                    (-0.2, -0.195, 0.01),
                    door,
                    "cab_main_left",
                    "0 0 -1",
                    100,
                    "-.197 0 0",
                ),
                turning(
                    "cab_main_hingerightdoor",
                    (0.2, -0.195, 0.01),
                    door,
                    "cab_main_right",
                    "0 0 1",
                    100,
                    ".197 0 0",
                ),
            ),
            free("obj_main", (0.05, 0.0, 0.713), MUG),
            free("distr_sink_main", (-0.15, 0.05, 0.713), BOWL),
            free("sponge_counter", (-0.45, -0.1, 0.9), box((0.1, 0.06, 0.03))),
            free("plate_stack_1", (0.35, 0.1, 1.421), PLATE),
            free("plate_stack_2", (0.35, 0.1, 1.434), PLATE),
            free("cup_main", (0.7, 0.1, 1.421), MUG),
            free("distr_counter_main", (0.55, 0.0, 0.9), BOTTLE),
            free("paper_towel_left_group", (0.75, 0.1, 0.9), tube(0.06, 0.25)),
            free("cereal_1", (0.5, 0.15, 2.1), box((0.2, 0.07, 0.3))),
        ),
        stated=(("sink_main_group_main", "isInside", "counter_main_main_group_base"),),
        open={"cab_main_left": 1.2},
    )


def robocasa_stove() -> ForeignWorld:
    """A range with an oven and a hood above it."""
    shell = (
        case((0.76, 0.6, 0.6), (0, 0, 0.1), 0.03)
        + box((0.76, 0.64, 0.03), (0, 0, 0.87))
        + box((0.76, 0.6, 0.17), (0, 0, 0.7))
        + box((0.74, 0.6, 0.1))
    )
    grates = sum_of(box((0.2, 0.2, 0.015), (x, y, 0.9)) for x in (-0.2, 0.2) for y in (-0.14, 0.14))
    pan = vessel(0.12, 0.05, 0.006) + bar(0.01, (0.13, 0, 0.04), (0.3, 0, 0.05))
    pot = vessel(0.1, 0.14, 0.006)
    kettle = prism(
        "kettle_hull",
        [(0.09, 0.0), (0.045, 0.078), (-0.045, 0.078), (-0.09, 0.0), (-0.045, -0.078), (0.045, -0.078)],
        0.16,
        0.5,
    )
    return ForeignWorld(
        "robocasa_stove",
        (
            fixed(
                "stove_main_group_main",
                (0, 0, 0),
                shell + grates,
                Body(
                    "stove_main_group_rack",
                    (0, -0.01, 0.35),
                    sum_of(
                        bar(0.005, (x, -0.25, 0), (x, 0.25, 0)) for x in (-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3)
                    )
                    + bar(0.006, (-0.34, -0.2, 0), (0.34, -0.2, 0))
                    + bar(0.006, (-0.34, 0.2, 0), (0.34, 0.2, 0)),
                ),
                turning(
                    "stove_main_door",
                    (0, -0.315, 0.1),
                    box((0.74, 0.02, 0.59)),
                    "stove_door_joint",
                    "1 0 0",
                    90,
                ),
            ),
            fixed(
                "hood_main_group",
                (0, 0.1, 1.65),
                prism("hood_hull", [(-0.38, -0.25), (0.38, -0.25), (0.38, 0.2), (-0.38, 0.2)], 0.3, 0.45)
                + box((0.25, 0.2, 0.5), (0, 0, 0.3)),
            ),
            free("pan_0", (-0.2, -0.14, 0.915), pan, yaw=200),
            free("egg_0", (-0.2, -0.14, 0.925), ball(0.022)),
            free("kettle_electric_0", (0.2, 0.14, 0.915), kettle),
            free("pot_0", (0.2, -0.14, 0.915), pot),
            free("potato_0", (0.2, -0.14, 0.93), ball(0.035)),
            free("casserole_main", (0.0, 0, 0.36), vessel(0.13, 0.1, 0.008)),
            free("baking_sheet_main", (0.0, 0, 0.14), box((0.4, 0.35, 0.012))),
            free("floor_mat", (0, -0.8, 0), box((0.8, 0.4, 0.01))),
        ),
    )


def nested_kitchen() -> ForeignWorld:
    """One tree of bodies with a group as its root, as exporters of scenes write."""
    niche = case((0.6, 0.5, 0.8), wall=0.02) + box((0.56, 0.45, 0.02), (0, 0, 0.4))
    return ForeignWorld(
        "nested_kitchen",
        (
            own(
                fixed(
                    "scene/island",
                    (0, 0, 0),
                    box((1.4, 0.4, 0.88)) + box((1.8, 1.1, 0.03), (0, 0, 0.88)),
                    own(
                        fixed(
                            "scene/island/microwave",
                            (0.5, 0.1, 0.91),
                            case((0.5, 0.35, 0.3), wall=0.02),
                            turning(
                                "scene/island/microwave/door",
                                (0, -0.185, 0),
                                box((0.5, 0.016, 0.3)),
                                "mw_door",
                                "0 0 -1",
                                110,
                                "-.25 0 0",
                            ),
                        )
                    ),
                )
            ),
            own(
                fixed(
                    "scene/base_cabinet",
                    (2.0, 0, 0),
                    niche,
                    turning(
                        "scene/base_cabinet/door",
                        (0, -0.262, 0),
                        box((0.6, 0.018, 0.8)),
                        "bc_door",
                        "0 0 1",
                        110,
                        ".3 0 0",
                    ),
                )
            ),
            free("scene/objects/mug.002", (0.5, 0.1, 0.931), MUG),
            free(
                "scene/objects/stool.001",
                (-0.4, -0.42, 0),
                box((0.02, 0.02, 0.6), (0, 0, 0)) + tube(0.18, 0.04, (0, 0, 0.6)) + tube(0.2, 0.03),
            ),
            free(
                "scene/objects/stool.002",
                (-0.85, -0.75, 0),
                box((0.02, 0.02, 0.6), (0, 0, 0)) + tube(0.18, 0.04, (0, 0, 0.6)) + tube(0.2, 0.03),
            ),
            free("scene/objects/saucepan", (1.95, 0, 0.421), vessel(0.1, 0.12, 0.005)),
            free(
                "scene/objects/lid", (1.95, 0, 0.542), tube(0.105, 0.012) + tube(0.015, 0.03, (0, 0, 0.012))
            ),
            free("scene/objects/flour", (2.05, 0.05, 0.021), box((0.12, 0.08, 0.25))),
            free("scene/objects/chopping_board", (-0.3, 0, 0.91), box((0.4, 0.25, 0.02))),
            free("scene/objects/knife", (-0.3, 0, 0.931), box((0.3, 0.03, 0.01))),
            free("scene/objects/toaster", (2.0, 0.1, 0.8), box((0.3, 0.18, 0.18))),
        ),
        stated=(("scene/island/microwave", "isOn", "scene/island"),),
    )


def pantry_rack() -> ForeignWorld:
    """A rack of wire boards with a crate of bottles."""

    def wires(z: float) -> Part:
        return sum_of(bar(0.004, (x / 25, -0.2, z), (x / 25, 0.2, z)) for x in range(-12, 13)) + sum_of(
            bar(0.005, (-0.5, y, z - 0.009), (0.5, y, z - 0.009)) for y in (-0.2, 0.0, 0.2)
        )

    posts = sum_of(bar(0.012, (x, y, 0.02), (x, y, 1.6)) for x in (-0.5, 0.5) for y in (-0.21, 0.21))
    return ForeignWorld(
        "pantry_rack",
        (
            fixed("wire_rack_4tier", (0, 0, 0), sum_of(map(wires, (0.2, 0.7, 1.2))) + posts),
            free("bottle_crate", (-0.2, 0, 0.205), crate((0.4, 0.3, 0.24), wall=0.012)),
            *(free(f"beer_bottle_{k}", (-0.32 + 0.08 * k, 0.05, 0.218), BOTTLE) for k in range(4)),
            free("jam_jar", (-0.3, 0, 0.705), tube(0.04, 0.1)),
            free("jam_jar_2", (-0.3, 0, 0.806), tube(0.04, 0.1)),
            free("rice_sack", (0.1, 0, 0.705), box((0.3, 0.2, 0.12))),
            free("pasta_box", (0.1, 0, 0.826), box((0.2, 0.1, 0.06))),
            free("onion_net", (0.3, 0, 0.205), ball(0.06)),
            free("cookie_tin", (0, 0, 1.205), tube(0.1, 0.07)),
            free("bucket_red", (0, 0, 0), vessel(0.12, 0.16, 0.006, foot=0.09)),
            free("floor_cloth", (0, 0, 0.01), box((0.1, 0.08, 0.03))),
        ),
    )


WORLDS = (robocasa_sink_row, robocasa_stove, nested_kitchen, pantry_rack)
