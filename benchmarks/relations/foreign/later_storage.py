"""Worlds of things that store things, drawn after the first figures."""

from __future__ import annotations

from benchmarks.relations.foreign.common import BOOK, BOTTLE, BOWL, CAN, CARTON, LEMON, MUG, PLATE
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
    legs,
    ring,
    sliding,
    sum_of,
    table,
    tube,
    turning,
    vessel,
)


def fridge_open() -> ForeignWorld:
    """A fridge with an open door that has shelves of its own, glass boards and a crisper drawer."""
    boards = sum_of(box((0.54, 0.5, 0.008), (0, 0.02, z)) for z in (0.45, 0.8, 1.15))
    rail = (
        box((0.5, 0.09, 0.008), (0, 0.06, 0.5))
        + box((0.5, 0.006, 0.07), (0, 0.102, 0.508))
        + sum_of(box((0.006, 0.08, 0.07), (x, 0.06, 0.508)) for x in (-0.247, 0.247))
    )
    door = box((0.6, 0.03, 1.6)) + rail
    crisper = crate((0.5, 0.46, 0.2), wall=0.006, floor=0.004)
    return ForeignWorld(
        "fridge_open",
        (
            fixed(
                "fridge_main_group",
                (0, 0, 0),
                case((0.6, 0.6, 1.6), wall=0.03) + boards,
                turning("fridge_door", (0, -0.318, 0), door, "fridge_door_joint", "0 0 -1", 110, "-.3 0 0"),
                sliding("fridge_crisper", (0, 0, 0.034), crisper, "fridge_crisper_joint", "0 -1 0", 0.4),
            ),
            free("milk_carton_1", (-0.1, 0.05, 0.459), CARTON),
            free("yogurt_cup_1", (0.1, 0.0, 0.459), tube(0.035, 0.09)),
            free("butter_dish", (0.1, 0.1, 0.809), box((0.16, 0.09, 0.05))),
            free("butter_stick", (0.1, 0.1, 0.86), box((0.1, 0.05, 0.04))),
            free("salad_bowl", (-0.1, 0, 0.809), vessel(0.12, 0.09, 0.006, foot=0.08)),
            free("tomato_1", (-0.1, 0, 0.82), ball(0.035)),
            free("carrot_bag", (0.05, 0, 0.04), box((0.2, 0.1, 0.08))),
            free("cucumber", (-0.12, 0, 0.04), bar(0.025, (0, -0.1, 0.025), (0, 0.1, 0.025))),
            free("juice_bottle", (0, 0.05, 1.16), BOTTLE),
            free("cake_box", (0, 0.05, 1.6), box((0.3, 0.3, 0.12))),
            free("pet_bowl", (-0.6, 0.1, 0), BOWL),
        ),
        open={"fridge_door_joint": 1.5},
    )


def dresser() -> ForeignWorld:
    """A dresser of six thin-floored drawers, two of them open, with a tray on top."""
    shell = sum_of(
        (
            box((0.015, 0.45, 0.8), (-0.6, 0, 0)),
            box((0.015, 0.45, 0.8), (0.6, 0, 0)),
            box((0.015, 0.44, 0.8), (0, 0, 0)),
            box((1.2, 0.008, 0.8), (0, 0.22, 0)),
            box((1.24, 0.47, 0.02), (0, 0, 0.8)),
            box((1.2, 0.44, 0.012)),
        )
    )
    drawer = crate((0.56, 0.4, 0.17), (0, 0.01, 0), wall=0.01, floor=0.003) + box(
        (0.58, 0.018, 0.24), (0, -0.215, -0.01)
    )
    parts = [
        sliding(
            f"dresser_drawer_{row}{side}",
            (x, 0, 0.03 + 0.26 * row),
            drawer,
            f"slide_{row}{side}",
            "0 -1 0",
            0.35,
        )
        for row in range(3)
        for side, x in (("l", -0.3), ("r", 0.3))
    ]
    return ForeignWorld(
        "dresser",
        (
            fixed("Dresser_HEMNES", (0, 0, 0), shell, *parts),
            free("socks", (-0.3, 0, 0.036), ball(0.05)),
            free("tshirt_pile", (0.3, 0, 0.296), box((0.3, 0.25, 0.1))),
            free("belt", (0.3, -0.28, 0.556), box((0.2, 0.05, 0.02))),
            free("scarf", (-0.25, -0.2, 0.556), box((0.25, 0.15, 0.05))),
            free(
                "tray_silver",
                (-0.3, 0, 0.82),
                box((0.36, 0.26, 0.008))
                + sum_of(box((0.36, 0.008, 0.02), (0, y, 0.008)) for y in (-0.126, 0.126)),
            ),
            free("perfume", (-0.35, 0, 0.829), tube(0.02, 0.1)),
            free("ring_box", (-0.2, 0, 0.829), box((0.06, 0.06, 0.04))),
            free(
                "mirror_stand",
                (0.3, 0.1, 0.82),
                box((0.3, 0.15, 0.02)) + box((0.3, 0.02, 0.4), (0, 0.05, 0.02)),
            ),
            free("comb", (0.3, 0.04, 0.841), box((0.15, 0.03, 0.008))),
            free("slipper_box", (0.9, 0, 0), box((0.3, 0.2, 0.1))),
        ),
        open={"slide_2l": 0.3, "slide_2r": 0.3},
    )


