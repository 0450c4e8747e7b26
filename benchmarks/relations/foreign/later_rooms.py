"""Worlds of rooms to live in, drawn after the first figures."""

from __future__ import annotations

from benchmarks.relations.foreign.common import BOOK, BOTTLE, BOWL, CAN, MUG, PLATE
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
    hull,
    legs,
    own,
    prism,
    sum_of,
    table,
    tube,
    turning,
    vessel,
)


def corner_sofa() -> ForeignWorld:
    """An L-shaped sofa with cushions, a coffee table with a lower shelf, a floor lamp that bends over."""
    sofa = (
        box((2.2, 0.9, 0.4))
        + box((2.2, 0.2, 0.45), (0, 0.35, 0.4))
        + box((0.9, 0.8, 0.4), (-0.65, -0.85, 0))
        + box((0.2, 0.9, 0.2), (1.0, 0, 0.4))
    )
    lamp = (
        tube(0.15, 0.03)
        + bar(0.015, (0, 0, 0.03), (0, 0, 1.6))
        + bar(0.015, (0, 0, 1.6), (0, -0.6, 1.7))
        + tube(0.15, 0.15, (0, -0.6, 1.53))
    )
    coffee = table(0.9, 0.5, 0.42) + box((0.86, 0.46, 0.015), (0, 0, 0.15))
    return ForeignWorld(
        "corner_sofa",
        (
            fixed("sofa_L", (0, 0, 0), sofa),
            free("throw_pillow", (0.3, 0.1, 0.4), box((0.4, 0.15, 0.4))),
            free("cat_toy", (-0.6, -0.9, 0.4), ball(0.04)),
            free("newspaper", (0.6, -0.1, 0.4), box((0.3, 0.4, 0.01))),
            free("reading_glasses", (0.6, -0.1, 0.411), box((0.14, 0.05, 0.03))),
            free("coffee_table_low", (0.5, -1.0, 0), coffee),
            free("tv_remote", (0.5, -1.0, 0.42), box((0.05, 0.17, 0.02))),
            free("photo_album", (0.4, -1.0, 0.166), BOOK),
            free("board_game", (0.65, -1.0, 0.166), box((0.25, 0.25, 0.06))),
            free("dice", (0.65, -1.0, 0.227), box((0.02, 0.02, 0.02))),
            fixed("arc_lamp", (0.9, 0.65, 0), lamp),
            free("rug_corner", (0.5, -1.9, 0), box((0.9, 0.6, 0.01))),
            free("toy_train", (0.5, -1.9, 0.011), box((0.3, 0.08, 0.1))),
            free("tissue_box", (1.0, -0.2, 0.6), box((0.12, 0.22, 0.08))),
        ),
    )


def bathroom() -> ForeignWorld:
    """A bathtub, a toilet, a vanity with a vessel sink, a stool and a laundry basket."""
    tub = crate((1.6, 0.75, 0.55), wall=0.07, floor=0.12)
    bowl = vessel(0.19, 0.36, 0.02, foot=0.13, staves=16)
    toilet = bowl + box((0.38, 0.18, 0.75), (0, 0.29, 0))
    vanity = case((0.9, 0.5, 0.75), wall=0.02)
    basin = vessel(0.2, 0.14, 0.012, foot=0.15, staves=20)
    basket = vessel(0.2, 0.5, 0.006, staves=20)
    return ForeignWorld(
        "bathroom",
        (
            fixed("bathtub_main", (0, 0, 0), tub),
            fixed("toilet_wc", (1.4, 0, 0), toilet),
            fixed(
                "vanity_unit",
                (2.4, 0, 0),
                vanity,
                turning(
                    "vanity_unit_door",
                    (0, -0.262, 0),
                    box((0.88, 0.018, 0.73), (0, 0, 0.01)),
                    "vanity_hinge",
                    "0 0 1",
                    100,
                    ".44 0 0",
                ),
            ),
            fixed("vessel_sink", (2.4, 0, 0.75), basin),
            free("rubber_duck", (0.1, 0, 0.12), ball(0.04) + ball(0.025, (0.02, 0, 0.07))),
            free("shampoo_a", (-0.765, 0.0, 0.55), tube(0.025, 0.18)),
            free("bath_caddy", (0.35, 0, 0.55), box((0.15, 0.78, 0.02))),
            free("soap_bar", (0.35, 0.1, 0.571), box((0.08, 0.05, 0.03))),
            free("toilet_roll", (1.4, 0.3, 0.75), tube(0.055, 0.1)),
            free("toothbrush_cup", (2.75, 0.1, 0.75), vessel(0.035, 0.1, 0.004)),
            free("toothbrush", (2.75, 0.1, 0.755), tube(0.006, 0.18)),
            free("razor", (2.4, 0, 0.765), box((0.04, 0.12, 0.02))),
            free("cleaner_bottle", (2.3, 0, 0.021), BOTTLE),
            free("towel_stack", (2.6, 0.05, 0.021), box((0.3, 0.2, 0.2))),
            free("laundry_hamper", (3.3, 0, 0), basket),
            free("dirty_shirt", (3.3, 0, 0.008), box((0.2, 0.2, 0.12))),
            free("bath_stool", (0, -0.8, 0), table(0.35, 0.3, 0.4)),
            free("folded_towel", (0, -0.8, 0.4), box((0.3, 0.25, 0.08))),
            free("bath_mat", (1.0, -0.9, 0), box((0.7, 0.5, 0.015))),
        ),
        stated=(("vessel_sink", "isOn", "vanity_unit"),),
        open={"vanity_hinge": 0.9},
    )


