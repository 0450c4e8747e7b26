"""Worlds of bedrooms and halls, drawn before the code was read. They stay as they are.

Their dimensions and names are like those of published worlds.
"""

from __future__ import annotations

from benchmarks.relations.foreign.common import BOOK, BOWL
from benchmarks.relations.foreign.drawing import (
    Body,
    ForeignWorld,
    ball,
    bar,
    box,
    case,
    crate,
    fixed,
    free,
    legs,
    prism,
    sliding,
    sum_of,
    table,
    tube,
    turning,
    vessel,
)


def thor_bedroom() -> ForeignWorld:
    """A bed with a headboard, a nightstand with a drawer, boxes below."""
    bed = (
        legs(1.6, 2.0, 0.25, 0.08)
        + box((1.6, 2.0, 0.06), (0, 0, 0.25))
        + box((1.56, 1.94, 0.2), (0, 0, 0.31))
        + box((1.6, 0.06, 1.1), (0, 1.02, 0))
    )
    stand = case((0.45, 0.4, 0.2), (0, 0, 0.3), 0.015) + legs(0.45, 0.4, 0.3)
    drawer = crate((0.4, 0.36, 0.14), wall=0.01) + box((0.44, 0.015, 0.19), (0, -0.19, -0.01))
    z = 0.51
    return ForeignWorld(
        "thor_bedroom",
        (
            fixed("Bed|-01.20|+00.00|+02.10", (0, 0, 0), bed),
            fixed(
                "SideTable_3e1d",
                (1.15, 0.75, 0),
                stand,
                sliding("Drawer_3e1d_0", (0, -0.02, 0.32), drawer, "Drawer_3e1d_slide", "0 -1 0", 0.3),
            ),
            free("Pillow|+00.10", (-0.4, 0.7, z), box((0.6, 0.4, 0.12))),
            free("TeddyBear|+00.40", (-0.4, 0.7, z + 0.12), ball(0.07)),
            free(
                "Laptop|+02.00",
                (0.3, -0.2, z),
                box((0.33, 0.24, 0.02)) + box((0.33, 0.01, 0.22), (0, 0.115, 0.02)),
            ),
            free(
                "DeskLamp_1",
                (1.15, 0.8, 0.5),
                tube(0.07, 0.02)
                + tube(0.012, 0.28, (0, 0, 0.02))
                + prism("shade", [(0.1, 0), (0, 0.1), (-0.1, 0), (0, -0.1)], 0.15, 0.6),
            ),
            free("CellPhone_9", (1.1, 0.65, 0.5), box((0.07, 0.14, 0.01))),
            free("Watch_2", (1.15, 0.6, 0.34), box((0.05, 0.05, 0.02))),
            free("Box_ShoeBox_12", (-0.3, -0.5, 0), box((0.35, 0.25, 0.14))),
            free("Slippers_L", (0.6, -0.85, 0), box((0.1, 0.27, 0.06))),
            free("BaseballBat", (0.87, -0.6, 0.035), bar(0.03, (0, -0.3, 0), (0, 0.3, 0))),
        ),
        open={"Drawer_3e1d_slide": 0.2},
    )


def bunk_bed() -> ForeignWorld:
    """Two bunks, one over the other."""
    posts = sum_of(box((0.07, 0.07, 1.7), (x, y, 0)) for x in (-0.47, 0.47) for y in (-0.97, 0.97))
    slats = sum_of(box((0.9, 0.1, 0.02), (0, y / 10, z)) for z in (0.35, 1.3) for y in range(-9, 10, 2))
    rails = sum_of(box((0.03, 1.9, 0.12), (x, 0, z - 0.1)) for z in (0.35, 1.3) for x in (-0.47, 0.47)) + box(
        (0.03, 1.9, 0.2), (-0.47, 0, 1.45)
    )
    rungs = sum_of(box((0.03, 0.4, 0.04), (0.53, -0.6, 0.3 * k)) for k in range(1, 6))
    mattress = box((0.88, 1.85, 0.12))
    return ForeignWorld(
        "bunk_bed",
        (
            fixed(
                "bunkbed_frame", (0, 0, 0), posts + slats + rails, Body("bunkbed_ladder", (0, 0, 0), rungs)
            ),
            free("mattress_lower", (0, 0, 0.37), mattress),
            free("mattress_upper", (0, 0, 1.32), mattress),
            free("pillow_a", (0, 0.7, 0.49), box((0.5, 0.3, 0.1))),
            free("pillow_b", (0, 0.7, 1.44), box((0.5, 0.3, 0.1))),
            free("plush_rabbit", (0.1, -0.2, 0.49), ball(0.09) + ball(0.06, (0, 0, 0.16))),
            free("storybook", (-0.1, -0.5, 1.44), BOOK),
            free("toy_box", (0, -0.3, 0), crate((0.5, 0.4, 0.22), wall=0.012)),
            free("toy_block_1", (-0.1, -0.3, 0.013), box((0.06, 0.06, 0.06))),
            free("toy_ball", (0.1, -0.3, 0.013), ball(0.05)),
            free("stool_step", (0.9, 0.3, 0), table(0.35, 0.3, 0.25)),
        ),
    )


