"""Worlds of tables and desks, drawn before the code was read. They stay as they are.

Their dimensions and names are like those of published worlds.
"""

from __future__ import annotations

from benchmarks.relations.foreign.common import BOOK, BOTTLE, BOWL, CAN, CARTON, LEMON, MUG, PLATE
from benchmarks.relations.foreign.drawing import (
    ForeignWorld,
    Part,
    ball,
    bar,
    box,
    crate,
    fixed,
    free,
    hull,
    legs,
    prism,
    sliding,
    sum_of,
    table,
    tube,
    vessel,
)


def libero_living_room() -> ForeignWorld:
    """A low table with a basket for groceries."""
    z = 0.42
    return ForeignWorld(
        "libero_living_room",
        (
            fixed("living_room_table", (0, 0, 0), table(1.0, 0.7, z, 0.04)),
            free("basket_1_main", (0.1, 0.15, z), crate((0.25, 0.2, 0.13), wall=0.008)),
            free("alphabet_soup_1_main", (0.06, 0.15, z + 0.012), CAN),
            free("milk_1_main", (0.16, 0.15, z + 0.012), CARTON),
            free("cream_cheese_1_main", (-0.25, 0.1, z), box((0.1, 0.045, 0.03))),
            free("tomato_sauce_1_main", (-0.3, -0.15, z), CAN),
            free("butter_1_main", (-0.25, 0.1, z + 0.032), box((0.08, 0.04, 0.03))),
            free("orange_juice_1_main", (0.3, -0.15, z), CARTON),
            free("salad_dressing_1_main", (-0.1, -0.2, z), BOTTLE),
            free("moka_pot_1", (0.1, -0.35, 0.0), tube(0.05, 0.17)),
        ),
    )


def libero_kitchen() -> ForeignWorld:
    """A table with a cabinet of three drawers, of which the middle one is open."""
    z, drawers = 0.9, []
    for word, low in (("bottom", 0.012), ("middle", 0.084), ("top", 0.156)):
        drawer = crate((0.23, 0.2, 0.05), wall=0.004, floor=0.003) + box((0.25, 0.012, 0.062), (0, -0.107, 0))
        drawers.append(
            sliding(
                f"wooden_cabinet_1_cabinet_{word}",
                (0, 0, low),
                drawer,
                f"wooden_cabinet_1_{word}_level",
                "0 -1 0",
                0.16,
            )
        )
    shell = sum_of(
        (
            box((0.006, 0.22, 0.23), (-0.127, 0.01, 0)),
            box((0.006, 0.22, 0.23), (0.127, 0.01, 0)),
            box((0.26, 0.006, 0.23), (0, 0.115, 0)),
            box((0.26, 0.225, 0.008), (0, 0.006, 0)),
            box((0.26, 0.225, 0.008), (0, 0.006, 0.222)),
        )
    )
    return ForeignWorld(
        "libero_kitchen",
        (
            fixed("kitchen_table", (0, 0, 0), table(1.2, 0.8, z, 0.05)),
            fixed("wooden_cabinet_1_main", (0.3, 0.25, z), shell, *drawers),
            free("akita_black_bowl_1_main", (0.3, 0.25, z + 0.235), BOWL),
            free("akita_black_bowl_2_main", (-0.05, 0.1, z), BOWL),
            free("plate_1_main", (-0.3, 0.1, z), PLATE),
            free("chocolate_pudding_1_main", (-0.3, 0.1, z + 0.014), box((0.08, 0.06, 0.03))),
            free("wine_bottle_1_main", (-0.1, -0.2, z), BOTTLE),
            free("butter_2_main", (0.3, 0.15, z + 0.09), box((0.07, 0.04, 0.025))),
            free("cookies_1_main", (0.3, 0.26, z + 0.018), box((0.09, 0.06, 0.02))),
            free("lemon_1", (-0.05, 0.1, z + 0.01), LEMON),
        ),
        open={"wooden_cabinet_1_middle_level": 0.14},
        stated=(("wooden_cabinet_1_main", "isOn", "kitchen_table"),),
    )