def nursery() -> ForeignWorld:
    """A cot with bars, a changing table with open boxes, a mobile above, a toy chest with its lid open."""
    bars = sum_of(
        bar(0.012, (0.08 * x, y, 0.3), (0.08 * x, y, 0.9)) for x in range(-7, 8) for y in (-0.34, 0.34)
    ) + sum_of(
        bar(0.012, (x, 0.08 * y, 0.3), (x, 0.08 * y, 0.9)) for x in (-0.64, 0.64) for y in range(-3, 4)
    )
    cot = (
        box((1.3, 0.7, 0.03), (0, 0, 0.3))
        + bars
        + legs(1.3, 0.7, 0.3)
        + sum_of(box((1.3, 0.03, 0.04), (0, y, 0.9)) for y in (-0.34, 0.34))
        + Part("", (((1.24, 0.64, 0.6), (0, 0, 0.33), False),))
    )
    mobile = (
        tube(0.01, 0.5, (0, 0, 0.3))
        + bar(0.01, (-0.25, 0, 0.3), (0.25, 0, 0.3))
        + bar(0.01, (0, -0.25, 0.3), (0, 0.25, 0.3))
    )
    changing = legs(0.8, 0.6, 0.85) + sum_of(box((0.8, 0.6, 0.02), (0, 0, z)) for z in (0.3, 0.85))
    return ForeignWorld(
        "nursery",
        (
            fixed("crib_01", (0, 0, 0), cot),
            free("crib_mattress", (0, 0, 0.331), box((1.2, 0.6, 0.1))),
            free("teddy", (0.3, 0, 0.432), box((0.15, 0.12, 0.25))),
            free("baby_blanket", (-0.3, 0, 0.432), box((0.4, 0.4, 0.05))),
            free("pacifier", (-0.3, 0, 0.483), ball(0.02)),
            fixed("ceiling_mobile", (0, 0, 1.5), mobile),
            fixed("changing_table", (1.6, 0, 0), changing),
            free("diaper_box", (1.4, 0, 0.32), crate((0.3, 0.4, 0.18), wall=0.008)),
            free("diaper", (1.4, 0, 0.33), box((0.15, 0.2, 0.05))),
            free("wipes", (1.8, 0, 0.32), box((0.2, 0.12, 0.08))),
            free("changing_pad", (1.6, 0, 0.87), box((0.7, 0.5, 0.05))),
            free("baby_powder", (1.8, 0.1, 0.921), tube(0.03, 0.14)),
            free(
                "toy_chest",
                (0, -1.2, 0),
                crate((0.8, 0.4, 0.4), wall=0.015),
                Body("toy_chest_lid", (0, 0.2, 0.4), box((0.8, 0.015, 0.38), (0, 0.01, 0))),
            ),
            free("drum", (-0.2, -1.2, 0.016), tube(0.12, 0.15)),
            free("block_tower", (0.2, -1.2, 0.016), box((0.08, 0.08, 0.3))),
            free("xylophone", (-0.2, -1.2, 0.167), box((0.3, 0.12, 0.04))),
            free("ball_under_cot", (0.3, 0.1, 0), ball(0.09)),
        ),
    )