def dishwasher() -> ForeignWorld:
    """A dishwasher with its door down and the lower rack pulled out."""

    def rack(height: float) -> Part:
        rods = [bar(0.004, (x / 20, -0.24, 0.004), (x / 20, 0.24, 0.004)) for x in range(-5, 6)]
        cross = [bar(0.004, (-0.25, y, 0.012), (0.25, y, 0.012)) for y in (-0.24, -0.08, 0.08, 0.24)]
        rims = [box((0.5, 0.006, height), (0, y, 0)) for y in (-0.245, 0.245)] + [
            box((0.006, 0.48, height), (x, 0, 0)) for x in (-0.255, 0.255)
        ]
        return sum_of((*rods, *cross, *rims)) + Part(
            "", (((0.5, 0.48, height - 0.014), (0, 0, 0.014), False),)
        )

    door = box((0.58, 0.03, 0.68))
    return ForeignWorld(
        "dishwasher",
        (
            fixed(
                "dishwasher_main",
                (0, 0, 0),
                case((0.6, 0.56, 0.72), (0, 0, 0.1), 0.02) + box((0.6, 0.5, 0.1)),
                turning("dishwasher_door", (0, -0.3, 0.12), door, "dw_door", "1 0 0", 90),
                sliding("dishwasher_rack0", (0, 0, 0.16), rack(0.12), "dw_rack0", "0 -1 0", 0.45),
                sliding("dishwasher_rack1", (0, 0, 0.5), rack(0.1), "dw_rack1", "0 -1 0", 0.45),
            ),
            free("dinner_plate", (0.1, -0.4, 0.177), PLATE),
            free("soup_plate", (-0.12, -0.4, 0.177), BOWL),
            free("pot_small", (0, 0, 0.517), vessel(0.08, 0.09, 0.005)),
            free("tea_glass", (0.17, 0.16, 0.517), box((0.06, 0.06, 0.08))),
            free("detergent", (0.1, 0, 0.82), CARTON),
            free("tea_towel", (-0.15, 0, 0.82), box((0.25, 0.18, 0.02))),
            free("spoon", (-0.15, 0, 0.841), box((0.03, 0.16, 0.01))),
        ),
        open={"dw_door": 1.57, "dw_rack0": 0.4},
    )