def libero_study() -> ForeignWorld:
    """A desk with a caddy of compartments."""
    z = 0.75
    caddy = (
        crate((0.09, 0.2, 0.15), (-0.1, 0, 0), 0.005)
        + crate((0.11, 0.2, 0.1), (0.0, 0, 0), 0.005)
        + crate((0.09, 0.2, 0.06), (0.1, 0, 0), 0.005)
    )
    return ForeignWorld(
        "libero_study",
        (
            fixed("study_table", (0, 0, 0), table(1.4, 0.7, z)),
            free("desk_caddy_1", (0.2, 0.1, z), caddy),
            free("black_book_1", (0.1, 0.1, z + 0.01), box((0.03, 0.15, 0.22))),
            free("white_yellow_mug_1", (0.2, 0.1, z + 0.01), MUG, yaw=90),
            free("red_coffee_mug_1", (-0.2, -0.1, z), MUG),
            free("yellow_book_1", (-0.45, 0.1, z), BOOK),
            free("eraser_1", (0.3, 0.08, z + 0.01), box((0.05, 0.02, 0.012))),
            free("porcelain_mug_1", (-0.45, 0.1, z + 0.034), MUG),
            free("pencil_1", (-0.2, -0.1, z + 0.02), tube(0.004, 0.17)),
            free("foot_rest_1", (0, -0.1, 0), box((0.4, 0.25, 0.12))),
        ),
    )


def tea_cart() -> ForeignWorld:
    """A cart of two trays with rims."""

    def tray(z: float) -> Part:
        return (
            box((0.7, 0.4, 0.015), (0, 0, z))
            + sum_of(box((0.01, 0.4, 0.04), (x, 0, z + 0.015)) for x in (-0.345, 0.345))
            + sum_of(box((0.68, 0.01, 0.04), (0, y, z + 0.015)) for y in (-0.195, 0.195))
        )

    wheels = sum_of(ball(0.03, (x, y, 0)) for x in (-0.32, 0.32) for y in (-0.17, 0.17))
    posts = sum_of(bar(0.012, (x, y, 0.05), (x, y, 0.82)) for x in (-0.34, 0.34) for y in (-0.19, 0.19))
    teapot = prism(
        "teapot_hull",
        [(0.08, 0), (0.04, 0.07), (-0.04, 0.07), (-0.08, 0), (-0.04, -0.07), (0.04, -0.07)],
        0.12,
        0.7,
    )
    return ForeignWorld(
        "tea_cart",
        (
            free("serving_cart", (0, 0, 0), wheels + posts + tray(0.25) + tray(0.78)),
            free("teapot_white", (-0.15, 0, 0.796), teapot),
            free("saucer_1", (0.1, 0.05, 0.796), tube(0.07, 0.01)),
            free("teacup_1", (0.1, 0.05, 0.807), vessel(0.04, 0.06, 0.004, foot=0.028)),
            free("sugar_cube", (0.1, 0.05, 0.815), box((0.015, 0.015, 0.015))),
            free(
                "cake_tray",
                (0.0, 0, 0.266),
                box((0.3, 0.2, 0.012))
                + box((0.3, 0.01, 0.02), (0, 0.1, 0))
                + box((0.3, 0.01, 0.02), (0, -0.1, 0)),
            ),
            free("muffin_1", (-0.05, 0, 0.279), tube(0.03, 0.05)),
            free("muffin_2", (0.06, 0.02, 0.279), tube(0.03, 0.05)),
            free("napkin_pile", (-0.25, 0, 0.266), box((0.12, 0.12, 0.03))),
            free("thermos", (0.25, 0, 0.266), tube(0.045, 0.28)),
        ),
    )


