"""Worlds of odd things: tilted, hung, leaning, nested in one another; drawn after the first figures."""

from __future__ import annotations

from benchmarks.relations.foreign.common import BOOK, BOTTLE, BOWL, CAN, LEMON, MUG, PLATE
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
    own,
    prism,
    sliding,
    sum_of,
    table,
    tube,
    turning,
    vessel,
)


def nested_boxes() -> ForeignWorld:
    """Boxes in boxes, turned and partly filled, on a round table."""
    return ForeignWorld(
        "nested_boxes",
        (
            fixed("round_table", (0, 0, 0), tube(0.6, 0.03, (0, 0, 0.7)) + tube(0.05, 0.7) + tube(0.3, 0.02)),
            free("moving_box", (0, 0, 0.73), crate((0.45, 0.35, 0.3), wall=0.006), yaw=30),
            free("gift_box", (0, 0, 0.737), crate((0.2, 0.2, 0.12), wall=0.005), yaw=50),
            free("ring_case", (0.02, 0, 0.743), crate((0.08, 0.08, 0.05), wall=0.004), yaw=10),
            free("marble", (0.02, 0, 0.748), ball(0.01)),
            free("paper_roll", (0.13, 0.08, 0.737), tube(0.02, 0.45)),
            free("flat_box", (-0.4, 0.1, 0.73), box((0.3, 0.2, 0.05)), yaw=20),
            free("card_deck", (-0.4, 0.1, 0.781), box((0.06, 0.09, 0.02)), yaw=60),
            free("big_bin", (1.2, 0, 0), vessel(0.25, 0.6, 0.01)),
            free("small_bin", (1.2, 0, 0.01), vessel(0.15, 0.3, 0.008)),
            free("can_in_bin", (1.2, 0, 0.02), CAN),
            free("dog_bed", (0, 0.1, 0.02), box((0.3, 0.25, 0.1))),
        ),
    )


def laundry() -> ForeignWorld:
    """A washing machine with a round door at its front, a dryer on it, an ironing board and baskets."""
    front = sum_of(box((0.04, 0.02, 0.73), (x, -0.29, 0.06)) for x in (-0.22, 0.22)) + sum_of(
        box((0.4, 0.02, height), (0, -0.29, z)) for z, height in ((0.06, 0.24), (0.7, 0.09))
    )
    machine = case((0.6, 0.6, 0.85), wall=0.06) + front
    door = box((0.4, 0.02, 0.4), (0, 0, 0.2)) + tube(0.1, 0.005, (0, 0, 0.0))
    board = (
        box((0.35, 1.1, 0.03), (0, 0, 0.85))
        + bar(0.015, (-0.1, -0.4, 0.02), (0.1, 0.3, 0.84))
        + bar(0.015, (0.1, -0.4, 0.84), (-0.1, 0.3, 0.02))
        + sum_of(bar(0.015, (-0.25, y, 0.015), (0.25, y, 0.015)) for y in (-0.4, 0.3))
    )
    return ForeignWorld(
        "laundry",
        (
            fixed(
                "washer",
                (0, 0, 0),
                machine,
                turning("washer_door", (0, -0.315, 0.1), door, "washer_hinge", "0 0 -1", 120, "-.2 0 0"),
            ),
            fixed(
                "dryer",
                (0, 0, 0.85),
                machine,
                turning("dryer_door", (0, -0.315, 0.1), door, "dryer_hinge", "0 0 -1", 120, "-.2 0 0"),
            ),
            free("jeans", (0, 0, 0.06), box((0.3, 0.3, 0.12))),
            free("blouse", (0, 0, 0.91), box((0.25, 0.25, 0.06))),
            free("wicker_basket", (0, 0, 1.7), crate((0.5, 0.35, 0.25), wall=0.015)),
            free("peg_bag", (0.1, 0, 1.716), ball(0.06)),
            fixed("ironing_board", (1.2, 0, 0), board),
            free(
                "iron",
                (1.2, -0.3, 0.88),
                prism("iron_hull", [(0.0, 0.12), (0.05, -0.08), (-0.05, -0.08)], 0.1, 0.6),
            ),
            free("shirt_ironed", (1.2, 0.2, 0.88), box((0.3, 0.4, 0.02))),
            free("hanger", (1.2, 0.2, 0.901), box((0.3, 0.03, 0.01))),
            free("water_bucket", (1.2, 0.85, 0), vessel(0.14, 0.25, 0.006, foot=0.11)),
            free("mop", (1.22, 0.85, 0.007), tube(0.013, 1.1)),
            free("sock_ball", (1.05, -0.15, 0), ball(0.04)),
        ),
        stated=(("dryer", "isOn", "washer"),),
        open={"washer_hinge": 1.5},
    )