def bookshelf() -> ForeignWorld:
    """An open shelf of five boards."""
    boards = sum_of(box((0.84, 0.3, 0.02), (0, 0, z)) for z in (0.05, 0.42, 0.79, 1.16, 1.53))
    sides = sum_of(box((0.02, 0.3, 1.55), (x, 0, 0)) for x in (-0.43, 0.43)) + box(
        (0.84, 0.01, 1.55), (0, 0.145, 0)
    )
    upright = box((0.03, 0.16, 0.24))
    return ForeignWorld(
        "bookshelf",
        (
            fixed("billy_shelf_01", (0, 0, 0), boards + sides),
            *(free(f"book_{k}", (-0.38 + 0.034 * k, 0.02, 0.44), upright) for k in range(5)),
            free("book_lying_1", (0.1, 0, 0.44), BOOK, yaw=90),
            free("book_lying_2", (0.1, 0, 0.472), box((0.14, 0.2, 0.025)), yaw=84),
            free("globe", (0.1, 0, 0.5), tube(0.05, 0.02) + ball(0.06, (0, 0, 0.02))),
            free("storage_bin_grey", (-0.2, 0, 0.07), crate((0.33, 0.26, 0.24), wall=0.01)),
            free("yarn_ball", (-0.2, 0, 0.085), ball(0.05)),
            free("photo_frame_3", (0.2, 0.05, 0.81), box((0.15, 0.04, 0.2))),
            free("vase_tall", (-0.2, 0, 1.55), vessel(0.05, 0.22, 0.006)),
            free("tulip", (-0.2, 0, 1.56), tube(0.012, 0.36)),
            free("cat_figurine", (0.2, 0, 1.18), ball(0.05) + ball(0.03, (0.03, 0, 0.08))),
            free("slipper_right", (0.25, -0.4, 0), box((0.1, 0.26, 0.05))),
        ),
    )


def hallway() -> ForeignWorld:
    """An umbrella stand, a bench with shoes below and a coat rack."""
    umbrella = bar(0.018, (0, 0, 0.02), (0, 0, 0.8)) + bar(0.012, (0, 0, 0.82), (0.07, 0, 0.86))
    hooks = box((0.8, 0.02, 0.1)) + sum_of(bar(0.008, (x, 0, 0.05), (x, -0.07, 0.06)) for x in (-0.3, 0, 0.3))
    return ForeignWorld(
        "hallway",
        (
            fixed("hall_bench_a", (0, 0, 0), table(1.1, 0.35, 0.45) + box((1.0, 0.3, 0.02), (0, 0, 0.12))),
            fixed("coat_rack_wall", (0, 0.3, 1.6), hooks),
            free("umbrella_stand_0", (1.0, 0.1, 0), vessel(0.1, 0.45, 0.008)),
            free("umbrella_blue", (1.03, 0.1, 0.012), umbrella),
            free("walking_stick", (0.95, 0.1, 0.012), tube(0.012, 0.9)),
            free("sneaker_l", (-0.35, 0, 0.14), box((0.1, 0.28, 0.1))),
            free("sneaker_r", (-0.22, 0, 0.14), box((0.1, 0.28, 0.1))),
            free("boot_box", (0.3, 0, 0), box((0.3, 0.25, 0.11))),
            free("handbag", (0.2, 0, 0.45), box((0.3, 0.12, 0.2))),
            free("wool_hat", (0.2, 0, 0.651), tube(0.1, 0.06)),
            free("keys_bowl", (-0.4, 0, 0.45), BOWL),
            free("car_key", (-0.4, 0, 0.46), box((0.03, 0.05, 0.012))),
            free("doormat_1", (0, -0.9, 0), box((0.7, 0.45, 0.012))),
            free("parcel_dhl", (0.1, -0.9, 0.0121), box((0.3, 0.2, 0.15))),
        ),
    )


def wardrobe_room() -> ForeignWorld:
    """A wardrobe with two doors, of which one is open, and boards inside."""
    boards = sum_of(box((0.94, 0.54, 0.02), (0, -0.01, z)) for z in (0.5, 1.0, 1.5))
    door = box((0.49, 0.02, 1.92))
    return ForeignWorld(
        "wardrobe_room",
        (
            fixed(
                "Wardrobe_A",
                (0, 0, 0),
                case((1.0, 0.6, 2.0), wall=0.03) + boards,
                turning("door_l", (-0.25, -0.315, 0.04), door, "hinge_l", "0 0 -1", 120, "-.245 0 0"),
                turning("door_r", (0.25, -0.315, 0.04), door, "hinge_r", "0 0 1", 120, ".245 0 0"),
            ),
            free("sweater_stack", (-0.25, 0, 0.521), box((0.35, 0.3, 0.15))),
            free("sweater_top", (-0.25, 0, 0.672), box((0.33, 0.28, 0.05))),
            free("hat_box", (0.2, 0, 1.021), crate((0.35, 0.35, 0.25), wall=0.008)),
            free("straw_hat", (0.2, 0, 1.035), tube(0.14, 0.1)),
            free("shoes_brown", (0.2, -0.05, 0.031), box((0.2, 0.28, 0.1))),
            free("suitcase_red", (0.1, 0, 2.0), box((0.7, 0.45, 0.25))),
            free("blanket_folded", (0.1, 0, 2.251), box((0.5, 0.4, 0.1))),
            free(
                "laundry_sack",
                (0.9, -0.1, 0),
                prism(
                    "sack",
                    [(0.2, 0), (0.1, 0.17), (-0.1, 0.17), (-0.2, 0), (-0.1, -0.17), (0.1, -0.17)],
                    0.5,
                    0.7,
                ),
            ),
        ),
        open={"hinge_l": 1.6},
    )


WORLDS = (thor_bedroom, bunk_bed, bookshelf, hallway, wardrobe_room)