def garage() -> ForeignWorld:
    """A workbench with a toolbox, a pegboard, crates below and stacked tyres."""
    toolbox = crate((0.45, 0.22, 0.18), wall=0.006)
    return ForeignWorld(
        "garage",
        (
            fixed(
                "workbench",
                (0, 0, 0),
                table(1.6, 0.7, 0.9, 0.05) + box((1.5, 0.6, 0.02), (0, 0, 0.2)),
                Body("workbench_vise", (-0.65, -0.3, 0.9), box((0.12, 0.1, 0.12))),
            ),
            fixed("pegboard_wall", (0, 0.42, 1.2), box((1.4, 0.02, 0.6))),
            free(
                "toolbox_red",
                (0.3, 0, 0.9),
                toolbox,
                Body("toolbox_red_lid", (0, 0.115, 0.18), box((0.45, 0.008, 0.2), (0, 0.01, 0))),
            ),
            free(
                "hammer_0",
                (0.25, 0, 0.907),
                bar(0.015, (-0.1, 0, 0.015), (0.1, 0, 0.015)) + box((0.03, 0.09, 0.03), (0.1, 0, 0)),
            ),
            free("wrench_0", (0.42, 0, 0.907), box((0.04, 0.16, 0.01))),
            free("drill", (-0.2, 0, 0.9), box((0.06, 0.07, 0.18)) + box((0.2, 0.06, 0.06), (0.03, 0, 0.18))),
            free("screw_jar", (0, 0.2, 0.9), vessel(0.04, 0.09, 0.004)),
            free("bolt", (0, 0.2, 0.905), box((0.012, 0.012, 0.04))),
            free("paint_can_1", (-0.4, 0, 0.22), tube(0.09, 0.2)),
            free("paint_can_2", (-0.4, 0, 0.421), tube(0.08, 0.18)),
            free("paint_brush", (-0.4, 0, 0.602), box((0.05, 0.2, 0.02))),
            free("plastic_crate", (0.3, 0, 0.22), crate((0.5, 0.35, 0.25), wall=0.01)),
            free("rope_coil", (0.3, 0, 0.232), ring(0.13, 0.06, 0.06)),
            free("tyre_1", (1.5, 0, 0), ring(0.33, 0.18, 0.12)),
            free("tyre_2", (1.5, 0, 0.181), ring(0.33, 0.18, 0.12)),
            free("football", (1.5, 0, 0), ball(0.1)),
            free("jack", (0, 0, 0), box((0.4, 0.15, 0.12))),
        ),
    )


def shop_shelf() -> ForeignWorld:
    """A shop's shelf with slanted crates of fruit, a counter with a basket, and a trolley."""
    rack = box((1.2, 0.04, 1.8), (0, 0.3, 0)) + sum_of(
        box((1.2, 0.4, 0.02), (0, 0.08, z)) for z in (0.1, 0.5, 0.9, 1.3)
    )
    wires = sum_of(
        bar(0.004, (0.044 * x, y, 0.3), (0.044 * x, y, 0.7)) for x in range(-5, 6) for y in (-0.3, 0.3)
    ) + sum_of(
        bar(0.004, (x, 0.05 * y, 0.3), (x, 0.05 * y, 0.7)) for x in (-0.22, 0.22) for y in range(-6, 7)
    )
    trolley = (
        wires
        + box((0.46, 0.62, 0.006), (0, 0, 0.29))
        + sum_of(bar(0.015, (x, y, 0.06), (x, y, 0.29)) for x in (-0.2, 0.2) for y in (-0.28, 0.28))
        + sum_of(ball(0.03, (x, y, 0)) for x in (-0.2, 0.2) for y in (-0.28, 0.28))
        + Part("", (((0.43, 0.59, 0.4), (0, 0, 0.3), False),))
    )
    return ForeignWorld(
        "shop_shelf",
        (
            fixed("gondola_A1", (0, 0, 0), rack),
            free("fruit_crate", (-0.3, 0.05, 0.52), crate((0.4, 0.3, 0.12), wall=0.012)),
            *(free(f"orange_{k}", (-0.4 + 0.08 * k, 0.05, 0.535), ball(0.037)) for k in range(3)),
            *(free(f"can_stack_{k}", (0.3, 0.05, 0.92 + 0.101 * k), CAN) for k in range(3)),
            free("cereal_box_a", (0, 0.05, 0.92), box((0.2, 0.07, 0.3))),
            free("cereal_box_b", (0, -0.03, 0.92), box((0.2, 0.07, 0.3))),
            free("water_pack", (0.3, 0.05, 0.12), box((0.3, 0.2, 0.3))),
            free("bread_loaf", (0.25, 0.05, 0.52), box((0.28, 0.12, 0.1))),
            free("shopping_cart", (1.5, 0, 0), trolley),
            free("melon", (1.45, 0, 0.31), box((0.2, 0.2, 0.2))),
            free("magazine", (1.55, 0.15, 0.31), BOOK),
            free("price_scanner", (0.1, 0.05, 1.32), box((0.1, 0.05, 0.04))),
            free("lemon_lost", (0.2, -0.5, 0), LEMON),
            free("mug_display", (-0.3, 0.05, 1.32), MUG),
            free("leg_stand", (-1.4, 0, 0), legs(0.4, 0.4, 0.5) + box((0.4, 0.4, 0.02), (0, 0, 0.5))),
        ),
    )


WORLDS = (fridge_open, dresser, dishwasher, garage, shop_shelf)