def stairs() -> ForeignWorld:
    """Open stairs with things on the steps and under them, and a shoe cabinet with a tilting flap."""
    steps = sum_of(box((0.9, 0.28, 0.04), (0, 0.25 * k, 0.2 * k + 0.16)) for k in range(7)) + box(
        (0.04, 1.8, 0.1), (-0.4, 0.75, 0)
    )
    cabinet = case((0.6, 0.25, 0.9), wall=0.015)
    return ForeignWorld(
        "stairs",
        (
            fixed("open_staircase", (0, 0, 0), steps),
            free("flower_pot_s", (0.2, 0.5, 0.6), vessel(0.07, 0.12, 0.006, foot=0.05)),
            free("cactus", (0.2, 0.5, 0.607), tube(0.025, 0.16)),
            free("book_on_step", (-0.1, 1.0, 1.0), box((0.16, 0.2, 0.03))),
            free("cat_bed", (0.15, 1.2, 0), vessel(0.2, 0.12, 0.02)),
            free("cat", (0.15, 1.2, 0.021), box((0.25, 0.12, 0.14))),
            free("vacuum", (-0.1, 1.5, 0), box((0.2, 0.3, 0.25))),
            fixed(
                "shoe_cabinet",
                (1.2, 0, 0),
                cabinet + box((0.57, 0.22, 0.012), (0, 0, 0.45)),
                turning(
                    "shoe_cabinet_flap", (0, -0.137, 0.02), box((0.58, 0.016, 0.42)), "flap_low", "1 0 0", 50
                ),
                turning(
                    "shoe_cabinet_flap_top",
                    (0, -0.137, 0.46),
                    box((0.58, 0.016, 0.42)),
                    "flap_high",
                    "1 0 0",
                    50,
                ),
            ),
            free("pump_left", (1.1, 0, 0.016), box((0.09, 0.2, 0.1))),
            free("pump_right", (1.25, 0, 0.016), box((0.09, 0.2, 0.1))),
            free("boots", (1.2, 0, 0.463), box((0.2, 0.2, 0.3))),
            free("key_tray", (1.2, 0, 0.9), crate((0.2, 0.12, 0.03), wall=0.006)),
            free("house_key", (1.2, 0, 0.907), box((0.06, 0.02, 0.004))),
            free("letter", (1.38, 0, 0.9), box((0.2, 0.1, 0.003))),
        ),
        open={"flap_low": 0.5},
    )


def picnic() -> ForeignWorld:
    """A picnic table with benches that are part of it, a cool box with a lid beside it, a parasol above."""
    picnic_table = (
        box((1.6, 0.8, 0.04), (0, 0, 0.71))
        + sum_of(box((1.6, 0.28, 0.04), (0, y, 0.41)) for y in (-0.7, 0.7))
        + sum_of(
            box((0.06, 1.6, 0.06), (x, 0, 0.35))
            + box((0.06, 0.1, 0.71), (x, 0, 0))
            + box((0.06, 0.06, 0.36), (x, -0.7, 0))
            + box((0.06, 0.06, 0.36), (x, 0.7, 0))
            for x in (-0.6, 0.6)
        )
    )
    eight = [
        (1.2, 0.5),
        (0.5, 1.2),
        (-0.5, 1.2),
        (-1.2, 0.5),
        (-1.2, -0.5),
        (-0.5, -1.2),
        (0.5, -1.2),
        (1.2, -0.5),
    ]
    return ForeignWorld(
        "picnic",
        (
            fixed("picnic_table_bench", (0, 0, 0), picnic_table),
            fixed("parasol", (0, 0.0, 2.0), prism("canopy", eight, 0.4, 0.1)),
            free("cooler_box", (1.4, 0, 0), crate((0.5, 0.35, 0.35), wall=0.03)),
            free("cooler_lid", (1.4, 0.0, 0.351), box((0.5, 0.35, 0.03))),
            free("soda_1", (1.3, 0, 0.031), CAN),
            free("soda_2", (1.45, 0.05, 0.031), CAN),
            free(
                "watermelon_half",
                (0.3, 0.1, 0.75),
                prism(
                    "half_melon",
                    [(0.1, 0), (0.05, 0.087), (-0.05, 0.087), (-0.1, 0), (-0.05, -0.087), (0.05, -0.087)],
                    0.08,
                    0.7,
                ),
            ),
            free("cutlery_cup", (-0.3, 0.1, 0.75), vessel(0.04, 0.11, 0.004)),
            free("fork_a", (-0.295, 0.1, 0.755), box((0.012, 0.01, 0.18))),
            free("paper_plate", (0, -0.2, 0.75), PLATE),
            free("sandwich", (0, -0.2, 0.763), box((0.1, 0.1, 0.04))),
            free("backpack", (0.3, -0.7, 0.45), box((0.3, 0.2, 0.4))),
            free("frisbee", (-0.4, 0.7, 0.45), tube(0.12, 0.025)),
            free("beach_ball", (0.0, 0.25, 0.0), ball(0.15)),
            free("sandal", (0.2, -0.72, 0), box((0.1, 0.25, 0.08))),
            free("wine_cooler", (-0.1, 0.2, 0.75), vessel(0.07, 0.2, 0.006)),
            free("wine", (-0.1, 0.2, 0.757), BOTTLE),
        ),
    )