def dining_table() -> ForeignWorld:
    """A laid table with chairs pushed in, a bench below and a lamp above."""
    chair = (
        legs(0.4, 0.4, 0.44)
        + box((0.42, 0.42, 0.03), (0, 0, 0.44))
        + box((0.42, 0.03, 0.45), (0, -0.2, 0.47))
    )
    z = 0.75
    board = [
        (0.9, 0.3),
        (0.5, 0.5),
        (-0.5, 0.5),
        (-0.9, 0.3),
        (-0.9, -0.3),
        (-0.5, -0.5),
        (0.5, -0.5),
        (0.9, -0.3),
    ]
    top = hull("board", [(x, y, h) for x, y in board for h in (z - 0.03, z)])
    return ForeignWorld(
        "dining_table",
        (
            fixed(
                "DiningTable_204_1", (0, 0, 0), top + tube(0.06, z - 0.06, (0, 0, 0.03)) + tube(0.35, 0.03)
            ),
            fixed(
                "CeilingLamp_204",
                (0, 0, 1.6),
                prism("lampshade", [(x / 3, y / 3) for x, y in board], 0.2, 0.3),
            ),
            free("Chair_204_1", (0.5, -0.5, 0), chair),
            free("Chair_204_2", (-0.5, 0.5, 0), chair, yaw=180),
            free("Chair_204_3", (1.35, 0, 0), chair, yaw=90),
            free("cushion_1", (0.5, -0.48, 0.47), box((0.36, 0.34, 0.06))),
            free("plate_a", (0.45, -0.25, z), PLATE),
            free("plate_b", (0.45, -0.25, z + 0.0125), PLATE),
            free("soup_bowl", (0.45, -0.25, z + 0.025), BOWL),
            free("fruit_bowl", (0, 0, z), vessel(0.14, 0.08, 0.008, foot=0.08, staves=20)),
            free("apple_1", (0.04, 0, z + 0.03), ball(0.035)),
            free("apple_2", (-0.04, 0, z + 0.03), ball(0.035)),
            free("apple_3", (0.0, 0.012, z + 0.088), ball(0.035)),
            free(
                "wineglass_1",
                (-0.3, 0.1, z),
                tube(0.035, 0.006) + tube(0.006, 0.08, (0, 0, 0.006)) + tube(0.035, 0.08, (0, 0, 0.086)),
            ),
            free("napkin", (-0.5, -0.2, z), box((0.16, 0.16, 0.008))),
            free("fork_1", (-0.5, -0.2, z + 0.009), box((0.02, 0.19, 0.008))),
            free("dog_bowl", (-0.25, -0.2, 0.03), BOWL),
            free("toy_mouse", (0.6, 0.15, 0), ball(0.03)),
        ),
    )


def cluttered_desk() -> ForeignWorld:
    """A desk with a monitor stand, a chair pushed under it and a full bin."""
    seat = (
        legs(0.42, 0.42, 0.43)
        + box((0.45, 0.45, 0.04), (0, 0, 0.43))
        + box((0.45, 0.03, 0.5), (0, -0.22, 0.47))
    )
    z = 0.74
    return ForeignWorld(
        "cluttered_desk",
        (
            fixed("desk_L1", (0, 0, 0), table(1.5, 0.75, z)),
            free("chair.001", (-0.2, -0.3, 0), seat),
            free(
                "riser",
                (0, 0.22, z),
                box((0.6, 0.25, 0.015), (0, 0, 0.1))
                + box((0.02, 0.25, 0.1), (-0.29, 0, 0))
                + box((0.02, 0.25, 0.1), (0.29, 0, 0)),
            ),
            free(
                "monitor_27in",
                (0, 0.22, z + 0.116),
                box((0.25, 0.2, 0.015))
                + box((0.04, 0.03, 0.2), (0, 0.05, 0.015))
                + box((0.6, 0.03, 0.36), (0, 0.02, 0.12)),
            ),
            free("keyboard_mx", (0, -0.15, z), box((0.44, 0.13, 0.025))),
            free("notepad", (0.05, 0.2, z), box((0.15, 0.2, 0.015))),
            free("pen_holder", (0.45, 0.2, z), vessel(0.04, 0.1, 0.004)),
            free("pen_1", (0.455, 0.2, z + 0.006), tube(0.005, 0.14)),
            free("scissors", (0.43, 0.2, z + 0.006), box((0.025, 0.008, 0.17))),
            free("stack_of_paper", (-0.5, 0.15, z), box((0.21, 0.297, 0.06))),
            free("stapler", (-0.5, 0.15, z + 0.061), box((0.04, 0.14, 0.05))),
            free("coffee mug", (-0.45, -0.2, z), MUG),
            free("waste_bin", (0.5, 0.05, 0), vessel(0.14, 0.3, 0.006, foot=0.11)),
            free("crumpled_paper", (0.5, 0.05, 0.01), ball(0.04)),
            free("pc_tower", (-0.55, 0.1, 0), box((0.2, 0.45, 0.42))),
            free("router_box", (-0.55, 0.1, 0.421), box((0.16, 0.12, 0.04))),
        ),
    )


WORLDS = (libero_living_room, libero_kitchen, libero_study, tea_cart, dining_table, cluttered_desk)