def hospital() -> ForeignWorld:
    """A bed with an overbed table whose arm reaches over it, an IV pole, a rollable cabinet."""
    bed = (
        legs(0.9, 2.0, 0.4, 0.06)
        + box((0.9, 2.0, 0.15), (0, 0, 0.4))
        + sum_of(box((0.9, 0.04, 0.5), (0, y, 0.4)) for y in (-1.0, 1.0))
        + box((0.04, 0.8, 0.3), (0.45, 0.2, 0.45))
    )
    overbed = (
        box((0.6, 0.4, 0.02), (-0.55, 0, 0.85))
        + box((0.05, 0.05, 0.8), (-0.2, 0, 0.05))
        + box((0.5, 0.4, 0.05), (-0.35, 0, 0))
    )
    pole = tube(0.2, 0.04) + tube(0.012, 1.7, (0, 0, 0.04)) + bar(0.008, (-0.15, 0, 1.7), (0.15, 0, 1.7))
    trolley = case((0.4, 0.4, 0.7), wall=0.02, closed=False) + box((0.36, 0.38, 0.015), (0, 0, 0.35))
    return ForeignWorld(
        "hospital",
        (
            fixed("patient_bed", (0, 0, 0), bed),
            free("bed_pillow", (0, 0.7, 0.55), box((0.5, 0.35, 0.12))),
            free("duvet", (0, -0.3, 0.55), box((0.8, 1.0, 0.06))),
            fixed("overbed_table", (0.75, -0.2, 0), overbed),
            free(
                "lunch_tray",
                (0.2, -0.2, 0.87),
                box((0.4, 0.3, 0.01)) + sum_of(box((0.4, 0.01, 0.02), (0, y, 0.01)) for y in (-0.145, 0.145)),
            ),
            free("soup_cup", (0.1, -0.2, 0.881), MUG),
            free("pill_cup", (0.3, -0.2, 0.881), vessel(0.02, 0.03, 0.002)),
            free("pill", (0.3, -0.2, 0.884), ball(0.006)),
            fixed("iv_pole", (-0.8, 0.7, 0), pole),
            free("rollcart", (-0.9, -0.5, 0), trolley),
            free("bandage", (-0.9, -0.5, 0.366), tube(0.04, 0.06)),
            free("gloves", (-0.9, -0.5, 0.021), box((0.2, 0.1, 0.08))),
            free("kidney_dish", (-0.9, -0.5, 0.7), vessel(0.09, 0.04, 0.004)),
            free("slippers", (0.1, 0.3, 0), box((0.2, 0.28, 0.08))),
            free("chart_board", (0.0, -0.4, 0.611), BOOK),
        ),
    )


def music_room() -> ForeignWorld:
    """A piano with a stool, a stand with sheets, stacked chairs and a round side table with a plant."""
    piano = (
        box((1.5, 0.25, 1.2), (0, 0.2, 0))
        + box((1.5, 0.4, 0.15), (0, -0.1, 0.6))
        + sum_of(box((0.06, 0.06, 0.6), (x, -0.25, 0)) for x in (-0.7, 0.7))
    )
    chair = (
        legs(0.4, 0.4, 0.43)
        + box((0.42, 0.42, 0.02), (0, 0, 0.43))
        + sum_of(box((0.03, 0.03, 0.4), (x, 0.195, 0.45)) for x in (-0.18, 0.18))
        + box((0.4, 0.03, 0.1), (0, 0.195, 0.85))
    )
    six = [(0.3, 0), (0.15, 0.26), (-0.15, 0.26), (-0.3, 0), (-0.15, -0.26), (0.15, -0.26)]
    side = (
        hull("hexagon", [(x, y, z) for x, y in six for z in (0.52, 0.55)])
        + tube(0.04, 0.5, (0, 0, 0.02))
        + tube(0.2, 0.02)
    )
    plant = vessel(0.1, 0.16, 0.008, foot=0.075)
    return ForeignWorld(
        "music_room",
        (
            fixed("upright_piano", (0, 0, 0), piano),
            free(
                "piano_stool",
                (0, -0.55, 0),
                tube(0.2, 0.05, (0, 0, 0.45)) + tube(0.03, 0.43, (0, 0, 0.02)) + tube(0.2, 0.02),
            ),
            free(
                "metronome",
                (0.4, 0.2, 1.2),
                prism("pyramid", [(0.05, 0.05), (-0.05, 0.05), (-0.05, -0.05), (0.05, -0.05)], 0.2, 0.4),
            ),
            free("bust", (-0.4, 0.2, 1.2), tube(0.06, 0.1) + ball(0.07, (0, 0, 0.1))),
            free("guitar_pick", (0.2, -0.15, 0.75), box((0.03, 0.03, 0.004))),
            free("violin_case", (0.3, -0.1, 0), box((0.7, 0.2, 0.12))),
            free("stack_chair_1", (-1.6, 0, 0), chair),
            free("songbook", (-1.6, 0, 0.45), BOOK),
            own(fixed("end_table", (1.6, 0, 0), side)),
            free("plant_pot", (1.6, 0, 0.55), plant),
            free("fern", (1.6, 0, 0.56), tube(0.03, 0.15) + ball(0.09, (0, 0, 0.13))),
            free("coaster", (1.42, 0.0, 0.55), tube(0.045, 0.006)),
            free("wine_glass_a", (1.42, 0.0, 0.557), CAN),
            free("drum_pad", (1.5, -0.05, 0.02), tube(0.1, 0.04)),
            free("snack_plate", (-1.6, 0.9, 0), PLATE),
            free("snack_bowl", (-1.6, 0.9, 0.0125), BOWL),
        ),
    )


WORLDS = (corner_sofa, bathroom, nursery, hospital, music_room)