def lab() -> ForeignWorld:
    """A laboratory: a hood with a sash, a rack of test tubes, a centrifuge, a drawer unit on wheels."""
    hood = case((1.4, 0.8, 1.2), (0, 0, 0.9), 0.03) + legs(1.4, 0.8, 0.9)
    rack = (
        box((0.24, 0.08, 0.01))
        + sum_of(box((0.24, 0.008, 0.05), (0, y, 0.01)) for y in (-0.036, 0.036))
        + sum_of(box((0.006, 0.064, 0.05), (x, 0, 0.01)) for x in (-0.117, -0.07, -0.023, 0.023, 0.07, 0.117))
    )
    cells = tuple(((0.04, 0.064, 0.05), (x, 0, 0.01), False) for x in (-0.093, -0.047, 0, 0.047, 0.093))
    drawer = crate((0.36, 0.42, 0.14), wall=0.008, floor=0.004) + box((0.4, 0.015, 0.17), (0, -0.218, 0))
    unit = (
        box((0.015, 0.46, 0.62), (-0.195, 0, 0.05))
        + box((0.015, 0.46, 0.62), (0.195, 0, 0.05))
        + box((0.4, 0.46, 0.02), (0, 0, 0.66))
        + box((0.37, 0.012, 0.6), (0, 0.224, 0.06))
        + box((0.4, 0.46, 0.02), (0, 0, 0.05))
        + sum_of(ball(0.025, (x, y, 0)) for x in (-0.17, 0.17) for y in (-0.2, 0.2))
    )
    return ForeignWorld(
        "lab",
        (
            fixed(
                "fume_hood",
                (0, 0, 0),
                hood,
                sliding("fume_hood_sash", (0, -0.41, 0.93), box((1.36, 0.012, 1.1)), "sash", "0 0 1", 0.9),
            ),
            free("tube_rack", (0.2, 0.1, 0.931), rack + Part("", cells)),
            free("test_tube_1", (0.2, 0.1, 0.942), tube(0.008, 0.12)),
            free("test_tube_2", (0.293, 0.1, 0.942), tube(0.008, 0.12)),
            free("beaker", (-0.3, 0, 0.931), vessel(0.045, 0.11, 0.003)),
            free("stir_bar", (-0.3, 0, 0.935), bar(0.004, (-0.015, 0, 0.004), (0.015, 0, 0.004))),
            free("hotplate", (-0.55, 0.1, 0.931), box((0.16, 0.22, 0.1))),
            free(
                "flask",
                (-0.55, 0.1, 1.032),
                prism(
                    "erlenmeyer",
                    [
                        (0.05, 0),
                        (0.025, 0.043),
                        (-0.025, 0.043),
                        (-0.05, 0),
                        (-0.025, -0.043),
                        (0.025, -0.043),
                    ],
                    0.12,
                    0.35,
                ),
            ),
            free(
                "drawer_unit",
                (1.4, 0, 0),
                unit,
                *(
                    sliding(
                        f"drawer_unit_tray_{k}",
                        (0, 0, 0.075 + 0.19 * k),
                        drawer,
                        f"unit_slide_{k}",
                        "0 -1 0",
                        0.35,
                    )
                    for k in range(3)
                ),
            ),
            free("pipette_box", (1.4, 0, 0.27), box((0.2, 0.1, 0.05))),
            free("manual", (1.4, 0.05, 0.68), BOOK),
            free("lab_lemon", (1.4, 0.05, 0.711), LEMON),
            own(
                fixed(
                    "stool_lab",
                    (0.3, -0.1, 0),
                    tube(0.17, 0.04, (0, 0, 0.6)) + tube(0.02, 0.58, (0, 0, 0.02)) + tube(0.2, 0.02),
                )
            ),
            fixed(
                "centrifuge_table", (-1.6, 0, 0), table(0.7, 0.5, 0.75) + box((0.6, 0.4, 0.01), (0, 0, 0.3))
            ),
            free(
                "centrifuge",
                (-1.6, 0, 0.75),
                crate((0.3, 0.3, 0.25), wall=0.03),
                Body("centrifuge_lid", (0, 0.15, 0.25), box((0.3, 0.015, 0.28), (0, 0.01, 0))),
            ),
            free("vial", (-1.6, 0, 0.781), tube(0.015, 0.05)),
            free("ice_bowl", (-1.6, 0.1, 0.31), BOWL),
            free("mug_forbidden", (-1.45, -0.1, 0.31), MUG),
        ),
    )


WORLDS = (nested_boxes, laundry, stairs, picnic, lab)
